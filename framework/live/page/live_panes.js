// The panes beside the picture: verdicts, what can be changed, the chosen body, what was done.

const kVerdictClass = { right: 'right', wrong: 'wrong', crashed: 'wrong', 'out of time or memory': 'wrong', 'not attempted': 'todo' };

// The line of a story that begins with a word: "likely: ..." or "read: ...".
function lineOf(story, word) {
  const found = new RegExp(`^\\s*${word}:\\s+(.*)$`, 'm').exec(story || '');
  return found ? found[1].trim() : '';
}

class VerdictPane {
  constructor(act) {
    this.act = act;
    this.box = html('div');
    this.by = 'cause';
    this.before = new Map();   // verdicts of the check before, by test
    this.last = null;
    this.show();
  }

  busy(id) { this.isBusy = id; this.show(); }

  set(verdicts) {
    this.isBusy = null;
    if (this.last && this.last.id === verdicts.id && this.last.tests.length > 0) this.before = new Map(this.last.tests.map(test => [test.test, test.verdict]));
    else this.before = new Map();
    this.last = verdicts;
    this.show();
  }

  show() {
    const open = new Set([...this.box.querySelectorAll('details[open]')].map(details => details.dataset.test)), v = this.last;
    this.box.textContent = '';
    if (this.isBusy) this.box.append(html('p', { className: 'soft' }, `The tests of ${this.isBusy} run …`));
    if (!v) {
      if (!this.isBusy) this.box.append(html('p', { className: 'soft' }, 'No test has run. They run when you save your file.'));
      return;
    }
    if (v.said) { this.box.append(html('h2', { className: 'bad' }, `${v.file || v.id}: no test ran`), html('pre', {}, v.said)); return; }
    const right = v.tests.filter(test => test.verdict === 'right'), points = tests => tests.reduce((sum, test) => sum + test.points, 0);
    const count = html('p', { className: 'count' }, `${v.title}: ${right.length} of ${v.tests.length} tests are right, ${short(points(right))} of ${short(points(v.tests))} points of the public tests.`);
    const mended = v.tests.filter(test => this.before.has(test.test) && test.verdict === 'right' && this.before.get(test.test) !== 'right').length;
    const broken = v.tests.filter(test => this.before.get(test.test) === 'right' && test.verdict !== 'right').length;
    this.box.append(count);
    if (mended + broken > 0) this.box.append(html('p', {}, html('span', { className: 'good' }, `${mended} mended`), ', ', html('span', { className: broken ? 'bad' : '' }, `${broken} broken`), ' by this save.'));
    const choice = html('select', { ariaLabel: 'Grouping of the stories' }, html('option', { value: 'cause' }, 'by likely cause'), html('option', { value: 'group' }, 'by subject of the test'));
    choice.value = this.by;
    choice.addEventListener('change', () => { this.by = choice.value; this.show(); });
    const open_ = v.tests.filter(test => test.verdict !== 'right');
    if (open_.length > 0) this.box.append(html('label', {}, 'Stories ', choice));
    for (const [name, tests] of this.groups(open_)) {
      this.box.append(html('h3', {}, `${name} (${tests.length} test${tests.length === 1 ? '' : 's'}, ${short(points(tests))} points)`));
      for (const test of tests) this.box.append(this.story(test, v, open));
    }
    if (right.length > 0) {
      const list = html('details', { className: 'story right' }, html('summary', {}, `${right.length} right`), html('ul', { className: 'list' }, ...right.map(test => html('li', {}, test.title, this.tag(test) || ''))));
      list.dataset.test = 'right';
      list.open = open.has('right');
      this.box.append(list);
    }
  }

  // What costs most comes first; what is not attempted comes last.
  groups(tests) {
    const groups = new Map();
    for (const test of tests) {
      const isTodo = test.verdict === 'not attempted', likely = lineOf(test.story, 'likely');
      const where = test.function ? `${test.function}${test.line ? ` (line ${test.line})` : ''}` : test.group;
      const cause = isTodo ? `not attempted: ${test.function || test.group}` : likely || `${test.verdict} in ${where}`;
      const name = this.by === 'cause' ? cause : test.group;
      if (!groups.has(name)) groups.set(name, []);
      groups.get(name).push(test);
    }
    const weight = ([, list]) => list.reduce((sum, test) => sum + test.points, 0) + (list.every(test => test.verdict === 'not attempted') ? -1e6 : 0);
    return [...groups].sort((a, b) => weight(b) - weight(a));
  }

  tag(test) {
    if (!this.before.has(test.test)) return null;
    const was = this.before.get(test.test);
    if (was === test.verdict) return null;
    return test.verdict === 'right' ? html('span', { className: 'tag mended' }, 'mended') : html('span', { className: 'tag new' }, `was ${was}`);
  }

  story(test, v, open) {
    const where = test.line ? `${v.file}:${test.line} ${test.function}` : test.function || '', read = lineOf(test.story, 'read');
    const details = html('details', { className: `story ${kVerdictClass[test.verdict] || ''}` }, html('summary', {}, `${test.verdict}: ${test.title}`));
    const tag = this.tag(test);
    if (tag) details.querySelector('summary').append(tag);
    details.dataset.test = test.test;
    details.open = open.has(test.test);
    if (where) details.append(html('p', { className: 'soft' }, where));
    details.append(html('pre', {}, (test.story || '').replace(/^\n/, '')));
    if (test.printed) details.append(html('p', { className: 'soft' }, 'your code printed:'), html('pre', {}, test.printed));
    const link = this.handoutLink(read, v);
    if (link) details.append(html('p', {}, link));
    return details;
  }

  // "handouts/a1_impulse.md, eq. (A1.9)" becomes a link to that passage.
  handoutLink(read, v) {
    const file = /handouts\/(\w+)/.exec(read), page = file ? file[1] : v.handout.replace('handouts/', ''), equation = /\(A\d+\.\d+[a-z]?\)|A\d+\.\d+/.exec(read), anchor = /#([\w-]+)/.exec(read);
    const hash = anchor ? `#${anchor[1]}` : equation ? `#:~:text=${encodeURIComponent(equation[0].startsWith('(') ? equation[0] : `(${equation[0]})`)}` : '';
    return html('a', { href: `handouts/${page}.html${hash}`, target: '_blank', rel: 'noopener' }, `Read in the handout${equation ? `: equation ${equation[0]}` : ''}`);
  }
}

// What holds for the whole run; each change begins it anew.
class ChangePane {
  // act(changes)
  constructor(act) {
    this.act = act;
    this.keep = html('input', { type: 'checkbox' });
    this.box = html('div');
  }

  number(value, attributes, send) {
    const input = html('input', { type: 'number', step: 'any', value: String(value), ...attributes });
    input.addEventListener('change', () => { if (input.value !== '' && Number.isFinite(Number(input.value))) send(Number(input.value)); });
    return input;
  }

  choice(value, options, send) {
    const select = html('select', {}, ...options.map(([word, text]) => html('option', { value: word }, text)));
    select.value = value;
    select.addEventListener('change', () => send(select.value));
    return select;
  }

  show(run, changes, chosen) {
    const facts = run.facts, bodies = run.about.bodies, movable = bodies.map((_, i) => i).filter(i => !bodies[i].immovable), form = html('div', { className: 'form' });
    const row = (text, ...inputs) => form.append(html('label', {}, text), html('span', { className: 'three' }, ...inputs));
    const gravity = facts.gravity_m_s2 || [0, 0, 0];
    const g = gravity.map((value, i) => this.number(value, { ariaLabel: `gravity, ${'xyz'[i]}` }, () => this.act({ gravity_m_s2: g.map(input => Number(input.value)) })));
    row('gravity [m/s²]', ...g, html('button', { onclick: () => this.act({ gravity_m_s2: [0, 0, 0] }) }, 'none'), html('button', { onclick: () => this.act({ gravity_m_s2: [0, 0, -9.81] }) }, 'Earth'));
    const common = name => { const all = new Set(facts.bodies.map(body => body[name])); return all.size === 1 ? [...all][0] : ''; };
    row('restitution of all', this.number(changes.restitution !== undefined ? changes.restitution : common('restitution'), { min: 0, max: 1, placeholder: 'mixed', ariaLabel: 'restitution' }, value => this.act({ restitution: value })));
    row('friction of all', this.number(changes.friction !== undefined ? changes.friction : common('friction'), { min: 0, placeholder: 'mixed', ariaLabel: 'friction' }, value => this.act({ friction: value })));
    const body = movable.includes(chosen) ? chosen : movable[0];
    if (body !== undefined) row(`mass of ${bodies[body].name} [kg]`, this.number(facts.bodies[body].mass_kg, { min: 0, ariaLabel: 'mass' }, value => this.act({ mass_kg: { [bodies[body].name]: value } })));
    row('step [s]', this.number(facts.step_s, { min: 0, ariaLabel: 'step' }, value => this.act({ step_s: value })), html('button', { onclick: () => this.act({ step_s: facts.step_s / 2 }) }, '÷ 2'), html('button', { onclick: () => this.act({ step_s: facts.step_s * 2 }) }, '× 2'));
    row('method', this.choice(changes.method || '', [['', 'the laws\' own'], ...['euler', 'symplectic', 'midpoint', 'verlet', 'rk4'].map(word => [word, word])], value => this.act({ method: value || null })));
    row('engine', this.choice(facts.engine, [['rd', 'rd: step by step'], ['ca', 'ca: conservative advancement'], ['tw', 'tw: timewarp'], ['ordered', 'ordered: event by event']], value => this.act({ engine: value })));
    form.append(html('label', { className: 'wide' }, this.keep, ' keep the pushes when it starts over'), html('button', { className: 'wide', onclick: () => this.act({ all: null }) }, 'The scene as it is in its file'));
    this.box.textContent = '';
    this.box.append(html('p', { className: 'soft' }, 'Each change begins the run anew; the run before stays beside it as a ghost.'), form,
      html('p', { className: 'soft' }, `laws: ${facts.modules || facts.motion}; engine ${facts.engine}, step ${short(facts.step_s)} s`));
  }
}

// Numbers of the chosen body, a push by numbers, and the pushes so far.
class BodyPane {
  // push(body, point, force, seconds)
  constructor(push) {
    this.box = html('div');
    this.table = html('table', { className: 'body' });
    this.point = [0, 1, 2].map(i => html('input', { type: 'number', step: 'any', value: '0', ariaLabel: `point, ${'xyz'[i]}` }));
    this.force = [0, 1, 2].map(i => html('input', { type: 'number', step: 'any', value: i === 0 ? '1' : '0', ariaLabel: `force, ${'xyz'[i]}` }));
    this.seconds = html('input', { type: 'number', step: 'any', min: 0.001, value: '0.1', ariaLabel: 'seconds' });
    this.button = html('button', { onclick: () => push(this.body, this.point.map(input => Number(input.value)), this.force.map(input => Number(input.value)), Number(this.seconds.value)) }, 'Push');
    this.list = html('ol', { className: 'list' });
    this.name = html('h2');
    this.box.append(this.name, this.table, html('h3', {}, 'Push by numbers'),
      html('div', { className: 'form' }, html('label', {}, 'point, body frame [m]'), html('span', { className: 'three' }, ...this.point), html('label', {}, 'force, world [N]'), html('span', { className: 'three' }, ...this.force),
        html('label', {}, 'for [s]'), html('span', { className: 'three' }, this.seconds, this.button)),
      html('h3', {}, 'Done by hand'), this.list);
    this.count = -1;
  }

  show(run, body, t, pushes) {
    this.body = body;
    const about = run.about.bodies[body], row = (name, values, unit) => html('tr', {}, html('th', {}, name), ...values.map(v => html('td', {}, typeof v === 'string' ? v : short(v, 5))), html('td', { className: 'soft' }, unit));
    this.name.textContent = about ? about.name : 'Choose a body: click it, or take it from the list below the picture';
    this.button.disabled = !about || about.immovable;
    this.table.textContent = '';
    const c = about && run.moving.get(body);
    if (c) {
      const k = run.frameAt(t).k, facts = run.facts.bodies[body];
      this.table.append(row('place', run.placeInWords([0, 1, 2].map(i => c[i][k]), 5), 'm'), row('velocity', run.velocity(body, k), 'm/s'), row('ω', run.omega(body, k), 'rad/s'));
      if (facts.mass_kg) this.table.append(row('mass', [facts.mass_kg], 'kg'), row('principal moments', principalOf(facts.inertia_kg_m2).map(p => p.moment), 'kg m²'));
    }
    if (pushes.length === this.count) return;
    this.count = pushes.length;
    const words = push => `${short(push.start_s, 5)} s, ${push.body}: (${push.force_n.map(x => short(x, 3)).join(', ')}) N for ${short(push.duration_s, 3)} s`;
    this.list.textContent = '';
    this.list.append(...pushes.slice(-60).map(push => html('li', { value: 1 + pushes.indexOf(push) }, words(push))));
    if (pushes.length === 0) this.list.append(html('li', {}, 'nothing yet'));
  }
}
