// The panels of handouts in a browser. Usage: node explore_test.mjs FOLDER, with the pages that `tumble handouts` built.
// Exit 0: right; 1: wrong; 77: skipped, with the reason. Needs chromium.
import { execFileSync } from 'node:child_process';
import { existsSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { Browser } from '../live/browser.mjs';

const [folder] = process.argv.slice(2), pictures = process.env.EXPLORE_PICTURES;
function skip(why) { console.log(`skipped: ${why}`); process.exit(77); }
try { execFileSync('chromium', ['--version'], { stdio: 'ignore' }); } catch { skip('chromium is not installed'); }
if (!existsSync(join(folder, 'a1_impulse.html'))) skip(`${folder} has no handouts: ctest -R handouts_built makes them`);

let failed = 0;
function expect(holds, what) { if (!holds) { failed = 1; console.log(`  WRONG: ${what}`); } }
const browser = new Browser();
const kPanels = { a1_impulse: ['impulse'], a2_integration: ['order'], a3_constraints: ['spring', 'baumgarte'], a4_timewarp: ['walk'] };
const open = async (name, size = {}) => {
  const tab = await browser.open(`file://${join(folder, `${name}.html`)}`, size);
  await tab.until("document.readyState === 'complete' && [...document.querySelectorAll('.explore')].every(e => e.querySelector('[role=status]').textContent !== '')", `${name}: panels with words`, 30);
  return tab;
};
// Moves controls, in their order, and gives the panel's sentence.
const told = async (tab, panel, ...values) => {
  await tab.value(`{ const all = document.querySelectorAll('[data-panel=${panel}] input'); ${JSON.stringify(values)}.forEach((x, i) => { all[i].value = x; all[i].oninput(); }); }`);
  return tab.value(`document.querySelector('[data-panel=${panel}] [role=status]').textContent`);
};
const tests = [];
const test = (name, run) => tests.push({ name, run });

test('what is wider than the column of a phone scrolls and is a stop of the keyboard; a wide screen holds everything', async () => {
  for (const name of readdirSync(folder).filter(file => /^(a\d_\w+|notation)\.html$/.test(file)).map(file => file.replace('.html', '')))
    for (const width of [1400, 400]) {
      const tab = await browser.open(`file://${join(folder, `${name}.html`)}`, { width, height: 900 });
      await tab.until("document.readyState === 'complete'", name);
      const wide = JSON.parse(await tab.value(`JSON.stringify([...document.querySelectorAll('body *')].filter(e => e.scrollWidth > e.clientWidth + 2 && ['auto', 'scroll'].includes(getComputedStyle(e).overflowX)).map(e => ({ tab: e.tabIndex, words: e.textContent.slice(0, 40) })))`));
      if (width === 1400) expect(wide.length === 0, `${name}: wider than the column of a wide screen: ${wide.map(e => e.words)}`);
      else expect(wide.length > 0 && wide.every(e => e.tab >= 0), `${name}: scrolls without a stop of the keyboard: ${wide.filter(e => e.tab < 0).map(e => e.words)}`);
      await tab.send('Page.close');
    }
});

test('every panel is drawn and says something, at 1400 and 400 pixels, light and dark, and nothing scrolls sideways', async () => {
  for (const [name, panels] of Object.entries(kPanels))
    for (const [width, dark] of [[1400, false], [400, true]]) {
      const tab = await open(name, { width, height: 900, dark });
      expect(await tab.value('document.documentElement.scrollWidth') <= width, `${name} at ${width} pixels scrolls sideways`);
      for (const panel of panels) {
        // ends of each control, too
        for (const end of ['min', 'max'])
          await tab.value(`for (const s of document.querySelectorAll('[data-panel=${panel}] input')) { const v = s.value; s.value = s.${end}; s.oninput(); s.value = v; s.oninput(); }`);
        const inked = await tab.value(`(() => { const c = document.querySelector('[data-panel=${panel}] canvas'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (c.width * c.height); })()`);
        expect(inked > 0.005, `${name}: ${panel} has ${inked} of its picture drawn`);
        expect(!(await told(tab, panel)).includes('NaN'), `${name}: ${panel} says ${await told(tab, panel)}`);
        await tab.value(`document.querySelector('[data-panel=${panel}]').scrollIntoView()`);
        if (pictures) await tab.picture(join(pictures, `explore_${panel}_${width}_${dark ? 'dark' : 'light'}.png`));
      }
      expect(tab.errors.length === 0, `${name}: errors of the page: ${tab.errors}`);
    }
});

// handouts/make_figures.sh draws the moves 12 (all at 0.8 s), 15 (B ahead of A) and 18 (B and C rolled back).
test('the walk counts moves as the figures beside it do', async () => {
  const tab = await open('a4_timewarp');
  for (const [place, move] of [[4, 12], [7, 15], [10, 18], [18, 26], [20, 28]]) {
    await told(tab, 'walk', place);
    const number = await tab.value(`document.querySelector('[data-panel=walk] input').getAttribute('aria-valuetext')`);
    expect(number === `${move}`, `the walk, at its place ${place}, is after move ${number}`);
  }
});

// Of the words of a page that stand on one colour: those whose luminances are less than 4.5 : 1
// apart (Web Content Accessibility Guidelines 2.2, 1.4.3), one of each kind.
const kFaintWords = `(() => {
  const numbers = css => { const n = /rgba?\\(([^)]+)\\)/.exec(css)[1].split(',').map(Number); return n.length > 3 ? n : [...n, 1]; };
  const luminance = rgb => [0.2126, 0.7152, 0.0722].reduce((sum, part, i) => { const v = rgb[i] / 255; return sum + part * (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); }, 0);
  const faint = new Map(), walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    if (!walker.currentNode.textContent.trim() || element.closest('svg, script, style') || !element.checkVisibility()) continue;
    let under = element;
    while (under && numbers(getComputedStyle(under).backgroundColor)[3] < 0.99) under = under.parentElement;
    if (!under) continue;
    const [one, other] = [luminance(numbers(getComputedStyle(element).color)), luminance(numbers(getComputedStyle(under).backgroundColor))].sort((a, b) => a - b), ratio = (other + 0.05) / (one + 0.05);
    if (ratio < 4.5) faint.set(element.tagName + element.className, walker.currentNode.textContent.trim().slice(0, 30) + ' ' + ratio.toFixed(1) + ' : 1');
  }
  return [...faint.values()].join('; ');
})()`;

test('every handout fits 400 pixels, and its words are seen on their ground, light and dark', async () => {
  for (const file of readdirSync(folder).filter(name => name.endsWith('.html')))
    for (const [width, dark] of [[400, false], [1400, true]]) {
      const tab = await browser.open(`file://${join(folder, file)}`, { width, height: 900, dark });
      await tab.until("document.readyState === 'complete'", file, 30);
      expect(await tab.value('document.documentElement.scrollWidth') <= width, `${file} at ${width} pixels scrolls sideways`);
      const faint = await tab.value(kFaintWords);
      expect(faint === '', `${file}, ${dark ? 'dark' : 'light'}, hard to read: ${faint}`);
    }
});

test('the numbers are those of the equations', async () => {
  // e = 1, m = 0.5 kg, r = 0.3 m: K = 2 + 1 + 12 * 0.09 = 4.08; j = 2 / 4.08; nothing is lost
  let words = await told(await open('a1_impulse'), 'impulse', 1, 0.5, 0.3, 0);
  expect(words.includes('= 4.08 per kg, so j = 0.49 N s') && words.includes('Lost: (1 - e) j |u| / 2 = 0 J'), words);
  words = await told(await open('a2_integration'), 'order', 100);
  const [, euler, rk4] = /Half the step makes Euler's error ([\d.]+) times smaller, Runge-Kutta's ([\d.]+) times/.exec(words);
  expect(Math.abs(euler - 2) < 0.2 && Math.abs(rk4 - 16) < 0.1, words);   // orders 1 and 4
  const a3 = await open('a3_constraints');
  // k = 40 N/m, c = 2 sqrt(k m) = 12.6: above it nothing swings
  expect((await told(a3, 'spring', 40, 13)).startsWith('It returns without swinging'), 'above critical damping it swings');
  expect((await told(a3, 'spring', 40, 12)).startsWith('It swings'), 'below critical damping it does not swing');
  // the bound 0.83 of h / T, from both sides
  expect((await told(a3, 'baumgarte', 0.1, 0.08)).includes('After T'), 'h / T = 0.8 is called unstable');
  expect((await told(a3, 'baumgarte', 0.1, 0.086)).includes('too short for this step'), 'h / T = 0.86 is not called unstable');
});

test('without scripts there is nothing of a panel', async () => {
  const tab = await browser.open('about:blank');
  await tab.send('Emulation.setScriptExecutionDisabled', { value: true });
  await tab.send('Page.navigate', { url: `file://${join(folder, 'a1_impulse.html')}` });
  await tab.until("document.querySelector('.explore')", 'the page', 30);
  expect(await tab.value("getComputedStyle(document.querySelector('.explore')).display") === 'none', 'an empty panel is shown');
});

try {
  for (const { name, run } of tests) {
    console.log(name);
    try { await run(); } catch (error) { expect(false, error.stack); }
  }
} finally { await browser.close(); }
process.exit(failed);
