// Assembles the page: the stream from the program, time, the panes.

const byId = id => document.getElementById(id);

const shown = { v: false, omega: false, L: false, impulse: true, contact: true, constraint: false, axes: false, centres: false, chosenOnly: false, ghost: true, forces: true, links: true, halo: false, ground: true, shadows: true };
const page = { run: null, former: null, pushes: [], changes: {}, chosen: -1, tool: 'push', paused: false, speed: 1, time: 0, follows: true, difference: null, frames: 0, picture: null, asked: null, status: { text: 'starting', kind: '', since: 0 }, isStarting: false, isLost: false, finds: false, findsUntil: 0, isFormerOnly: false, begunAt: 0, turnAt: 0 };

// One after the other: a pull that came behind its release would hold the body for ever.
let posted = Promise.resolve();
function post(command) {
  if (page.isGone) return posted;
  posted = posted.then(() => fetch('do', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(command) })).catch(showGone);
  return posted;
}

function say(text, kind = '') {
  const isSame = page.status.text === text;
  page.status = { text, kind, since: isSame ? page.status.since : performance.now() };
  showState();
}

const kWorthCounting = 5;   // s: what takes longer says how long it has taken

// A run that goes on may be paused, or be looked at at an earlier instant.
function showState() {
  const { text, kind } = page.status, isGoing = text === 'running' && page.run && page.run.length > 0;
  const waited = kWorthCounting * Math.floor((performance.now() - page.status.since) / 1000 / kWorthCounting);
  const words = kind === 'busy' && waited > 0 ? `${text} ${waited} s` : !isGoing ? text : isPast() ? 'paused at an earlier instant' : page.paused ? 'paused' : text;
  if (byId('state').textContent !== words) byId('state').textContent = words;
  byId('state').className = kind;
}

// ---- Time ----

function goTo(time) {
  page.follows = false;
  page.time = Math.max(0, Math.min(time, page.run ? page.run.end : 0));
  if (!page.paused) setPace(true, page.speed);
  showTime();
  showHint();
}

function isPast() { return Boolean(page.run && page.run.length > 0 && !page.follows && page.time < page.run.end - sameInstant(page.run.times)); }

function newest() {
  page.follows = true;
  if (page.run) page.time = page.run.end;
  showTime();
  showHint();
}

function setPace(paused, speed) {
  page.paused = paused;
  page.speed = speed;
  post({ do: 'pace', paused, speed });
  showTime();
}

function showTime() {
  const run = page.run, end = run && run.length ? run.end : 0;
  byId('clock').textContent = `${page.time.toFixed(3)} s`;
  byId('scrub').max = String(Math.max(end, 1e-3));
  byId('scrub').value = String(page.time);
  byId('go').textContent = page.paused || page.ended || page.isGone ? 'Go' : 'Pause';
  byId('go').disabled = !run || (page.ended && !isPast());
  byId('go').title = page.ended ? 'The run has ended: start over, or go back to an earlier instant' : 'Go and pause (space)';
  byId('here').classList.toggle('off', !isPast());
  byId('newest').classList.toggle('off', !isPast());
  byId('on').disabled = !page.paused;
  byId('bare').disabled = page.pushes.length === 0;
  if (page.isGone) lock();
  showState();
}

function toggle() {
  if (!page.run || page.isGone || (page.ended && !isPast())) return;
  if (!page.paused && !page.ended) return setPace(true, page.speed);
  newest();
  setPace(false, page.speed);
}

function stepBack() {
  if (!page.run || page.run.length === 0) return;
  const times = page.run.times, at = page.run.frameAt(page.time);
  let k = Math.max(0, at.k - (at.part > 1e-3 ? 0 : 1));
  while (k > 0 && times[k] > page.time - sameInstant(times)) --k;   // nearer frames count as the same instant
  goTo(times[k]);
}

function stepOn() {
  const run = page.run;
  if (!run || run.length === 0) return;
  const k = run.frameAt(page.time).k;
  if (k + 1 < run.length) { page.time = run.times[k + 1]; page.follows = k + 2 >= run.length; showHint(); return showTime(); }
  newest();
  post({ do: 'step' });
}

function drawMarks() {
  const canvas = byId('marks'), width = canvas.clientWidth, height = canvas.clientHeight, run = page.run, ratio = window.devicePixelRatio || 1;
  if (!width) return;
  canvas.width = width * ratio;   // clears it
  canvas.height = height * ratio;
  if (!run) return;
  const g = canvas.getContext('2d', { willReadFrequently: true }), inset = 8, end = run.end || 1, x = t => inset + t / end * (width - 2 * inset), style = getComputedStyle(document.body);
  g.scale(ratio, ratio);
  g.fillStyle = style.getPropertyValue('--before');
  g.globalAlpha = run.events.count > 300 ? 0.3 : 0.9;
  for (let i = Math.max(0, run.events.count - 3000), last = -1; i < run.events.count; ++i) {
    const at = Math.round(2 * x(run.events.time[i]));   // of many at one place one is drawn
    if (run.events.kind[i] !== kCollision || at === last) continue;
    g.fillRect(at / 2 - 0.5, 2, 1, height - 2);
    last = at;
  }
  g.globalAlpha = 1;
  g.fillStyle = '#d0306c';
  for (const push of page.pushes.slice(-400)) g.fillRect(x(push.start_s) - 1, 0, 2, height);
  if (page.difference && page.difference.time_s !== undefined) {
    g.fillStyle = style.getPropertyValue('--now');
    g.beginPath();
    g.moveTo(x(page.difference.time_s), height);
    g.lineTo(x(page.difference.time_s) - 5, 0);
    g.lineTo(x(page.difference.time_s) + 5, 0);
    g.fill();
  }
}

// ---- The hand ----

// The drag of a push is an arrow; from the top of the picture to its bottom it is three times the
// body's weight on Earth, so that bodies of all sizes and masses are pushed alike and stay in sight.
const kWeightsOfDrag = 3, kEarth = 9.81;

// way: of the drag [m]; span: metres across the picture there
function pushOf(body, way, span) {
  const mass = page.run.facts.bodies[body].mass_kg, seconds = Math.min(10, Math.max(0.001, Number(byId('pushTime').value) || 0.1));
  return { force: way.map(x => kWeightsOfDrag * kEarth * mass * x / span), mass, seconds };
}

function wordsOfPush(body, way, span) {
  const { force, mass, seconds } = pushOf(body, way, span), size = Math.hypot(...force);
  return `${page.run.about.bodies[body].name}: F = ${short(size, 3)} N, ${short(size / mass / kEarth, 2)} of its weight on Earth, for ${short(seconds)} s: its centre gains ${short(size / mass * seconds, 2)} m/s (m = ${short(mass)} kg)`;
}

const pullQueue = { last: 0, timer: 0 };
const hand = {
  tool: () => (page.follows ? page.tool : 'look'),
  choose(body) { page.chosen = body; byId('body').value = String(body); showPanes(true); },
  aim(ray) { post({ do: 'aim', ray }); },
  showPush(body, way, span) { byId('aimed').textContent = wordsOfPush(body, way, span); },
  push(body, way, span) {
    const { force, seconds } = pushOf(body, way, span);
    byId('aimed').textContent = `${wordsOfPush(body, way, span)}${page.paused ? '. It acts when the run goes on.' : ''}`;
    post({ do: 'push', force_n: force, duration_s: seconds });
  },
  pull(to) {   // at most 60 times a second
    clearTimeout(pullQueue.timer);
    const send = () => { pullQueue.last = performance.now(); post({ do: 'pull', to_m: to }); }, wait = pullQueue.last + 16 - performance.now();
    if (wait <= 0) send(); else pullQueue.timer = setTimeout(send, wait);
  },
  release() { clearTimeout(pullQueue.timer); post({ do: 'release' }); },
};

function setTool(tool) {
  if (page.isGone && tool !== 'look') return;
  page.tool = tool;
  for (const [id, word] of [['toolPush', 'push'], ['toolPull', 'pull'], ['toolLook', 'look']]) byId(id).setAttribute('aria-checked', String(tool === word));
  showHint();
}

function showHint() {
  const run = page.run;
  if (!run) { byId('hint').textContent = ''; return; }
  const words = { push: 'Drag from a body and let go: a force pushes it.', pull: run.facts.can_pull ? 'Drag a body: the spring of a3 holds it.' : 'Pulling needs the engine rd and the spring of a3.', look: 'Drag turns the view.' };
  if (page.ended) words.push = words.pull = `The run has ended${run.stopped ? '' : `, because it lasts ${short(run.facts.duration_s)} s`}: start over, or go back to an earlier instant.`;
  const former = !page.isFormerOnly ? '' : page.ended ? 'The run of the code before your last save, at its end: the saved code has not moved anything. ' : 'The run of the code before your last save: the saved code has not moved anything yet. ';
  if (page.isFormerOnly && page.ended) words.push = words.pull = words.look = 'Go back to an earlier instant to look at it.';
  const lost = page.isLost ? ' All bodies have left the picture: “All” finds them, “Follow” keeps the chosen one in it.' : '';
  if (page.isGone)
    byId('hint').textContent =
        `The program has ended: what has come until then can be looked at.${lost}`;
  else
    byId('hint').textContent = former +
        (page.follows ? words[page.tool] :
                        'An earlier instant: “Go on from here” begins from it.') +
        lost;
}

// ---- Panes ----

const times = new TimesChart();
const asked = new AskedBox();
const panes = {
  verdicts: new VerdictPane(asked.box),
  scenes: new ScenesPane(name => { if (name !== page.scene) post({ do: 'scene', name }); }),
  change: new ChangePane(changes => post({ do: 'change', changes, keep: panes.change.keep.checked }), () => foldPushes(page.pushes).length),
  body: new BodyPane((body, point, force, seconds) => {
    if (!page.follows) newest();
    post({ do: 'aim', body, point_body_m: point }).then(() => post({ do: 'push', force_n: force, duration_s: seconds }));
  }),
};
const plots = kCurvePlots.map(about => new GrowingPlot(about));
const tabs = [['Verdicts', panes.verdicts.box], ['Scenes', panes.scenes.box], ['Curves', html('div', {}, ...plots.map(plot => plot.box))], ['Change', panes.change.box], ['Body', panes.body.box]];
let opened = 0;
const isOpen = title => tabs[opened][0] === title, openTabOf = title => openTab(tabs.findIndex(tab => tab[0] === title));

function addTab([title, box], i) {
  const tab = html('button', { id: `tab${i}` }, title), pane = html('div', { className: 'pane', tabIndex: 0 }, box);
  pane.setAttribute('aria-labelledby', tab.id);
  tab.setAttribute('role', 'tab');
  pane.setAttribute('role', 'tabpanel');
  tab.addEventListener('click', () => openTab(i));
  byId('tabs').append(tab);
  byId('panes').append(pane);
}

function openTab(at) {
  opened = at;
  [...byId('tabs').children].forEach((tab, i) => tab.setAttribute('aria-selected', String(i === at)));
  [...byId('panes').children].forEach((pane, i) => { pane.hidden = i !== at; });
  if (isOpen('Change') && page.run) panes.change.show(page.run, page.changes, page.chosen);
  showPanes(true);
}

// Only a timewarp has virtual times.
function showTimesTab() {
  if (!page.run) return;
  const at = tabs.findIndex(tab => tab[0] === 'Virtual times'), isThere = page.run.facts.engine === 'tw';
  if (isThere && at < 0) {
    tabs.push(['Virtual times', times.box]);
    addTab(tabs[tabs.length - 1], tabs.length - 1);
    openTab(opened);
  } else if (at >= 0) {
    byId(`tab${at}`).hidden = !isThere;
    if (!isThere && opened === at) openTabOf('Change');
  }
}

let panesShown = 0;
function showPanes(isNow) {
  const now = performance.now();
  if (!page.run || page.run.length === 0 || (!isNow && now - panesShown < 180)) return;
  panesShown = now;
  const former = shown.ghost && page.former && page.former.length > 1 ? page.former : null;
  if (isOpen('Curves')) for (const plot of plots) plot.draw(page.run, former, page.time);
  if (isOpen('Body')) panes.body.show(page.run, page.chosen, page.time, page.pushes);
  if (isOpen('Virtual times')) times.draw(page.run.end);
  const isLost = Boolean(page.picture && page.picture.isLost(page.time));
  if (isLost !== page.isLost) { page.isLost = isLost; showHint(); }
  if (page.isGone) lock();
  drawMarks();
  showScales();
}

function showScales() {
  if (!page.picture || !page.picture.vectors) return;
  const words = Object.entries(kVectors).filter(([name]) => shown[name] && page.picture.vectors.scaleOf(name) > 0).map(([name, about]) => {
    const scale = page.picture.vectors.scaleOf(name), unit = roundDown(0.1 * page.picture.stage.sight / scale);
    return `${about.text}: ${short(unit)} ${about.unit} are ${short(unit * scale, 2)} m long`;
  });
  if (words.join() === showScales.words) return;
  showScales.words = words.join();
  byId('scales').textContent = '';
  byId('scales').append(...words.map(text => html('div', {}, text)));
}

function addOptions() {
  const options = [...Object.entries(kVectors).map(([name, about]) => [name, about.text, cssColor(about.color)]), ['axes', 'principal axes'], ['centres', 'centres of mass'], ['chosenOnly', 'of the chosen body only'],
    ['ghost', 'the run before, as a ghost', cssColor(kFormerColor)], ['forces', 'forces on points', cssColor(kColors.force)], ['links', 'springs, rods, joints', cssColor(kColors.rod)], ['halo', 'chosen body highlighted', cssColor(kChosen)], ['ground', 'ground and grid'], ['shadows', 'shadows']];
  for (const [name, text, color] of options) {
    const box = html('input', { type: 'checkbox', checked: shown[name], id: `show_${name}` }), swatch = html('i', { className: color ? '' : 'none' });
    if (color) swatch.style.background = color;
    box.addEventListener('change', () => { shown[name] = box.checked; showPanes(true); });
    byId('options').append(html('label', {}, box, swatch, html('span', {}, text)));
  }
}

function addControls() {
  const click = (id, act) => byId(id).addEventListener('click', act);
  click('over', () => post({ do: 'begin', keep: true }));
  click('bare', () => post({ do: 'begin', keep: false }));
  click('go', toggle);
  click('back', stepBack);
  click('on', stepOn);
  click('here', () => post({ do: 'back', time_s: page.time }));
  click('newest', newest);
  click('home', () => { if (!page.picture || !page.picture.stage) return; if (page.picture.isFollowing) follow(); page.picture.reset(); });
  click('all', findAll);
  click('follow', follow);
  click('toScenes', () => openTabOf('Scenes'));
  click('closeSaved', () => { byId('saved').hidden = true; });
  click('save', () => post({ do: 'save' }));
  click('closeTrouble', () => showTrouble(null));
  click('toDifference', () => goTo(page.difference.time_s));
  click('toolPush', () => setTool('push'));
  click('toolPull', () => setTool('pull'));
  click('toolLook', () => setTool('look'));
  byId('scrub').addEventListener('input', () => goTo(Number(byId('scrub').value)));
  for (const s of [0.05, 0.1, 0.25, 0.5, 1, 2, 4]) byId('speed').append(html('option', { value: String(s) }, `${s} ×`));
  byId('speed').value = '1';
  byId('speed').addEventListener('change', event => setPace(page.paused, Number(event.target.value)));
  byId('body').addEventListener('change', event => hand.choose(Number(event.target.value)));
  document.addEventListener('pointerdown', event => { if (!byId('show').contains(event.target)) byId('show').open = false; });
  window.addEventListener('keydown', event => {
    if (event.key === 'Escape' && byId('show').open) { byId('show').open = false; byId('show').querySelector('summary').focus(); }
    const target = event.target instanceof Element ? event.target : document.body;
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest('select, input[type=number], input[type=text]')) return;
    const onButton = target.closest('button, summary, input[type=checkbox], a');
    const acts = { ' ': onButton ? null : toggle, ArrowLeft: target.closest('[type=range]') ? null : stepBack, ArrowRight: target.closest('[type=range]') ? null : stepOn, r: () => post({ do: 'begin', keep: true }), a: findAll, f: follow, 1: () => setTool('push'), 2: () => setTool('pull'), 3: () => setTool('look') };
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    act();
    event.preventDefault();
  });
}

// At the next picture, which may be of a later instant than the one that is shown. Of a run that has just been paused
// some frames are still on their way: what they move is found, too.
function findAll() {
  page.finds = true;
  page.findsUntil = page.paused && page.follows ? performance.now() + 500 : 0;
}

function follow() {
  if (!page.picture) return;
  page.picture.isFollowing = !page.picture.isFollowing;
  page.picture.drawn = '';
  byId('follow').setAttribute('aria-pressed', String(page.picture.isFollowing));
}

const kTurnMs = 25;   // between two pictures that the processor draws: 30 a second of 60 turns

function tick(now) {
  if (page.status.kind === 'busy') showState();
  const run = page.run, dt = page.last === undefined ? 0 : Math.min(0.25, (now - page.last) / 1000);
  page.last = now;
  if (run && run.length > 0) {
    if (page.follows) {
      // Between the frames, a little behind the newest; straight to it where it is far ahead.
      page.time = page.paused || page.ended ? run.end : Math.min(run.end, page.time + dt * page.speed);
      if (run.end - page.time > 0.12 * Math.max(page.speed, 0.1)) page.time = run.end - 0.02 * page.speed;
    }
    page.ticks = (page.ticks || 0) + 1;
    // Where the processor draws, the compiler has it first, and every second turn is left to the run.
    const isSoftware = Boolean(page.picture) && page.picture.isSoftware;
    if (isSoftware && now - page.turnAt < kTurnMs) return void requestAnimationFrame(tick);
    page.turnAt = now;
    try {
      if (page.picture) {
        if (page.needsStage) { page.picture.setRun(run, page.former, page.hadStage); page.needsStage = false; page.hadStage = true; }
        if (page.finds && page.picture.stage) { page.picture.findAll(page.time, page.chosen); page.finds = page.paused && now < page.findsUntil; }
        if (!(page.isCompiling && isSoftware) && page.picture.needsDrawing(page.time, page.chosen)) page.picture.draw(page.time, page.chosen);
      }
    } catch (error) {
      noPicture(error);
    }
    if (page.follows) showTime();
    showPanes(false);
    page.drawn = (page.drawn || 0) + 1;
    if (page.since === undefined) [page.since, page.drawn, page.ticks, page.framesThen] = [now, 0, 0, page.frames];
    else if (now - page.since > 1000) {
      document.body.dataset.fps = (page.drawn * 1000 / (now - page.since)).toFixed(1);
      document.body.dataset.frameRate = ((page.frames - page.framesThen) * 1000 / (now - page.since)).toFixed(1);
      if (page.picture) page.picture.adapt(Number(document.body.dataset.fps), page.ticks * 1000 / (now - page.since), page.paused);
      page.since = undefined;
    }
  }
  requestAnimationFrame(tick);
}

function noPicture(error) {
  byId('noPicture').textContent = `The motion cannot be drawn here (${error.message}). Curves and verdicts work.`;
  byId('noPicture').hidden = false;
  page.picture = null;
}

function listen() {
  const stream = new EventSource('stream');
  stream.addEventListener('say', event => { const message = JSON.parse(event.data); if (told[message.kind]) told[message.kind](message); });
  stream.addEventListener('f', event => {
    if (!page.run) return;
    page.run.addFrame(floatsOf(event.data));
    ++page.frames;
    if (page.ended) { page.ended = false; showHint(); }
  });
  stream.addEventListener('e', event => { if (page.run) page.run.addEvent(floatsOf(event.data)); });
  stream.onerror = async () => {
    if (stream.readyState !== EventSource.CLOSED) {  // it asks again by itself
      if (page.isGone) return;
      say('the program has ended, or is gone for a moment', 'bad');
      page.goneTimer = page.goneTimer || setTimeout(showGone, 1000 * kGoneFor);
      return;
    }
    clearTimeout(page.goneTimer);
    const isOld = await fetch('').then(answer => answer.status === 403, () => false);
    say(isOld ? 'this tab is of an earlier start: open the address that the terminal shows now' :
                'the program takes no more pages: close one, and load this one again',
        'bad');
  };
}

// The stream comes back by itself where the program still runs (told.hello).
const kGoneFor = 3;   // s

// Controls that ask the program for something. Time, view, curves and stories work on what has come. The first pane
// has the stories.
const kAsking =
    '#over, #bare, #go, #here, #save, #speed, #pushTime, #toolPush, #toolPull, .pane:not(:first-child) :is(button, input, select)';
const kGoneTitle = 'The program has ended: start it again in the terminal';

// Also those that have been built, or allowed, since.
function lock() {
  for (const control of document.querySelectorAll(kAsking)) {
    if (control.disabled && control.title === kGoneTitle) continue;
    if (control.title !== kGoneTitle) control.dataset.title = control.title;
    control.disabled = true;
    control.title = kGoneTitle;
  }
  byId('on').disabled = !isPast();
}

function unlock() {
  for (const control of document.querySelectorAll('[data-title]')) {
    control.disabled = false;
    control.title = control.dataset.title;
    delete control.dataset.title;
  }
  byId('save').disabled = page.cannotSave;
  if (page.toolBefore) setTool(page.toolBefore);
  page.toolBefore = null;
  showTime();
  showHint();
}

function showGone() {
  if (!page.isGone) page.toolBefore = page.tool;
  page.isGone = true;
  setTool('look');
  lock();
  showTrouble({ title: 'The program has ended', text: 'This page shows what has come until then; nothing more happens in it.', remedy: 'Start it again in the terminal (./tumble live …) and open the address that it prints: each start has a new one.' });
  say('the program has ended', 'bad');
}

tabs.forEach(addTab);
openTab(0);
oneStop(byId('tabs'), 'aria-selected');
oneStop(document.querySelector('[role=radiogroup]'), 'aria-checked');
addOptions();
addControls();
try {
  page.picture = new LivePicture(byId('picture'), byId('scene'), shown, hand);
  page.picture.dark.addEventListener('change', () => { page.needsStage = true; });
} catch (error) {
  noPicture(error);
}
window.tumble = page;   // for the browser's console
listen();
requestAnimationFrame(tick);
