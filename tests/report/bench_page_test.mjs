// Graded pages in which code runs, in a browser. Usage: node bench_page_test.mjs ROOT BUILD
// Exit 0: right; 1: wrong; 77: skipped, with the reason. Needs chromium, clang 14 for WebAssembly
// and the references of a1, a2 and a3.
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { Browser } from '../live/browser.mjs';

const [root, build] = process.argv.slice(2), tumble = join(build, 'bin/tumble'), pictures = process.env.BENCH_PICTURES;
function skip(why) { console.log(`skipped: ${why}`); process.exit(77); }
const isQuick = !process.env.TUMBLE_TEST_WHOLE;   // the pages of one submission; all take minutes
const kQuick = ['a flawed law is named', 'its own law alone'];
try { execFileSync('chromium', ['--version'], { stdio: 'ignore' }); } catch { skip('chromium is not installed'); }
if (!existsSync(tumble)) skip(`${tumble} is not built`);
const solved = join(root, 'solutions_private/a1_impulse/a1_impulse.cpp');
if (!existsSync(solved)) skip('this tree has no solutions');
const found = JSON.parse(execFileSync('sh', ['-c', `"${tumble}" doctor --json || true`], { cwd: root, env: { ...process.env, TUMBLE_ROOT: root } }));
const finding = found.findings.find(f => f.what === 'code in pages');
if (finding.state !== 'ok') skip(`${finding.found}. ${finding.remedy}`);

const folder = mkdtempSync(join(tmpdir(), 'tumble_bench_test_'));
let failed = 0;
function expect(holds, what) { if (!holds) { failed = 1; console.log(`  WRONG: ${what}`); } }
const right = readFileSync(solved, 'utf8');
// One function of the right solution with another body.
function changed(name, body) {
  const from = right.indexOf('{', right.search(new RegExp(`^\\w[\\w:<>]* ${name}\\(`, 'm')));
  const to = right.indexOf('\n}', from);
  return right.slice(0, from) + `{ ${body} }` + right.slice(to + 2);
}
const submissions = {
  right,
  flawed: readFileSync(join(root, 'solutions_private/a1_impulse/flawed_submission/a1_impulse.cpp'), 'utf8'),
  endless: changed('collision_impulse', 'for (volatile int i = 0;; i = 1 - i) {}'),
  throws: changed('collision_impulse', 'throw std::runtime_error("no impulse today");').replace('#include', '#include <stdexcept>\n#include'),
  crashes: changed('apply_impulse', 'return *static_cast<Velocity*>(nullptr == &body ? nullptr : reinterpret_cast<Velocity*>(0xfffffff0u));'),
  stub: readFileSync(join(root, 'assignments/a1_impulse/a1_impulse.cpp'), 'utf8'),
};
// Grades submissions, by name, of an assignment. @return the folder of their pages
function graded(id, file, submissions) {
  for (const [name, text] of Object.entries(submissions)) {
    mkdirSync(join(folder, id, name), { recursive: true });
    writeFileSync(join(folder, id, name, file), text);
  }
  const pages = join(folder, `out_${id}`);
  try {
    execFileSync(tumble, ['grade', id, join(folder, id), '--out', pages, '--no-media', '--code-in-pages', 'own'], { cwd: root, env: { ...process.env, TUMBLE_ROOT: root, TUMBLE_GRADER_KEY: join(folder, 'key') }, stdio: ['ignore', 'pipe', 'pipe'] });
  } catch (error) { console.log(`WRONG: grade ${id} ended with ${error.status}: ${error.stderr}`); process.exit(1); }
  return pages;
}
const out = graded('a1', 'a1_impulse.cpp', isQuick ? { flawed: submissions.flawed } : submissions);

const browser = new Browser();
const text = id => `document.querySelector('${id}').textContent`;
async function opened(name, page = 'index.html', size = {}, pages = out) {
  const tab = await browser.open(`file://${join(pages, name, page)}#try`, size);
  await tab.until('document.getElementById("bench").dataset.shown', `${name}/${page}: the first run`, 30);
  return tab;
}
// Chooses an experiment, or moves a control, and waits for its run.
async function after(tab, script) {
  const before = await tab.value('document.getElementById("bench").dataset.shown');
  await tab.value(script);
  await tab.until(`document.getElementById("bench").dataset.shown !== "${before}"`, 'the next run', 30);
}
const choose = i => `{ const s = document.getElementById('bench-choose'); s.value = ${i}; s.onchange(); }`;
const move = (id, value) => `{ const s = document.getElementById('bench-${id}'); s.value = ${value}; s.oninput(); }`;
const said = tab => tab.value("[...document.querySelectorAll('#bench p, #bench td')].map(p => p.textContent).join(' | ')");

const tests = [];
const test = (name, run) => tests.push({ name, run });

// @return how many experiments there were
async function agreesWithItself(tab) {
  const experiments = await tab.value("document.querySelectorAll('#bench-choose option').length");
  for (let i = 0; i < experiments; ++i) {
    await after(tab, choose(i));
    for (const end of ['min', 'max']) {
      for (const id of await tab.value("[...document.querySelectorAll('.bench-controls input')].map(i => i.id)"))
        await after(tab, `{ const s = document.getElementById('${id}'); s.value = s.${end}; s.oninput(); }`);
      const words = await said(tab);
      expect(words.includes('as the right law does, to 1e-12'), `experiment ${i} at ${end}: ${words}`);
      expect(!words.includes('wrong |'), `experiment ${i} at ${end}: a number is wrong: ${words}`);
    }
  }
  expect(tab.errors.length === 0, `errors of the page: ${tab.errors}`);
  return experiments;
}
test('the right law agrees with itself to 1e-12, in every experiment and for every end of a control', async () => {
  expect(await agreesWithItself(await opened('right')) === 3, 'a1 has three experiments');
});

test('a flawed law is named with both answers, and its motion is another', async () => {
  const tab = await opened('flawed'), words = await said(tab);
  expect(/first call that differs is number \d+: collision_impulse/.test(words), words);
  expect(words.includes('angular momentum about the corner, largest change [kg m^2/s] | 0 | 0.4'), words);
  await after(tab, choose(1));
  expect((await said(tab)).includes('resolve_collision: it is not implemented'), await said(tab));
  if (pictures) { await tab.picture(join(pictures, 'bench_flawed_1400.png')); }
});

test("a student's page has its own law alone, and says by what must hold that it is wrong", async () => {
  const tab = await opened('flawed', 'student.html'), words = await said(tab);
  expect(await tab.value("document.getElementById('bench-right') === null"), 'the right law is in the page of a student');
  expect(/of the numbers below (is|are) not as/.test(words), words);
  expect(!existsSync(join(out, 'flawed/media/right.wasm')), 'the right law lies in the folder of a student');
});

test('an endless loop is ended and named, and the page goes on', async () => {
  const tab = await opened('endless');
  expect((await said(tab)).includes('Out of time: collision_impulse'), await said(tab));
  // meanwhile the page answers: a timer of the page runs on time while the worker does not return
  await tab.value(move('mass', 5));
  const late = await tab.value('new Promise(done => { const t = performance.now(); setTimeout(() => done(performance.now() - t), 100); })');
  expect(late < 1500, `a timer of 100 ms came after ${late} ms`);
  await after(tab, choose(2));
  expect((await said(tab)).includes('Ran to the end'), `the push, which needs no impulse: ${await said(tab)}`);
});

test('what throws, crashes and is not written is told apart', async () => {
  for (const [name, words] of [['throws', 'Threw at t = '], ['throws', 'collision_impulse: it threw: no impulse today'], ['crashes', 'Crashed at t = '], ['stub', 'Not attempted at t = ']]) {
    const tab = await opened(name);
    expect((await said(tab)).includes(words), `${name}: ${await said(tab)}`);
  }
});

test('a drag from the brick pushes it, a key turns the view', async () => {
  const tab = await opened('right');
  await after(tab, choose(1));
  await tab.value(`document.querySelector('#bench canvas').scrollIntoView({ block: 'center' })`);
  await tab.value(`{ const s = document.querySelector('.bench-bar input'); s.value = 0; s.oninput(); }`);
  const box = JSON.parse(await tab.value(`JSON.stringify(document.querySelector('#bench canvas').getBoundingClientRect())`));
  const middle = [box.x + box.width / 2, box.y + box.height / 2], before = await tab.value('document.getElementById("bench").dataset.shown');
  await tab.drag([middle[0], middle[1] - 8], [middle[0] + 90, middle[1] - 8]);
  await tab.until(`document.getElementById("bench").dataset.shown !== "${before}"`, 'the pushed run', 30);
  const calls = Number(/(\d+) calls of this file/.exec(await said(tab))?.[1]);
  // 12 triangles, 24 steps of wrench, force and two torques, and the impact's calls
  expect(calls >= 12 + 24 * 4, `a push makes ${calls} calls: ${await said(tab)}`);
  expect((await said(tab)).includes('as the right law does'), await said(tab));
});

test('at 400 pixels nothing scrolls sideways, light and dark', async () => {
  for (const dark of [false, true]) {
    const tab = await opened('flawed', 'index.html', { width: 400, height: 900, dark });
    const wide = await tab.value('document.documentElement.scrollWidth');
    expect(wide <= 400, `the page is ${wide} pixels wide`);
    if (pictures) await tab.picture(join(pictures, `bench_400_${dark ? 'dark' : 'light'}.png`));
  }
});

test('what the code adds to a page', async () => {
  const cost = (name, page) => { const html = readFileSync(join(out, name, page), 'utf8'), at = html.indexOf('<div id="bench">'); return { whole: html.length, code: html.slice(at).match(/<script[\s\S]*?<\/script>/g).join('').length }; };
  for (const page of ['index.html', 'student.html']) { const { whole, code } = cost('flawed', page); console.log(`  flawed/${page}: ${Math.round(whole / 1000)} kB, of these ${Math.round(code / 1000)} kB code and its data; own.wasm ${Math.round(statSync(join(out, 'flawed/media/own.wasm')).size / 1000)} kB`); expect(code < 150e3, `${code} bytes`); }
});

// ---- The other assignments that have experiments ----

const source = (assignment, flawed) => readFileSync(join(root, 'solutions_private', assignment, flawed ? 'flawed_submission' : '', `${assignment}.cpp`), 'utf8');
const both = assignment => ({ right: source(assignment, false), flawed: source(assignment, true) });

test("a2: the right law agrees with itself, and the flawed one's order is not 4", async () => {
  const pages = graded('a2', 'a2_integration.cpp', both('a2_integration'));
  expect(await agreesWithItself(await opened('right', 'index.html', {}, pages)) === 2, 'a2 has two experiments');
  const tab = await opened('flawed', 'student.html', {}, pages), words = await said(tab);
  expect(/wrong \| order: log2 of the errors/.test(words), words);
  if (pictures) await tab.picture(join(pictures, 'bench_a2.png'));
});

test('a3: the right law agrees with itself, and what is wrong with the flawed one is said by what must hold', async () => {
  const pages = graded('a3', 'a3_constraints.cpp', both('a3_constraints'));
  expect(await agreesWithItself(await opened('right', 'index.html', {}, pages)) === 5, 'a3 has five experiments');
  const ta = await opened('flawed', 'index.html', {}, pages);
  expect((await said(ta)).includes('The first call that differs is number 1: spring_force'), await said(ta));
  if (pictures) await ta.picture(join(pictures, 'bench_a3_spring.png'));
  // its spring throws the brick above the point that it hangs from: both are seen all the time
  const outside = await ta.value(`(() => { const b = document.getElementById('bench').bench, size = b.sized(), view = b.eyes(), seen = p => { const [x, y] = b.project(view, size, p); return x >= 0 && x <= size.width && y >= 0 && y <= size.height; };
    return b.results.flatMap(r => r.frames.filter(f => !seen(f.poses.slice(0, 3)) || f.lines.some(l => l.kind === 'spring' && !(seen(l.from) && seen(l.to)))).map(f => f.t)); })()`);
  expect(outside.length === 0, `the brick or the spring is out of the picture at ${outside.slice(0, 5)} s, ${outside.length} times`);
  await after(ta, choose(2));
  if (pictures) await ta.picture(join(pictures, 'bench_a3_rods.png'));
  const tab = await opened('flawed', 'student.html', {}, pages), wrong = [];
  for (const i of [0, 1, 2, 3, 4]) {
    await after(tab, choose(i));
    wrong.push(...(await tab.value("[...document.querySelectorAll('#bench tbody tr')].filter(r => r.cells[0].textContent === 'wrong').map(r => r.cells[1].textContent)")));
  }
  // it forgets the length at rest, brakes in every direction, corrects without masses, and lets a rod grow
  for (const part of ['0.1 m longer than at rest', 'where the ends move round each other', 'constraint_correction took away', 'length of a rod'])
    expect(wrong.some(name => name.includes(part)), `"${part}" is not wrong; these are: ${wrong.join(' | ')}`);
  const cost = readFileSync(join(pages, 'flawed/index.html'), 'utf8').match(/<script[\s\S]*?<\/script>/g).join('').length;
  console.log(`  flawed/index.html of a3: ${Math.round(cost / 1000)} kB code and its data`);
  for (const [width, dark] of [[400, false], [400, true]]) {
    const small = await opened('flawed', 'index.html', { width, height: 900, dark }, pages);
    expect(await small.value('document.documentElement.scrollWidth') <= width, 'the page of a3 scrolls sideways');
    if (pictures) await small.picture(join(pictures, `bench_a3_400_${dark ? 'dark' : 'light'}.png`));
  }
});

try {
  for (const { name, run } of tests) {
    if (isQuick && !kQuick.some(part => name.includes(part))) { console.log(`left out: ${name}: ./tumble test --whole -R bench_page`); continue; }
    console.log(name);
    try { await run(); } catch (error) { expect(false, error.stack); }
  }
} finally {
  await browser.close();
  if (process.env.BENCH_KEEP) cpSync(out, process.env.BENCH_KEEP, { recursive: true });
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed);
