// What the program says, and how the page shows it.

// Whether saving a mended file helps: troubles of the user's own code, and those whose line was found in it.
const kTroublesOfCode = new Set(['Does not compile', 'Not attempted', 'Crashed', 'Out of time']);
function isOfCode(trouble) { return kTroublesOfCode.has(trouble.title) || /\.cpp:\d+$/.test(trouble.where || ''); }

function showTrouble(trouble) {
  const box = byId('trouble');
  box.hidden = !trouble;
  if (!trouble) return;
  box.classList.toggle('code', trouble.title === 'Does not compile');   // in which the compiler points by columns
  const [title, text, remedy] = box.querySelectorAll('h2, pre, .remedy');
  title.textContent = trouble.where ? `${trouble.title}: ${trouble.where}` : trouble.title;
  text.textContent = '';
  text.append(...withHandoutLinks(trouble.text));
  const onSave = trouble.title === 'Not attempted' ? 'Write the function and save the file: the scene begins by itself. Or choose another scene.' : isOfCode(trouble) ? 'The page goes on: mend the file and save it.' : '';
  remedy.textContent = (trouble.remedy || onSave) + (trouble.shows_former && page.run ? ' The picture is of the run before.' : '');
  document.body.dataset.trouble = `${trouble.title} ${trouble.where || ''} ${trouble.text || ''}`;
}

// ---- What the program says ----

function begin(message) {
  page.isCompiling = page.isStarting = false;
  const head = message.head, isBack = head.from_s > 0 && page.run;
  page.pushes = message.pushes;
  page.changes = message.changes;
  page.reason = message.reason;
  page.asked = null;
  if (isBack) {
    page.run.cut(head.from_s);
    page.run.facts = head;
  } else {
    if (page.run && page.run.length > 1) page.former = page.run;
    page.run = new LiveRun(head, 'now');
    page.difference = null;
    byId('difference').hidden = true;
    times.clear();
  }
  page.run.about.forces = [...head.scene.forces.filter(force => !page.pushes.some(push => Math.abs(force.start - push.start_s) < 1e-9)), ...page.pushes.map((push, i) => forceOf(push, page.pushes[i + 1]))];
  byId('limit').hidden = true;
  showFormerOnly(false);
  page.begunAt = performance.now();
  page.needsStage = !isBack;
  page.follows = true;
  page.ended = false;
  byId('aimed').textContent = '';
  if (!isBack) page.time = 0;
  showTrouble(null);
  delete document.body.dataset.trouble;
  byId('title').textContent = head.scene.title;
  byId('about').textContent = head.scene.about;
  document.title = `${head.scene.title} – Tumble live`;
  const list = byId('body');
  list.textContent = '';
  list.append(html('option', { value: '-1' }, 'body …'), ...head.scene.bodies.map((body, i) => html('option', { value: String(i) }, body.name)));
  if (page.chosen >= head.scene.bodies.length) page.chosen = -1;
  if (page.chosen < 0) page.chosen = head.scene.bodies.findIndex(body => !body.immovable);
  list.value = String(page.chosen);
  say('running');
  showHint();
  showTime();
  panes.change.show(page.run, page.changes, page.chosen);
  document.body.dataset.runs = String(Number(document.body.dataset.runs || 0) + 1);
  document.body.dataset.reason = message.reason;
  showTimesTab();
}

// An arrow stays for 0.12 s behind its force (marks.js), but in a pull only until the next one.
const kArrowStays = 0.12;

function forceOf(push, next) {
  return { body: page.run.about.bodies.findIndex(body => body.name === push.body), force: push.force_n, point: push.point_m.map((x, i) => x - page.run.origin[i]), start: push.start_s, duration: push.duration_s - (next && isPulledOn(push, next) ? kArrowStays : 0) };
}

// A scene, at the start or chosen; its run comes when it has begun.
function beginScene(message) {
  page.scene = message.name;
  page.canSave = message.can_save;
  page.run = page.former = page.difference = page.asked = null;
  showFormerOnly(false);
  page.pushes = [];
  byId('save').disabled = page.cannotSave = !message.can_save;
  byId('save').title = message.can_save ? 'Save the scene with what was done by hand: it runs again byte for byte' : 'This scene is made by code and has no file to add pushes to';
  byId('title').textContent = message.title || message.name;
  document.body.dataset.scene = message.name;
  panes.scenes.now(message.name);
}

// A saved file that does not compile, or whose run has ended before its first frame: what is drawn is the run before,
// and nothing that is said of it is of the saved file.
function showFormerOnly(is) {
  page.isFormerOnly = is;
  byId('scene').classList.toggle('former', Boolean(is && page.ended));
  showDifference();
}

// The program compares what there is every 0.4 s: that two runs are alike is worth saying of more than their start.
const kAlikeFor = 1;   // s of the run, or of the clock

function isTooEarly(message) { return message.time_s === undefined && !page.ended && message.same_until_s < kAlikeFor && performance.now() - page.begunAt < 1000 * kAlikeFor; }

// "handle is 0.062 m from where it is in the run before", "handle is turned by 0.01 rad from how it is in the run before"
function differenceInWords(what) { return what.replace(/ is (\S+ m) from where it is in the run before$/, ' is then $1 away from its place in the run before').replace(/ is turned by (\S+ rad) from how it is in the run before$/, ' is then turned by $1 from how it is in the run before'); }

// Whether the run differs from the one before; after a save that changed nothing in it, why that may be. A difference is no fault:
// the line has the colour of one only where the same save has broken tests.
function showDifference() {
  const message = page.difference, line = byId('difference'), isEarly = Boolean(message) && isTooEarly(message);
  line.hidden = !message || page.isFormerOnly || isEarly;
  if (isEarly) setTimeout(showDifference, 1000 * kAlikeFor);
  if (line.hidden) return;
  const isDifferent = message.time_s !== undefined, hasStopped = Boolean(page.run && page.run.stopped);
  const goesFarther = !isDifferent && !hasStopped && Boolean(page.former && page.former.stopped && page.run && page.run.end > page.former.end);   // than the run before, which stopped
  const isSave = !isDifferent && !hasStopped && !goesFarther && page.reason === 'code' && page.savedId;
  const change = page.reason === 'code' && page.savedId ? panes.verdicts.changeOf(page.savedId) : null, isWorse = Boolean(change) && change.broken > change.mended;
  line.classList.toggle('worse', isDifferent && isWorse);
  byId('toDifference').hidden = !isDifferent;
  byId('toScenes').hidden = !isSave;
  const tests = change && isDifferent && change.mended + change.broken > 0 ? ` Of the tests this save has mended ${change.mended} and broken ${change.broken}.` : '';
  line.querySelector('span').textContent = isDifferent ? `Another motion than in the run before, from ${short(message.time_s, 6)} s on: ${differenceInWords(message.what)}.${tests}` : goesFarther ? `The run before stopped at ${short(page.former.end, 4)} s. This one is the same until then, and goes on.` : `${hasStopped ? 'This run has stopped; it is the same' : 'The same'} as the run before until ${short(message.same_until_s, 4)} s.${isSave && page.asked ? ` ${adviceOnSame(page.asked, page.savedId)}` : ''}`;
  document.body.dataset.difference = isDifferent ? String(message.time_s) : '';
}

// Of the shown scene, or else of others.
function showUnsaved({ is, others }) {
  const line = byId('unsaved'), names = listed(others), forgets = 'Ctrl-C in the terminal forgets it; closing this page does not.';
  line.classList.toggle('off', !is && others.length === 0);
  line.classList.toggle('elsewhere', !is);
  line.textContent = is ? 'not saved' : others.length > 0 ? `${names}: not saved` : '';
  line.title = is ? `What was done by hand is in no file yet. ${forgets}` : `What was done by hand to ${names} is in no file yet: choose it among the scenes to save it. ${forgets}`;
  document.body.dataset.unsaved = String(is);
}

// Whose it is: of a1, as the run has it.
function rayFunction() {
  const source = /(?:^|,)a1=([^,]+)/.exec(page.run.facts.modules || '');
  return source && source[1] !== 'reference' ? 'your ray function' : `the ray function of ${source ? 'the reference' : 'the framework'}`;
}

const told = {
  hello(message) {
    page.paused = message.paused;
    page.speed = message.speed;
    byId('speed').value = String(message.speed);
    beginScene(message);   // all comes again
    showUnsaved(message.unsaved);
    clearTimeout(page.goneTimer);
    page.goneTimer = 0;
    const wasGone = page.isGone;
    page.isGone = page.isStarting = false;
    if (wasGone) unlock();
    showTrouble(null);
    say('connected');
    if (message.starting) told.starting({ reason: message.starting });
  },
  scene(message) {
    beginScene(message);
    page.paused = false;
    page.chosen = -1;
    page.ended = page.hadStage = page.isLost = false;
    page.time = 0;
    if (page.picture) page.picture.clear();
    byId('about').textContent = byId('aimed').textContent = byId('scales').textContent = showScales.words = '';
    byId('saved').hidden = true;
    byId('body').textContent = '';
    times.clear();
    asked.show(null);
    showTrouble(null);
    delete document.body.dataset.trouble;
    delete document.body.dataset.asked;
    drawMarks();
    showDifference();
    showHint();
    showTime();
  },
  scenes(message) { page.own = message.own; panes.scenes.set(message); },
  unsaved(message) { showUnsaved(message); },
  asked(message) {
    if (message.scene !== page.scene) return;
    page.asked = message.modules;
    asked.show(message.modules, page.own);
    panes.scenes.learn(message.scene, message.modules);
    if (page.difference && page.difference.time_s === undefined) showDifference();
    document.body.dataset.asked = JSON.stringify(Object.fromEntries(message.modules.map(module => [module.id, Object.fromEntries(module.functions.filter(([, count]) => count > 0))])));
  },
  run: begin,
  starting(message) { page.isStarting = true; say({ code: 'compiling …', change: 'starting over …' }[message.reason] || 'starting …', 'busy'); },
  code_saved(message) { page.isCompiling = page.isStarting = true; say(`${message.file} was saved: compiling …`, 'busy'); page.savedId = message.id; panes.verdicts.saved(message.id); showDifference(); document.body.dataset.saved = String(performance.now()); },
  pace(message) { page.paused = message.paused; page.speed = message.speed; byId('speed').value = String(message.speed); showTime(); },
  aimed(message) {
    const run = page.run;
    if (!run) return;
    if (message.problem) byId('aimed').textContent = message.problem;
    else if (message.body < 0) byId('aimed').textContent = `${rayFunction()} hits nothing that can move here`;
    else byId('aimed').textContent = `hit ${run.about.bodies[message.body].name}${message.face !== undefined ? `, face ${message.face}` : ''}, at (${message.point_body_m.map(x => short(x, 3)).join(', ')}) m of its frame${message.face !== undefined ? `, by ${rayFunction()}` : ''}`;
    if (page.picture) page.picture.aimed(message.body, message.point_body_m || [0, 0, 0]);
    document.body.dataset.aimed = String(message.body);
  },
  push(message) {
    const last = page.pushes[page.pushes.length - 1];
    page.pushes.push(message.push);
    if (page.run) {
      const forces = page.run.about.forces;
      if (last && forces.length > 0 && isPulledOn(last, message.push)) forces[forces.length - 1].duration = last.duration_s - kArrowStays;
      forces.push(forceOf(message.push));
    }
    byId('bare').disabled = false;
    if (isOpen('Change')) panes.change.showWhatGoes();
    document.body.dataset.pushes = String(page.pushes.length);
  },
  times(message) { times.add(message); showTimesTab(); },
  end(message) {
    page.run.stopped = message.stopped_by;
    if (message.stopped_by) showTrouble({ title: 'The run stopped', text: message.stopped_by, where: '' });
    else if (message.faults) showTrouble({ title: 'This run cannot be trusted', text: message.faults, where: '' });
    if (!page.isStarting) say(message.stopped_by ? `stopped at ${short(message.time_s)} s` : `ended at ${short(message.time_s)} s`, message.stopped_by ? 'bad' : '');
    page.ended = true;
    showDifference();
    showHint();
    showTime();
  },
  trouble(message) {
    page.isCompiling = page.isStarting = false;
    showTrouble(message);
    if (message.title === 'Does not compile') panes.verdicts.refused();
    if (message.ends_run && page.run) {
      page.ended = true;
      if (page.follows) page.time = page.run.end;   // nothing more comes that the clock could wait for
      page.run.stopped = page.run.stopped || message.title;
      showDifference();
    }
    if (message.shows_former && page.run) showFormerOnly(true);
    showHint();
    say(message.title.toLowerCase(), 'bad');
    showTime();
  },
  notice(message) {
    if (message.about === 'change' && panes.change.refused(message.text)) return;
    byId('aimed').textContent = message.text;
  },
  limit(message) { byId('limit').hidden = false; byId('limit').textContent = message.text; },
  judging(message) { panes.verdicts.busy(message.id); },
  verdicts(message) {
    panes.verdicts.set(message);
    document.body.dataset.verdicts = JSON.stringify(Object.fromEntries(message.tests.map(test => [test.test, test.verdict])));
    document.body.dataset.judged = String(Number(document.body.dataset.judged || 0) + 1);
    showDifference();
  },
  difference(message) {
    page.difference = message;
    showDifference();
  },
  saved(message) {
    const line = byId('saved');
    line.hidden = false;
    line.classList.toggle('wrong', Boolean(message.wrong));
    const checked = !message.checked ? 'it is run again to compare …' : message.wrong ? `but it does not run again alike: ${message.wrong}` : `it runs again, the same to the last bit in ${message.frames} frames`;
    line.querySelector('span').textContent = `Saved ${message.file}; ${checked}. It runs again by: ${message.again}`;
    document.body.dataset.savedScene = message.file;
    document.body.dataset.savedCheck = message.checked ? message.wrong || `same ${message.frames}` : '';
  },
};
