// The live page in a browser. Usage: node page_test.mjs ROOT BUILD [SECONDS of poking, 20]
// Exit 0: right; 1: wrong; 77: skipped, with the reason. Needs chromium; the reference modules for
// all but the first test. Only what takes seconds, unless the tests run whole. Wall times are
// printed with the machine's load and judged by nobody.
import { spawn, execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, readdirSync, readlinkSync, rmSync, writeFileSync } from 'node:fs';
import { loadavg, tmpdir } from 'node:os';
import { join } from 'node:path';
import { Browser } from './browser.mjs';

const [root, build, seconds = '20'] = process.argv.slice(2), tumble = join(build, 'bin/tumble'), pictures = process.env.LIVE_PICTURES;
function skip(why) { console.log(`skipped: ${why}`); process.exit(77); }
const isQuick = !process.env.TUMBLE_TEST_WHOLE;   // six tests of seconds; all take minutes
try { execFileSync('chromium', ['--version'], { stdio: 'ignore' }); } catch { skip('chromium is not installed'); }
if (!existsSync(tumble)) skip(`${tumble} is not built`);
const hasReference = existsSync(join(build, 'modules/a1_reference.so'));
const folder = mkdtempSync(join(tmpdir(), 'tumble_live_test_'));
let failed = 0;
const sleep = ms => new Promise(resolve => setTimeout(resolve, ms));
function expect(holds, what) { if (!holds) { failed = 1; console.log(`  WRONG: ${what}`); } }
const near = (a, b, share) => Math.abs(a - b) <= share * Math.abs(b);

// The program with a page; ends with stop().
class Live {
  static all = [];
  static killAll() { for (const live of Live.all) if (live.child.exitCode === null) live.child.kill('SIGKILL'); }
  static async start(...words) {
    const live = new Live();
    Live.all.push(live);
    live.child = spawn(tumble, ['live', ...words, '--saves', join(folder, 'saves')], { cwd: root, env: { ...process.env, TUMBLE_ROOT: root } });
    live.said = '';
    live.child.stderr.on('data', bytes => { live.said += bytes; });
    live.address = await new Promise((resolve, reject) => {
      live.child.stdout.once('data', bytes => resolve(String(bytes).trim()));
      live.child.once('exit', code => reject(new Error(`tumble live ended with ${code}: ${live.said}`)));
    });
    return live;
  }
  processes() { return execFileSync('ps', ['-o', 'pid=', '--ppid', String(this.child.pid)]).toString().trim().split(/\s+/).map(Number); }
  memory() { return Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${this.child.pid}/status`, 'utf8'))[1]); }
  descriptors() { return readdirSync(`/proc/${this.child.pid}/fd`).length; }
  async stop(signal = 'SIGINT') {
    const ended = new Promise(resolve => this.child.once('exit', resolve));
    this.child.kill(signal);
    return ended;
  }
}

const tests = [], kQuick = ['a push', 'the keyboard', 'another origin', 'judges nobody', 'of a save is said', 'said beside the run', 'an earlier start'];
const test = (name, run, needsReference = true) => tests.push({ name, run, needsReference });
const browser = new Browser();

test('a push accelerates a body as F / m says', async () => {
  const scene = join(folder, 'floating.json');
  writeFileSync(scene, JSON.stringify({ title: 'A box that floats', duration_s: 5, step_s: 1 / 240, needs: ['a1'], bodies: [{ name: 'box', shape: { box: { size_m: [0.6, 0.6, 0.6] } }, mass_kg: 3, position_m: [0, 0, 1] }],
    camera: { eye_m: [0, -4, 1], target_m: [0, 0, 1], field_of_view_deg: 40 }, grid: { spacing_m: 0.5 } }));
  const live = await Live.start(scene, '--modules', 'reference'), page = await browser.open(live.address);
  await page.until('window.tumble && tumble.run && tumble.run.length > 5 && tumble.hadStage', 'the motion');
  const box = JSON.parse(await page.value('JSON.stringify(document.getElementById("picture").getBoundingClientRect())')), x = box.x + box.width / 2, y = box.y + box.height / 2;
  await page.drag([x, y], [x + 80, y]);
  const push = JSON.parse(await page.until('tumble.pushes.length > 0 && JSON.stringify(tumble.pushes[0])', 'the push'));
  const force = Math.hypot(...push.force_n);
  expect(force > 0.1 && Math.abs(push.force_n[0]) > 0.99 * force, `the force is along the drag: ${push.force_n}`);
  await page.until(`tumble.run.end > ${push.start_s + push.duration_s + 0.1}`, 'the end of the push');
  const speed = await page.value('Math.hypot(...tumble.run.velocity(0, tumble.run.length - 1))');
  expect(near(speed, force * push.duration_s / 3, 1e-5), `F T / m is ${force * push.duration_s / 3} m/s, the page says ${speed}`);   // float32: 6e-8, times the cosines of a turning view
  const acceleration = await page.value(`(() => { const r = tumble.run, from = r.times.findIndex(t => t > ${push.start_s} + 0.01), k = from + 2; return Math.hypot(...r.velocity(0, k).map((v, i) => v - r.velocity(0, from)[i])) / (r.times[k] - r.times[from]); })()`);
  expect(near(acceleration, force / 3, 1e-3), `F / m is ${force / 3} m/s^2, the page says ${acceleration}`);   // float32 times of frames: 1e-7 s in 0.03 s
  expect(await page.value('document.body.dataset.aimed') === '0', 'the ray function says which body was hit');
  // What was done by hand is a scene, and runs again byte for byte.
  await page.value('document.getElementById("save").click()');
  const check = await page.until('document.body.dataset.savedCheck', 'the saved scene is run again');
  expect(/^same \d+$/.test(check), `saved: ${check}`);
  expect(existsSync(await page.value('document.body.dataset.savedScene')), 'the scene is a file');
  if (pictures) await page.picture(join(pictures, 'push.png'));
  expect(page.errors.length === 0, `the page has errors: ${page.errors.join('; ')}`);
  await live.stop();
});

test('a run on the reference judges nobody', async () => {
  const live = await Live.start('a1', '--modules', 'reference'), page = await browser.open(live.address);
  await page.until('tumble.run && tumble.run.length > 5', 'the motion');
  await page.until('document.body.innerText.includes("This run asks a1 (reference) for")', 'what the reference is asked');
  await sleep(3000);   // verdicts of a starter's file take 2 s
  expect(!await page.value('document.body.dataset.verdicts'), 'the file beside the reference was judged');
  await live.stop();
});

test('the keyboard reaches every control, in the order of the page and with a ring, and stays at what is built anew', async () => {
  const live = await Live.start('drop_a_box', '--modules', 'reference'), page = await browser.open(live.address);
  const kKeys = { Tab: 9, Enter: 13, Escape: 27, ArrowRight: 39 };
  const press = async key => {
    for (const type of ['keyDown', 'keyUp']) await page.send('Input.dispatchKeyEvent', { type, key, code: key, windowsVirtualKeyCode: kKeys[key], ...(type === 'keyDown' && key === 'Enter' ? { text: '\r' } : {}) });
  };
  await page.until('tumble.run && tumble.run.length > 5', 'the motion');
  await page.value('document.getElementById("go").click()');
  await page.until('tumble.paused', 'that it is paused');
  await page.value('document.activeElement.blur()');
  const kStops = '[...document.querySelectorAll("button, input, select, summary, a, [tabindex]")].filter(e => e.tabIndex >= 0 && !e.disabled && e.checkVisibility({ visibilityProperty: true }))';
  const stops = await page.value(`${kStops}.length`), places = [];
  for (let i = 0; i <= stops; ++i) {
    await press('Tab');
    if (await page.value('document.activeElement === document.body')) break;
    places.push(await page.value(`${kStops}.indexOf(document.activeElement)`));
    expect(await page.value('(() => { const s = getComputedStyle(document.activeElement); return s.outlineStyle !== "none" && parseFloat(s.outlineWidth) > 0; })()'), `${await page.value('document.activeElement.outerHTML.slice(0, 60)')} shows no ring`);
  }
  expect(places.length === stops && places.every((place, i) => place === i), `${stops} stops are taken as ${places}`);
  // Tabs and tools: one stop each, arrows go on.
  await page.value('document.querySelector("#tabs button").focus()');
  for (let i = 0; i < 3; ++i) await press('ArrowRight');
  expect(await page.value('document.activeElement.textContent === "Change" && document.activeElement.getAttribute("aria-selected") === "true"'), 'arrows go through the tabs');
  await page.value('document.getElementById("toolPush").focus()');
  await press('ArrowRight');
  expect(await page.value('document.activeElement.id === "toolPull" && tumble.tool === "pull"'), 'arrows go through the tools');
  // A change begins the run anew, and the form with it.
  await page.value('[...document.querySelectorAll("#panes button")].find(b => b.textContent === "Earth").focus()');
  await page.value('window.runBefore = tumble.run, 1');
  await press('Enter');
  await page.until('tumble.run !== runBefore', 'the run with the change');
  expect(await page.value('document.activeElement.textContent') === 'Earth', `after a change the keyboard is at ${await page.value('document.activeElement.outerHTML.slice(0, 60)')}`);
  await page.value('document.querySelector("#show summary").focus()');
  await press('Enter');
  await press('Escape');
  expect(await page.value('!document.getElementById("show").open && document.activeElement.tagName === "SUMMARY"'), 'Escape closes what is shown');
  const levels = await page.value('[...document.querySelectorAll("h1, h2, h3")].filter(e => e.checkVisibility()).map(e => Number(e.tagName[1]))');
  expect(levels.every((level, i) => i === 0 || level <= levels[i - 1] + 1), `levels of headings: ${levels}`);
  // On a phone the words over the picture stand below each other, however long they are.
  await page.value('document.getElementById("go").click()');
  const phone = await browser.open(live.address, { width: 400, height: 900 });
  await phone.until('tumble.run && tumble.run.length > 5 && tumble.hadStage', 'the motion');
  const over = await phone.value('(() => { document.getElementById("hint").textContent = "The run has ended, because it lasts 120 s: start over, or go back to an earlier instant."; document.getElementById("scales").textContent = "contact forces: 5 N are 0.25 m long"; return document.getElementById("scales").getBoundingClientRect().top - document.getElementById("hint").getBoundingClientRect().bottom; })()');
  expect(over >= 0, `the scales lie over the hint by ${-over} pixels`);
  await phone.value('document.getElementById("show").open = true');
  const covered = await phone.value('(() => { const box = document.getElementById("options").getBoundingClientRect(); return [...document.querySelectorAll("#bar button, #bar select, #bar input[type=range]")].filter(e => { const r = e.getBoundingClientRect(); return r.height > 0 && r.right > box.left && r.left < box.right && r.bottom > box.top && r.top < box.bottom; }).map(e => e.id); })()');
  expect(covered.length === 0, `what is drawn covers ${covered}`);
  await live.stop();
});

// What the program would tell is told by the test.
test('what is said of a save is said of the saved code', async () => {
  const live = await Live.start('poked_box', '--modules', 'reference');
  const page = await browser.open(live.address, { before: `const Source = EventSource; window.EventSource = class extends Source { constructor(...words) { super(...words); window.stream = this; } };
    window.tell = message => stream.dispatchEvent(new MessageEvent('say', { data: JSON.stringify(message) }));` });
  const tell = message => page.value(`tell(${JSON.stringify(message)})`), text = id => page.value(`document.getElementById("${id}").hidden ? "" : document.getElementById("${id}").textContent.trim()`);
  await page.until('tumble.run && tumble.run.length > 30 && tumble.hadStage', 'the motion');
  const result = (name, verdict, more = {}) => ({ test: `Body.${name}`, group: 'Body', title: name, points: 1, verdict, ...more }), heading = 'wrong in f; likely: w stands left of q';
  const verdicts = (...tests) => tell({ kind: 'verdicts', id: 'a1', title: 'Impulse', file: 'a1.cpp', handout: 'handouts/a1_impulse', said: '', tests });
  const old = () => page.value('(() => { const old = document.querySelector("#panes .old"); return old ? `${getComputedStyle(old).opacity} ${old.textContent}` : ""; })()');
  await verdicts(result('one', 'wrong', { heading, place: 1, story: 'two calls' }), result('two', 'wrong', { heading, place: 0, story: '\n  likely:   w stands left of q' }), result('three', 'right'));
  expect(/likely: w stands left of q.*wrong: two.*wrong: one/s.test(await page.value('document.getElementById("panes").textContent')), 'the heading names the slip, and the story that names it is the first');
  expect(await old() === '', 'verdicts of this code are not grey');
  await page.value('tumble.reason = "code"');
  await tell({ kind: 'code_saved', file: 'a1.cpp', id: 'a1' });
  expect(/^0\.[1-6].*1 of 3 tests are right/.test(await old()), `the verdicts before are grey: ${await old()}`);
  await tell({ kind: 'judging', id: 'a1' });
  expect(/^0\.[1-6].*1 of 3/.test(await old()) && /The tests of a1 run .*in grey is of the code before/.test(await page.value('document.getElementById("panes").textContent')), 'they stay grey while the tests run');
  // Two runs that are alike at their start may differ later.
  await page.value('tumble.begunAt = performance.now()');
  await tell({ kind: 'difference', same_until_s: 0.2 });
  expect(await text('difference') === '', `0.2 s are no agreement: ${await text('difference')}`);
  await page.until('!document.getElementById("difference").hidden', 'that it is the same, a second later', 20);
  // A difference is no fault, unless the save has broken tests.
  await tell({ kind: 'difference', same_until_s: 3, time_s: 1.25, what: 'handle is 0.062 m from where it is in the run before', body: 0 });
  await verdicts(result('one', 'right'), result('two', 'right'), result('three', 'right'));
  expect(await old() === '', 'the new verdicts are not grey');
  expect(/Another motion than in the run before, from 1\.25 s on: handle is then 0\.062 m away from its place in the run before\. Of the tests this save has mended 2 and broken 0\./.test(await text('difference')), `the difference: ${await text('difference')}`);
  const color = () => page.value('getComputedStyle(document.getElementById("difference")).borderLeftColor'), bad = await page.value('(() => { const line = document.createElement("i"); line.style.color = "var(--bad)"; document.body.append(line); const color = getComputedStyle(line).color; line.remove(); return color; })()');
  expect(await color() !== bad, 'better verdicts have no colour of a fault');
  await tell({ kind: 'code_saved', file: 'a1.cpp', id: 'a1' });
  await verdicts(result('one', 'right'), result('two', 'wrong'), result('three', 'right'));
  expect(await color() === bad, 'broken tests have it');
  if (pictures) await page.picture(join(pictures, 'worse.png'));
  // The saved code has crashed before its first frame.
  await page.value('document.getElementById("go").click()');
  await page.until('tumble.paused && document.getElementById("go").textContent === "Go"', 'the pause', 20);
  await sleep(300);   // frames on their way
  await tell({ kind: 'trouble', title: 'Crashed', text: 'SIGSEGV', ends_run: true, shows_former: true });
  const clock = await page.value('document.getElementById("clock").textContent');
  expect(await text('difference') === '', `nothing is said of a run that is none: ${await text('difference')}`);
  expect(/^The run of the code before your last save, at its end: the saved code has not moved anything/.test(await text('hint')), `the picture is called what it is: ${await text('hint')}`);
  expect(Number(await page.value('getComputedStyle(document.getElementById("picture")).opacity')) < 0.7, 'the picture is grey');
  await tell({ kind: 'difference', same_until_s: 35.7 });
  expect(await text('difference') === '', 'a comparison that comes late is not shown');
  await sleep(500);
  expect(await page.value('document.getElementById("clock").textContent') === clock, 'the clock stands');
  if (pictures) await page.picture(join(pictures, 'crashed.png'));
  await tell({ kind: 'trouble', title: 'Does not compile', text: 'line 7', shows_former: true });
  expect(await text('difference') === '', 'nor of code that does not compile');
  expect(page.errors.length === 0, `the page has errors: ${page.errors.join('; ')}`);
  await live.stop();
});

test('what is said beside the run is true of it', async () => {
  const live = await Live.start('poked_box', '--modules', 'reference');
  const page = await browser.open(live.address, { before: `const Source = EventSource; window.EventSource = class extends Source { constructor(...words) { super(...words); window.stream = this; } };
    window.tell = message => stream.dispatchEvent(new MessageEvent('say', { data: JSON.stringify(message) }));` });
  const tell = message => page.value(`tell(${JSON.stringify(message)})`), text = id => page.value(`document.getElementById("${id}").textContent.trim()`);
  await page.until('tumble.run && tumble.run.length > 30 && tumble.hadStage', 'the motion');
  // Of the shown scene, of another one, of none.
  const unsaved = () => page.value('getComputedStyle(document.getElementById("unsaved")).visibility === "hidden" ? "" : document.getElementById("unsaved").textContent');
  expect(await unsaved() === '', `nothing is unsaved at the start: ${await unsaved()}`);
  await tell({ kind: 'unsaved', is: true, others: ['pong_1'] });
  expect(await unsaved() === 'not saved', `the shown scene is not saved: ${await unsaved()}`);
  await tell({ kind: 'unsaved', is: false, others: ['pong_1'] });
  expect(await unsaved() === 'pong_1: not saved' && /to pong_1 /.test(await page.value('document.getElementById("unsaved").title')), `another one is not saved: ${await unsaved()}`);
  await tell({ kind: 'unsaved', is: false, others: [] });
  // A body of which a part is in the picture has not left it.
  const lost = beyond => page.value(`(() => {
    const { picture, time } = tumble, { camera } = picture, { place, radius } = picture.placesAt(time)[0], stood = camera.position.clone(), ahead = camera.getWorldDirection(stood.clone()), right = ahead.clone().cross(camera.up).normalize();
    const away = 10 * radius, half = away * Math.tan(camera.fov * Math.PI / 360) * camera.aspect;
    camera.position.copy(place).addScaledVector(ahead, -away).addScaledVector(right, half + ${beyond} * radius);
    const is = picture.isLost(time);
    camera.position.copy(stood);
    return is;
  })()`);
  expect(await lost(0.5) === false && await lost(1.5) === true, `half of a body in the picture: ${await lost(0.5)}; none of it: ${await lost(1.5)}`);
  // A ray of the reference is not the user's; a push by numbers has none.
  const point_body_m = [0.1, 0, 0];
  await tell({ kind: 'aimed', body: 0, face: 3, point_body_m });
  expect(/by the ray function of the reference$/.test(await text('aimed')), `whose ray: ${await text('aimed')}`);
  await tell({ kind: 'aimed', body: 0, point_body_m });
  expect(!/ray/.test(await text('aimed')), `no ray: ${await text('aimed')}`);
  // A pull of many forces is one.
  for (let i = 0; i < 20; ++i) await tell({ kind: 'push', push: { body: 'box', force_n: [1, 0, 0], point_m: [0, 0, 0], start_s: 1 + i / 60, duration_s: 1 / 60 } });
  await page.value('[...document.querySelectorAll("#tabs button")].find(tab => tab.textContent === "Change").click()');
  expect(/with the push so far/.test(await page.value('document.querySelector("#panes").textContent')), 'a pull is not twenty pushes');
  // Of a run that went on after the one before had stopped it is not said that nothing has changed.
  await page.value('tumble.reason = "code", tumble.savedId = "a1", tumble.former = { end: 0.25, length: 9, stopped: "Crashed" }, 1');
  await tell({ kind: 'difference', same_until_s: 0.25 });
  await page.until('!document.getElementById("difference").hidden', 'what is said of both runs', 20);
  expect(await page.value('document.querySelector("#difference span").textContent') === 'The run before stopped at 0.25 s. This one is the same until then, and goes on.', `the run before had stopped: ${await text('difference')}`);
  await page.value('tumble.former = null, 1');
  // The compiler is at work for as long as it is, also where the run before ends meanwhile.
  await tell({ kind: 'code_saved', file: 'a1.cpp', id: 'a1' });
  await tell({ kind: 'starting', reason: 'code' });
  await tell({ kind: 'end', stopped_by: '', time_s: 120, faults: '' });
  expect(/^compiling …/.test(await text('state')), `it is compiled still: ${await text('state')}`);
  await page.value('tumble.status.since -= 11000');
  await page.until('document.getElementById("state").textContent === "compiling … 10 s"', 'for how long it is compiled', 20);
  // Virtual times are those of a timewarp: the tab goes with it.
  const tabs = () => page.value('[...document.querySelectorAll("#tabs button")].filter(tab => tab.checkVisibility()).map(tab => tab.textContent).join()');
  await page.value('tumble.run.facts.engine = "tw"');
  await tell({ kind: 'times', processes: ['box'], from: 0, moves: [[0, 0, 0.5, 0]] });
  expect(/Virtual times/.test(await tabs()), `tabs of a timewarp: ${await tabs()}`);
  await page.value('[...document.querySelectorAll("#tabs button")].find(tab => tab.textContent === "Virtual times").click()');
  await page.value('tumble.run.facts.engine = "rd"');
  await tell({ kind: 'times', processes: ['box'], from: 0, moves: [] });
  expect(!/Virtual times/.test(await tabs()) && await page.value('document.querySelector("#tabs [aria-selected=true]").textContent') === 'Change', `tabs of another engine: ${await tabs()}`);
  // A long line that is no story stays in the pane.
  await tell({ kind: 'verdicts', id: 'a1', title: 'Impulse', file: 'a1.cpp', handout: 'handouts/a1_impulse', said: `tumble: ${'a long line '.repeat(30)}`, tests: [] });
  await page.value('[...document.querySelectorAll("#tabs button")].find(tab => tab.textContent === "Verdicts").click()');
  expect(await page.value('[...document.querySelectorAll(".pane")].every(pane => pane.scrollWidth <= pane.clientWidth)'), 'the pane is not wider than it is');
  expect(page.errors.length === 0, `the page has errors: ${page.errors.join('; ')}`);
  // Ctrl-C in the terminal.
  await live.stop();
  await page.until('/^The program has ended.*Start it again in the terminal/s.test(document.getElementById("trouble").textContent.trim())', 'what to do when the program has ended', 20);
  await sleep(4000);   // the stream is tried again
  expect(await text('state') === 'the program has ended', `it stays ended: ${await text('state')}`);
  // What only the program could do is disabled, by mouse and keyboard, and says why; the rest works on what has come.
  for (const tab of ['Change', 'Body', 'Scenes']) {
    await page.value(`[...document.querySelectorAll("#tabs button")].find(tab => tab.textContent === "${tab}").click()`);
    await sleep(300);   // panes are shown anew
    const free = await page.value('[...document.querySelectorAll(".pane:not([hidden]) :is(button, input, select), #over, #bare, #go, #save, #speed, #toolPush, #toolPull")].filter(e => !e.disabled || !/^The program has ended/.test(e.title)).map(e => e.outerHTML.slice(0, 60))');
    expect(free.length === 0, `of a program that has ended, with ${tab}: ${free}`);
  }
  await page.value('document.getElementById("closeTrouble").click(), window.asksThen = performance.getEntriesByType("resource").filter(e => /\\/do$/.test(e.name)).length');
  for (const key of ['r', ' ', '2', 'ArrowRight']) await page.value(`window.dispatchEvent(new KeyboardEvent("keydown", { key: "${key}" }))`);
  await page.value('document.getElementById("back").click()');
  await sleep(300);
  expect(await page.value('tumble.tool === "look" && document.getElementById("trouble").hidden && performance.getEntriesByType("resource").filter(e => /\\/do$/.test(e.name)).length === asksThen'), 'keys ask a program that has ended');
  expect(await page.value('!document.getElementById("on").disabled && !document.getElementById("toolLook").disabled'), 'what has come can be looked at');
  if (pictures) await page.picture(join(pictures, 'gone.png'));
});

test('a page of another origin gets nothing', async () => {
  const live = await Live.start('poked_box', '--modules', 'reference'), address = new URL(live.address);
  const foreign = createServer((request, response) => { response.setHeader('Content-Type', 'text/html'); response.end('<title>foreign</title>'); });
  await new Promise(resolve => foreign.listen(0, '127.0.0.1', resolve));
  const page = await browser.open(`http://127.0.0.1:${foreign.address().port}/`);
  await page.until('document.title === "foreign"', 'the foreign page');
  const tries = await page.value(`(async () => {
    const got = [], url = ${JSON.stringify(address.href)};
    for (const path of ['', 'live.js', 'stream']) try { got.push(path + ' ' + (await (await fetch(url + path)).text()).length); } catch { }
    try { const answer = await fetch(url + 'do', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: '{"do":"save"}' }); got.push('post ' + answer.status); } catch { }
    await fetch(url + 'do', { method: 'POST', mode: 'no-cors', headers: { 'Content-Type': 'text/plain' }, body: '{"do":"save"}' }).catch(() => {});
    const loads = make => new Promise(resolve => { const e = make(); e.onload = () => resolve(true); e.onerror = () => resolve(false); document.head.append(e); setTimeout(() => resolve(false), 3000); });
    if (await loads(() => Object.assign(document.createElement('script'), { src: url + 'live.js' }))) got.push('script');
    const stream = new EventSource(url + 'stream');
    if (await new Promise(resolve => { stream.onopen = () => resolve(true); stream.onerror = () => resolve(false); setTimeout(() => resolve(false), 3000); })) got.push('stream opened');
    return got;
  })()`);
  expect(tries.length === 0, `the foreign page got: ${tries.join(', ')}`);
  expect(!existsSync(join(folder, 'saves/poked_box_1.json')), 'the foreign page saved a scene');
  foreign.close();
  await live.stop('SIGHUP');
}, false);

test('a saved slip shows its verdict; errors, loops and crashes are shown and the page lives on', async () => {
  const file = join(folder, 'a1_impulse.cpp'), right = readFileSync(join(root, 'solutions_private/a1_impulse/a1_impulse.cpp'), 'utf8');
  writeFileSync(file, right);
  const live = await Live.start('ball_against_wall', '--modules', `a1=${file},a2=reference`), page = await browser.open(live.address);
  await page.until('tumble.run && tumble.run.length > 5', 'the motion', 120);
  await page.until('document.body.dataset.verdicts', 'the verdicts of a right file', 240);
  expect(!/wrong|crashed/.test(await page.value('document.body.dataset.verdicts')), 'the reference is right');
  const save = async (text, what, until) => {
    const runs = Number(await page.value('document.body.dataset.runs')), from = Date.now();
    writeFileSync(file, text);
    await page.until(until(runs), what, 240);
    console.log(`  ${what}: ${((Date.now() - from) / 1000).toFixed(1)} s, load ${loadavg()[0].toFixed(1)}`);
  };
  const slipped = right.replace('(1.0 + restitution)', '(1.0 - restitution)');
  expect(slipped !== right, 'the slip is in the file');
  await save(slipped, 'save to new motion', runs => `Number(document.body.dataset.runs) > ${runs} && tumble.run.length > 2`);
  await page.until('/wrong/.test(document.body.dataset.verdicts)', 'the verdict of the slip', 240);
  await page.until('document.body.dataset.difference', 'the first difference from the run before', 60);
  expect((await page.value('document.querySelector("#panes").textContent')).includes('wrong'), 'the pane shows a story');
  if (pictures) await page.picture(join(pictures, 'slip.png'));
  await save(right.replace('return', 'retrun'), 'save to the compiler\'s error', () => '/not compile/.test(document.body.dataset.trouble || "")');
  expect(/a1_impulse\.cpp.*\d+/s.test(await page.value('document.body.dataset.trouble')), 'the error has file and line');
  if (pictures) await page.picture(join(pictures, 'error.png'));
  // A run that has stopped is no save that changed nothing.
  await save(right.replace('return -(1.0', 'return std::sqrt(-1.0'), 'save to the run that stopped', () => '/not a number/.test(document.body.dataset.trouble || "")');
  await page.until('/^This run has stopped; it is the same as the run before until [0-9.]+ s\\.$/.test(document.querySelector("#difference span").textContent)', 'that it stopped, and no advice', 20);
  await save(right.replace('return -(1.0', 'return *static_cast<volatile double*>(nullptr) + (1.0'), 'save to the crash', () => '/Segmentation fault/.test(document.body.dataset.trouble || "")');
  const stood = await page.value('document.getElementById("clock").textContent');
  await sleep(1500);
  expect(await page.value('document.getElementById("clock").textContent') === stood, 'nothing moves after a crash');
  expect(JSON.parse(await page.value('document.body.dataset.asked')).a1.collision_impulse >= 1, `the call that crashed is one of the run: ${await page.value('document.body.dataset.asked')}`);
  await save(right, 'mended', runs => `Number(document.body.dataset.runs) > ${runs} && !document.body.dataset.trouble && tumble.run.length > 2`);
  expect(page.errors.length === 0, `the page has errors: ${page.errors.join('; ')}`);
  await live.stop('SIGTERM');
});

test('the page says what a run asks, and begins another scene on the same code', async () => {
  const file = join(folder, 'asked_a1_impulse.cpp'), right = readFileSync(join(root, 'solutions_private/a1_impulse/a1_impulse.cpp'), 'utf8');
  writeFileSync(file, right);
  const live = await Live.start('poked_box', '--modules', `a1=${file}`), page = await browser.open(live.address);
  await page.until('tumble.run && tumble.run.length > 60', 'the motion', 120);
  const asked = JSON.parse(await page.until('document.body.dataset.asked', 'what the run asks', 60));
  expect(asked.a1 && asked.a1.wrench_of_point_force > 0 && !('angular_acceleration' in asked.a1), `the box asks for the wrench of its push only: ${JSON.stringify(asked)}`);
  const said = await page.value('document.querySelector(".asked").textContent');
  expect(/This run asks a1 for wrench_of_point_force \d+/.test(said) && /Only the tests ask: .*angular_acceleration/.test(said) && /Not asked here.*collision_impulse/.test(said), `the pane says it: ${said}`);
  await page.until('document.body.dataset.verdicts', 'the verdicts', 240);
  // A save that this scene does not show.
  const runs = Number(await page.value('document.body.dataset.runs'));
  writeFileSync(file, `${right}\n// saved again\n`);
  await page.until(`Number(document.body.dataset.runs) > ${runs}`, 'the run of the save', 240);
  const same = await page.until('/only for/.test(document.getElementById("difference").textContent) && document.getElementById("difference").textContent', 'that it is the same', 60);
  expect(/The same as the run before .*This scene asks a1 only for wrench_of_point_force: if you changed another function, look at the tests, or choose a scene/.test(same), `what is said of it: ${same}`);
  if (pictures) await page.picture(join(pictures, 'same.png'));
  await page.value('document.getElementById("toScenes").click()');
  const offered = await page.value('[...document.querySelectorAll(".scenes li")].map(li => li.textContent).join("|")');
  expect(/poked_box.*asks a1 for wrench_of_point_force/.test(offered), 'the list says what the scene has asked');
  if (pictures) await page.picture(join(pictures, 'scenes.png'));
  await page.until('/right/.test(document.body.dataset.verdicts || "") && Number(document.body.dataset.judged) >= 2', 'the verdicts of the save', 240);
  const judged = await page.value('document.body.dataset.judged');
  await page.value('[...document.querySelectorAll(".scenes li button")].find(button => button.textContent.includes("collide_off_centre_e05")).click()');
  await page.until('document.body.dataset.scene === "collide_off_centre_e05" && tumble.run && tumble.run.length > 60 && tumble.hadStage', 'the chosen scene', 120);
  await page.until('JSON.parse(document.body.dataset.asked).a1.collision_impulse > 0', 'what the impact asks', 60);
  expect(await page.value('tumble.former === null'), 'no ghost of another scene');
  expect(await page.value('document.body.dataset.judged') === judged && (await page.value('document.querySelector("#panes").textContent')).includes('tests are right'), 'the verdicts stay');
  expect((await page.value('tumble.run.facts.modules')).includes(file), 'the same code runs');
  if (pictures) await page.picture(join(pictures, 'chosen.png'));
  expect(page.errors.length === 0, `the page has errors: ${page.errors.join('; ')}`);
  await live.stop();
});

test('the view finds and follows; changes keep pushes; a refused number stands at its field', async () => {
  const scene = join(folder, 'leaving.json');
  writeFileSync(scene, JSON.stringify({ title: 'A box that leaves', duration_s: 5, step_s: 1 / 240, needs: ['a1'], bodies: [{ name: 'box', shape: { box: { size_m: [0.6, 0.6, 0.6] } }, mass_kg: 3, position_m: [0, 0, 1] }],
    camera: { eye_m: [0, -4, 1], target_m: [0, 0, 1], field_of_view_deg: 40 }, grid: { spacing_m: 0.5 } }));
  const live = await Live.start(scene, '--modules', 'reference'), page = await browser.open(live.address);
  await page.until('window.tumble && tumble.run && tumble.run.length > 5 && tumble.hadStage', 'the motion');
  const box = JSON.parse(await page.value('JSON.stringify(document.getElementById("picture").getBoundingClientRect())')), x = box.x + box.width / 2, y = box.y + box.height / 2;
  expect(await page.value('document.body.dataset.unsaved') === 'false', 'nothing is unsaved at the start');
  // Over a tenth of the picture's height: 0.3 of its weight.
  await page.drag([x, y], [x + 0.1 * box.height, y]);
  const push = JSON.parse(await page.until('tumble.pushes.length > 0 && JSON.stringify(tumble.pushes[0])', 'the push')), weights = Math.hypot(...push.force_n) / 3 / 9.81;
  expect(near(weights, 0.3, 0.02), `a drag over a tenth of the picture is 0.3 of the weight: ${weights}`);   // whole pixels: 1/70
  expect(/of its weight/.test(await page.value('document.getElementById("aimed").textContent')) || await page.until('/hit box/.test(document.getElementById("aimed").textContent)', 'what was hit'), 'the push is told in weights');
  await page.until('document.body.dataset.unsaved === "true"', 'that it is not saved');
  expect(await page.value('getComputedStyle(document.getElementById("unsaved")).visibility') === 'visible', 'the page shows that it is not saved');
  // Away it goes, to be found again.
  const y0 = await page.value('document.getElementById("go").getBoundingClientRect().top');
  await page.value('(async () => { const post = c => fetch("do", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(c) }); await post({ do: "aim", body: 0, point_body_m: [0, 0, 0] }); await post({ do: "push", force_n: [3000, 0, 0], duration_s: 0.1 }); })()');
  await page.until('/left the picture/.test(document.getElementById("hint").textContent)', 'that the box has left');
  if (pictures) await page.picture(join(pictures, 'lost.png'));
  await page.value('document.getElementById("go").click()');
  await page.until('document.getElementById("state").textContent === "paused"', 'the pause', 20);
  // The page has drawn nothing since the pause: found is what has moved on until then.
  await page.value('tumble.time = tumble.pushes[1].start_s; document.getElementById("all").click()');
  await page.until('!/left the picture/.test(document.getElementById("hint").textContent)', 'that it is found', 20);
  await page.value('document.getElementById("go").click()');
  await page.value('document.getElementById("follow").click()');
  await sleep(2500);
  const off = await page.value('(() => { const t = tumble.picture.time, at = tumble.run.frameAt(t), place = tumble.picture.orbit.target.clone(), turn = tumble.picture.camera.quaternion.clone(), centre = tumble.picture.orbit.target.clone(); tumble.run.pose(0, at, place, turn); return place.distanceTo(centre); })()');
  expect(off < 1, `the view follows the box: off by ${off} m`);
  if (pictures) await page.picture(join(pictures, 'follow.png'));
  // A change keeps the pushes, and another number is refused where it stands.
  await page.value('[...document.querySelectorAll("#tabs button")].find(tab => tab.textContent === "Change").click()');
  expect(/with the 2 pushes so far/.test(await page.value('document.querySelector("#panes").textContent')), 'the pane says that the pushes stay');
  const enter = (field, value) => page.value(`(() => { const input = document.querySelector('[aria-label="${field}"]'); input.value = '${value}'; input.dispatchEvent(new Event('change')); return input.classList.contains('refused') + ' ' + input.parentElement.textContent; })()`);
  const runs = Number(await page.value('document.body.dataset.runs'));
  expect(/^true .*from 0 to 1/.test(await enter('restitution', '7')), 'the number is marked and told of');
  expect(Number(await page.value('document.body.dataset.runs')) === runs, 'a refused number begins nothing');
  await enter('restitution', '0.5');
  await page.until(`Number(document.body.dataset.runs) > ${runs} && tumble.run.length > 2`, 'the changed run');
  expect(await page.value('tumble.pushes.length') === 2, 'the pushes are kept');
  expect(await page.value('document.querySelectorAll(".refused").length') === 0, 'the mark has gone');
  expect(Math.abs(await page.value('document.getElementById("go").getBoundingClientRect().top') - y0) < 0.5, 'no message has moved the buttons');
  // The menu closes by a key, and by a click beside it.
  for (const close of ['window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }))', 'document.getElementById("side").dispatchEvent(new PointerEvent("pointerdown", { bubbles: true }))']) {
    await page.value('document.getElementById("show").open = true');
    await page.value(close);
    expect(await page.value('document.getElementById("show").open') === false, `the menu closes by ${close}`);
  }
  await page.value('document.getElementById("save").click()');
  await page.until('document.body.dataset.unsaved === "false"', 'that it is saved');
  expect(page.errors.length === 0, `the page has errors: ${page.errors.join('; ')}`);
  await live.stop();
});

test('300 bodies', async () => {
  const live = await Live.start('gas', '--n', '300', '--modules', 'reference'), page = await browser.open(live.address, { width: 1280, height: 720 });
  await page.until('tumble.run && tumble.run.length > 30', 'the motion', 120);
  await sleep(6000);
  const cpu = pid => { const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' '); return (Number(fields[11]) + Number(fields[12])) / 100; };
  const browsers = () => execFileSync('ps', ['-eo', 'pid=,args=']).toString().split('\n').filter(line => line.includes(browser.folder)).map(line => Number(line.trim().split(' ')[0])), seconds = pids => pids.reduce((sum, pid) => { try { return sum + cpu(pid); } catch { return sum; } }, 0);
  const began = { cpu: seconds(browsers()), of: cpu(live.processes()[0]), frames: await page.value('tumble.frames'), drawn: await page.value('tumble.picture.renderer.info.render.frame') };
  await sleep(8000);
  const frames_ = await page.value('tumble.frames') - began.frames, drawn_ = await page.value('tumble.picture.renderer.info.render.frame') - began.drawn;
  console.log(`  CPU: ${(1000 * (cpu(live.processes()[0]) - began.of) / frames_).toFixed(1)} ms a frame to simulate, ${(1000 * (seconds(browsers()) - began.cpu) / Math.max(1, drawn_)).toFixed(0)} ms a picture in all processes of the browser (${drawn_} pictures, pixel ratio ${await page.value('tumble.picture.ratio.toFixed(2)')})`);
  const [shown, frames] = await page.value('[document.body.dataset.fps, document.body.dataset.frameRate]');
  console.log(`  300 bodies at 1280x720, drawn by the processor: ${shown} pictures a second, ${frames} frames a second from the program (load ${loadavg()[0].toFixed(1)})`);
  expect(Number(frames) > 0 && Number(shown) > 0, 'it moves');
  if (await page.value('tumble.picture.isSoftware')) {
    const drawn = await page.value('[tumble.picture.discs.points.visible, tumble.picture.renderer.info.render.triangles]');
    expect(drawn[0] && drawn[1] < 8000, `balls are no meshes: ${drawn}`);   // meshes of 300 balls have 20000 to 40000 triangles
    // All pixels where it is paused, and those of before where it goes on.
    await page.value('tumble.picture.setRatio(0.5); document.getElementById("go").click()');
    await page.until('tumble.picture.ratio === Math.min(2, window.devicePixelRatio)', 'all pixels of the paused run', 20);
    await page.value('document.getElementById("go").click()');
    await page.until('tumble.picture.ratio < 0.8', 'fewer pixels of the run that goes on', 20);
  }
  await live.stop();
});

test('poking leaks nothing', async () => {
  const live = await Live.start('poked_box', '--modules', 'reference'), page = await browser.open(live.address);
  await page.until('tumble.run && tumble.run.length > 5', 'the motion');
  const before = { memory: live.memory(), descriptors: live.descriptors() }, end = Date.now() + 1000 * Number(seconds);
  let pokes = 0;
  for (let round = 0; Date.now() < end; ++round) {
    await page.value('(async () => { const post = c => fetch("do", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(c) }); for (let i = 0; i < 20; ++i) { await post({ do: "aim", body: 0, point_body_m: [0.1, 0.1, 0] }); await post({ do: "push", force_n: [i - 9.5, 0, 0], duration_s: 0.02 }); } })()');
    pokes += 20;
    if (round % 5 === 4) await page.value('document.getElementById("bare").click()');
    await sleep(100);
  }
  await sleep(1500);
  const after = { memory: live.memory(), descriptors: live.descriptors() };
  console.log(`  ${pokes} pokes in ${seconds} s: memory ${before.memory} to ${after.memory} KiB, descriptors ${before.descriptors} to ${after.descriptors}, processes ${live.processes().length}`);
  expect(after.descriptors <= before.descriptors + 4, 'descriptors are closed');
  expect(live.processes().length <= 2, 'processes end');
  expect(after.memory < before.memory + 60000, 'memory stays');   // a run and the one before it are kept: some MB
  const children = live.processes();
  await live.stop('SIGKILL');   // even so nothing is left
  await sleep(1500);
  expect(children.filter(pid => pid > 0 && existsSync(`/proc/${pid}`) && /tumble/.test((() => { try { return readlinkSync(`/proc/${pid}/exe`); } catch { return ''; } })())).length === 0, 'processes are left');
});

test('a tab of an earlier start says that its address is old', async () => {
  const live = await Live.start('drop_a_box', '--modules', 'reference'), port = new URL(live.address).port, page = await browser.open(live.address, { width: 400 });
  await page.until('tumble.run && tumble.run.length > 1', 'the motion');
  await live.stop();
  await page.until('document.body.textContent.includes("the program has ended")', 'that it has ended');
  const again = await Live.start('drop_a_box', '--modules', 'reference', '--port', port);
  await page.until('document.body.textContent.includes("open the address that the terminal shows now")', 'what to do', 20);
  await page.send('Page.navigate', { url: live.address });
  await page.until('document.title === "Refused"', 'the refused page');
  expect(await page.value('document.documentElement.scrollWidth <= 400 && getComputedStyle(document.body).maxWidth !== "none"'), 'the refused page has no style, or scrolls sideways');
  await again.stop();
});

try {
  const only = process.env.LIVE_ONLY;
  for (const { name, run, needsReference } of tests) {
    if (only && !name.includes(only)) continue;
    if (isQuick && !kQuick.some(part => name.includes(part))) { console.log(`left out: ${name}: ./tumble test --whole -R live_page`); continue; }
    if (needsReference && !hasReference) { console.log(`skipped: ${name}: this tree has no reference modules`); continue; }
    const before = failed;
    failed = 0;
    try { await run(); } catch (error) { failed = 1; console.log(`  WRONG: ${error.message}`); }
    Live.killAll();   // of a test that has ended early
    console.log(`${failed ? 'wrong' : 'right'}: ${name}`);
    failed = failed || before;
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed);
