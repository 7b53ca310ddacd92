// The page that plays a run, by the keyboard alone, in a browser. Usage: node player_page_test.mjs ROOT BUILD
// Exit 0: right; 1: wrong; 77: skipped, with the reason. Needs chromium, and the reference modules for the run.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { Script } from 'node:vm';
import { Browser } from '../live/browser.mjs';

const [root, build] = process.argv.slice(2), tumble = join(build, 'bin/tumble');
let failed = 0;
function expect(holds, what) { if (!holds) { failed = 1; console.log(`  WRONG: ${what}`); } }

// Numbers of an axis have one style; this needs no browser.
const words = new Script(`${readFileSync(join(root, 'framework/report/player/plot.js'), 'utf8')}\ntypeof tickWords === 'function' ? tickWords : () => [];`).runInNewContext({});
for (const [ticks, isLog, said] of [[[5000, 1e4, 2e4], true, '5e3 1e4 2e4'], [[0.01, 1, 100], true, '0.01 1 100'], [[0, 5e-4, 1e-3, 1.5e-3], false, '0 0.0005 0.001 0.0015'], [[-4e-4, -2e-4, -1e-20], false, '-4e-4 -2e-4 0']])
  expect(words(ticks, isLog).join(' ') === said, `${ticks}: ${words(ticks, isLog)}`);

function skip(why) { console.log(`skipped: ${why}`); process.exit(failed || 77); }
try { execFileSync('chromium', ['--version'], { stdio: 'ignore' }); } catch { skip('chromium is not installed'); }
if (!existsSync(tumble) || !existsSync(join(build, 'modules/a1_reference.so'))) skip('tumble and the reference modules are not built');

const folder = mkdtempSync(join(tmpdir(), 'tumble_player_page_')), page = join(folder, 'run.html'), browser = new Browser();
const kKeys = { Tab: 9, Enter: 13, Escape: 27, ' ': 32, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40 };
const press = async (tab, key) => {
  for (const type of ['keyDown', 'keyUp']) await tab.send('Input.dispatchKeyEvent', { type, key, code: key === ' ' ? 'Space' : key, windowsVirtualKeyCode: kKeys[key], ...(type === 'keyDown' && (key === ' ' || key === 'Enter') ? { text: key === ' ' ? ' ' : '\r' } : {}) });
};
const open = async size => {
  const tab = await browser.open(`file://${page}#t=0`, size);
  await tab.until('document.body.dataset.ready', 'the page');
  return tab;
};
const kAt = '(document.activeElement === document.body ? "" : document.activeElement.id || document.activeElement.className || document.activeElement.tagName)';

try {
  execFileSync(tumble, ['run', 'drop_a_box', '--modules', 'reference', '--beside', 'step-s=0.004', '--html', page], { cwd: root, env: { ...process.env, TUMBLE_ROOT: root }, stdio: 'ignore' });

  console.log('Tab reaches every control in the order of the page, with a ring, and leaves it again');
  let tab = await open();
  const places = [], kRing = '(() => { const s = getComputedStyle(document.activeElement); return s.outlineStyle !== "none" && parseFloat(s.outlineWidth) > 0; })()';
  const kStops = '[...document.querySelectorAll("button, input, select, summary, a, [tabindex]")].filter(e => e.tabIndex >= 0 && !e.disabled && e.checkVisibility({ visibilityProperty: true }))';
  const stops = await tab.value(`${kStops}.length`);
  for (let i = 0; i <= stops; ++i) {
    await press(tab, 'Tab');
    if (await tab.value(kAt) === '') break;
    places.push(await tab.value(`${kStops}.indexOf(document.activeElement)`));
    expect(await tab.value(kRing), `${await tab.value(kAt)} shows no ring`);
  }
  expect(places.length === stops && places.every((place, i) => place === i), `${stops} stops are taken as ${places}`);

  console.log('the panel with what is drawn opens by a key, covers no control, and Escape closes it');
  await tab.value('document.querySelector("#more summary").focus()');
  await press(tab, 'Enter');
  expect(await tab.value('document.getElementById("more").open'), 'Enter does not open it');
  const covered = await tab.value(`(() => { const box = document.getElementById('options').getBoundingClientRect();
    return [...document.querySelectorAll('#buttons > button, #buttons > select, #scrub, #more summary')].filter(e => { const r = e.getBoundingClientRect(); return r.right > box.left && r.left < box.right && r.bottom > box.top && r.top < box.bottom; }).map(e => e.id); })()`);
  expect(covered.length === 0, `covered: ${covered}`);
  await tab.value('tumble.player.pause(), document.querySelector("#options input").focus()');
  await press(tab, ' ');
  expect(!await tab.value('document.querySelector("#options input").checked || tumble.player.isPlaying'), 'a blank in a box plays the run instead of changing the box');
  await press(tab, 'Escape');
  expect(!await tab.value('document.getElementById("more").open') && await tab.value('document.activeElement.tagName') === 'SUMMARY', 'Escape does not close it');

  console.log('arrows go through tabs and events, and the keyboard stays there');
  await tab.value('document.getElementById("tab0").focus()');
  await press(tab, 'ArrowRight');
  await press(tab, 'ArrowRight');
  expect(await tab.value(kAt) === 'tab2' && await tab.value('document.getElementById("tab2").getAttribute("aria-selected") === "true" && tumble.player.time === 0'), `arrows on tabs lead to ${await tab.value(kAt)}`);
  await tab.value('document.querySelector(".events").focus()');
  const rows = [];
  for (let i = 0; i < 3; ++i) { await press(tab, 'ArrowDown'); rows.push(await tab.value('document.querySelector(".event.now").id')); }
  await press(tab, 'ArrowUp');
  rows.push(await tab.value('document.querySelector(".event.now").id'));
  expect(rows.join(' ') === 'event0 event1 event2 event1', `arrows in the list: ${rows}`);   // both runs have the first impacts at the same instants
  expect(await tab.value(kAt) === 'events', `the keyboard is at ${await tab.value(kAt)}`);
  const speed = await tab.value('tumble.player.speed');
  await tab.value('document.querySelector(".pane:not([hidden])").focus()');
  await press(tab, 'ArrowDown');
  expect(await tab.value('tumble.player.speed') === speed, 'an arrow in a pane, which scrolls it, changes the speed');
  expect(tab.errors.length === 0, tab.errors.join('; '));

  console.log('on a phone letters of curves have their size, and a row of an event can be read to its end');
  tab = await open({ width: 400, height: 900 });
  const size = await tab.value('Math.min(...[...document.querySelectorAll("#panes svg.plot")].filter(svg => svg.checkVisibility()).map(svg => svg.getBoundingClientRect().width / svg.viewBox.baseVal.width * parseFloat(getComputedStyle(svg).fontSize)))');
  expect(size >= 10, `letters of ${size} pixels`);
  await tab.value('document.getElementById("tab2").click()');
  const cut = await tab.value('[...document.querySelectorAll(".event")].filter(row => row.querySelector(".impulse").getBoundingClientRect().right > row.getBoundingClientRect().right).length');
  expect(cut === 0, `${cut} rows are cut off`);
  expect(await tab.value('document.documentElement.scrollWidth <= 400'), 'the page scrolls sideways');

  console.log('on a phone the names of two bodies that meet are read whole');
  const game = join(folder, 'game.html');
  execFileSync(tumble, ['run', 'billiards', '--engine', 'ca', '--modules', 'reference', '--html', game], { cwd: root, env: { ...process.env, TUMBLE_ROOT: root }, stdio: 'ignore' });
  tab = await browser.open(`file://${game}#t=0&tab=events`, { width: 400, height: 900 });
  await tab.until('document.body.dataset.ready', 'the page');
  await tab.until('document.querySelector(".event .bodies")', 'the events');
  const short = await tab.value('[...document.querySelectorAll(".event .bodies")].filter(names => names.scrollWidth > names.clientWidth).map(names => names.textContent)');
  expect(short.length === 0, `cut off: ${short.slice(0, 3)}`);

  console.log('a picture of a new size is drawn before it is shown');
  tab = await open();
  const drawn = await tab.value(`new Promise(resolve => {
    const gl = tumble.picture.renderer.getContext(), scene = document.getElementById('scene');
    const pixel = new Uint8Array(4);
    let calls = 0;
    new ResizeObserver(() => {   // after the page's own, before the browser shows the frame
      if (++calls < 2) { scene.style.width = scene.clientWidth - 50 + 'px'; return; }
      gl.readPixels(10, 10, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      resolve([...pixel].join());
    }).observe(scene);
  })`);
  expect(drawn !== '0,0,0,0' && drawn !== '0,0,0,255', `a corner of the picture is ${drawn}`);

  console.log('headings leave no level out');
  const levels = await tab.value('[...document.querySelectorAll("h1, h2, h3, h4")].filter(e => e.checkVisibility()).map(e => Number(e.tagName[1]))');
  expect(levels.every((level, i) => i === 0 || level <= levels[i - 1] + 1), `levels ${levels}`);
} catch (error) {
  expect(false, error.stack);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed);
