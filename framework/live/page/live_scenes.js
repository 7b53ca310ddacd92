// What a run asks of the modules, and the scenes that can be chosen.

function listed(names) { return names.join(', '); }

// Of one module: functions that the run has asked, with their counts, those that another scene could
// ask, and those that no run can. module: simulate.h, Simulation::asked
function sortAsked(module) {
  const laws = new Set(module.laws), asked = module.functions.filter(([, count]) => count > 0), rest = module.functions.filter(([, count]) => count === 0).map(([name]) => name);
  return { asked, elsewhere: rest.filter(name => laws.has(name)), testsOnly: rest.filter(name => !laws.has(name)) };
}

// What is said besides where a save has changed nothing in the motion.
function adviceOnSame(modules, savedId) {
  const module = (modules || []).find(one => one.id === savedId), asked = module ? sortAsked(module).asked.map(([name]) => name) : [];
  if (asked.length === 0) return `This scene asks nothing of ${savedId} here: look at the tests, or choose a scene that asks for what you changed.`;
  return `This scene asks ${savedId} only for ${listed(asked)}: if you changed another function, look at the tests, or choose a scene that asks for it.`;
}

class AskedBox {
  constructor() {
    this.box = html('div', { className: 'asked', hidden: true });
    this.told = '';
  }

  // modules: simulate.h, Simulation::asked; own: id of the assignment that the page is about
  show(modules, own) {
    const all = modules && own && !modules.some(module => module.id === own) ? [...modules, { id: own, source: '', functions: [], laws: [] }] : modules || [];
    const shown = all.filter(module => module.id === own || module.functions.some(([, count]) => count > 0)), told = JSON.stringify([shown, own]);
    if (told === this.told) return;
    this.told = told;
    this.box.hidden = shown.length === 0;
    this.box.textContent = '';
    const isOwn = module => module.id === own || (!own && module.source !== 'reference');
    for (const module of [...shown.filter(isOwn), ...shown.filter(one => !isOwn(one))]) {
      const { asked, elsewhere, testsOnly } = sortAsked(module), source = isOwn(module) ? '' : ` (${module.source})`;
      const counts = asked.flatMap(([name, count], i) => [i > 0 ? ', ' : '', html('code', {}, name), ` ${count}`]);
      this.box.append(html('p', {}, ...(asked.length > 0 ? [html('b', {}, `This run asks ${module.id}${source} for `), ...counts, ' (calls so far).'] : [html('b', {}, `This run asks nothing of ${module.id}${source}`), ' so far.'])));
      if (!isOwn(module)) continue;
      if (elsewhere.length > 0) this.box.append(html('p', { className: 'soft' }, `Not asked here, though another scene or a push may: ${listed(elsewhere)}.`));
      if (testsOnly.length > 0) this.box.append(html('p', { className: 'soft' }, `Only the tests ask: ${listed(testsOnly)}.`));
    }
  }
}

class ScenesPane {
  // choose(name)
  constructor(choose) {
    this.choose = choose;
    this.box = html('div', { className: 'scenes' });
    this.scenes = [];
    this.asked = new Map();   // by scene: what its runs have asked, by id
  }

  set(message) {
    this.own = message.own;
    this.scenes = message.scenes;
    for (const scene of message.scenes) if (scene.asked) this.asked.set(scene.name, scene.asked);
    this.show();
  }

  // A run tells what it asks; the list says it when it changes.
  learn(name, modules) {
    const known = this.asked.get(name) || {}, before = JSON.stringify(known);
    for (const module of modules) {
      const names = sortAsked(module).asked.map(([one]) => one);
      if (names.length > 0) known[module.id] = [...new Set([...(known[module.id] || []), ...names])];
    }
    if (JSON.stringify(known) === before) return;
    this.asked.set(name, known);
    this.show();
  }

  now(name) { this.current = name; this.show(); }

  entry(scene) {
    const asked = this.asked.get(scene.name), ids = asked ? Object.keys(asked).sort((a, b) => (b === this.own) - (a === this.own)) : [];
    const button = html('button', { onclick: () => this.choose(scene.name) }, scene.title || scene.name, html('small', {}, scene.name + (scene.needs.length > 0 ? ` · runs on ${listed(scene.needs)}` : '')));
    if (asked) button.append(html('small', {}, ids.length > 0 ? ids.map(id => `asks ${id} for ${listed(asked[id])}`).join('; ') : 'has asked nothing yet'));
    button.setAttribute('aria-pressed', String(scene.name === this.current));
    return html('li', {}, button);
  }

  show() { keepFocus(this.box, () => this.build()); }

  build() {
    const at = this.box.parentElement ? this.box.parentElement.scrollTop : 0, canRun = this.scenes.filter(scene => scene.unwritten.length === 0 || scene.name === this.current), waiting = this.scenes.filter(scene => !canRun.includes(scene));
    const own = canRun.filter(scene => this.own && scene.home === this.own), needing = canRun.filter(scene => !own.includes(scene) && this.own && scene.needs.includes(this.own)), others = canRun.filter(scene => !own.includes(scene) && !needing.includes(scene));
    this.box.textContent = '';
    this.box.append(html('p', { className: 'soft' }, 'A scene that is chosen begins at once, with the same code. What was done to this one by hand is kept for when you come back. What a scene asks is said here once it has run.'));
    const group = (title, scenes) => { if (scenes.length > 0) this.box.append(html('h2', { className: 'minor' }, title), html('ul', {}, ...scenes.map(scene => this.entry(scene)))); };
    group(`Scenes of ${this.own}`, own);
    group(`Others that run on ${this.own}`, needing);
    group(own.length + needing.length > 0 ? 'All others that can run' : 'Scenes', others);
    if (waiting.length === 0) return;
    const ids = [...new Set(waiting.flatMap(scene => scene.unwritten))].sort();
    this.box.append(html('p', { className: 'soft' }, `${waiting.length} more ${waiting.length === 1 ? 'scene needs' : 'scenes need'} ${ids.join(' or ')}, which ${ids.length === 1 ? 'is' : 'are'} not written yet.`));
    if (this.box.parentElement) this.box.parentElement.scrollTop = at;
  }
}
