// The panes beside the picture: what can be changed, the chosen body, what was done.

// What holds for the whole run; each change begins it anew.
class ChangePane {
  // act(changes); pushes(): how many there are
  constructor(act, pushes) {
    this.act = changes => { this.asked = this.changed; this.changed = null; act(changes); };
    this.pushes = pushes;
    this.keep = html('input', { type: 'checkbox', checked: true });
    this.keep.addEventListener('change', () => this.showWhatGoes());
    this.whatGoes = html('p', { className: 'soft' });
    this.box = html('div');
  }

  // What a change does, with what goes by it.
  showWhatGoes() {
    const count = this.pushes(), pushes = count === 1 ? 'the push' : `the ${count} pushes`;
    const kept = count === 0 ? '' : this.keep.checked ? `, with ${pushes} so far` : `; ${pushes} so far ${count === 1 ? 'is' : 'are'} forgotten`;
    this.whatGoes.textContent = `Each change begins the run anew${kept}. The run before stays beside it as a ghost.`;
    this.whatGoes.classList.toggle('bad', count > 0 && !this.keep.checked);
  }

  // range: [least, most, in words]; another number is refused at its field.
  number(value, ariaLabel, [least, most, range], send) {
    const input = html('input', { type: 'number', step: 'any', value: String(value), ariaLabel, ...(value === '' ? { placeholder: 'mixed' } : {}) });
    input.addEventListener('input', () => this.accept(input));
    input.addEventListener('change', () => {
      const x = Number(input.value);
      this.changed = input;
      if (input.value === '' || !(x >= least && x <= most)) this.refuse(input, `${ariaLabel}: ${range}`);
      else send(x);
    });
    return input;
  }

  refuse(input, words) {
    this.accept(input);
    input.classList.add('refused');
    input.setAttribute('aria-invalid', 'true');
    input.parentElement.append(html('span', { className: 'refusal', role: 'alert' }, words));
  }

  accept(input) {
    input.classList.remove('refused');
    input.removeAttribute('aria-invalid');
    for (const words of input.parentElement.querySelectorAll('.refusal')) words.remove();
  }

  // What the program refuses stands at the field that was changed last. @return whether there is one
  refused(words) {
    if (!this.asked || !this.asked.isConnected) return false;
    this.refuse(this.asked, words);
    return true;
  }

  choice(value, name, options, send) {
    const select = html('select', { ariaLabel: name }, ...options.map(([word, text]) => html('option', { value: word }, text)));
    select.value = value;
    select.addEventListener('change', () => send(select.value));
    return select;
  }

  show(run, changes, chosen) { keepFocus(this.box, () => this.build(run, changes, chosen)); }

  build(run, changes, chosen) {
    const facts = run.facts, bodies = run.about.bodies, movable = bodies.map((_, i) => i).filter(i => !bodies[i].immovable), form = html('div', { className: 'form' });
    const row = (text, ...inputs) => form.append(html('label', {}, text), html('span', { className: 'three' }, ...inputs));
    const gravity = facts.gravity_m_s2 || [0, 0, 0];
    const g = gravity.map((value, i) => this.number(value, `gravity, ${'xyz'[i]}`, [-1e4, 1e4, 'at most 10000 m/s²'], () => this.act({ gravity_m_s2: g.map(input => Number(input.value)) })));
    row('gravity [m/s²]', ...g, html('button', { onclick: () => this.act({ gravity_m_s2: [0, 0, 0] }) }, 'none'), html('button', { onclick: () => this.act({ gravity_m_s2: [0, 0, -9.81] }) }, 'Earth'));
    const common = name => { const all = new Set(facts.bodies.map(body => body[name])); return all.size === 1 ? [...all][0] : ''; };
    row('restitution of all', this.number(changes.restitution !== undefined ? changes.restitution : common('restitution'), 'restitution', [0, 1, 'from 0 to 1'], value => this.act({ restitution: value })));
    row('friction of all', this.number(changes.friction !== undefined ? changes.friction : common('friction'), 'friction', [0, 100, 'from 0 to 100'], value => this.act({ friction: value })));
    const body = movable.includes(chosen) ? chosen : movable[0];
    if (body !== undefined) row(`mass of ${bodies[body].name} [kg]`, this.number(facts.bodies[body].mass_kg, 'mass', [1e-9, 1e12, 'above 0, from 1e-9 kg to 1e12 kg'], value => this.act({ mass_kg: { [bodies[body].name]: value } })));
    row('step [s]', this.number(Number(facts.step_s.toPrecision(6)), 'step', [1e-5, 1, 'from 0.00001 s to 1 s'], value => this.act({ step_s: value })), html('button', { onclick: () => this.act({ step_s: facts.step_s / 2 }) }, '÷ 2'), html('button', { onclick: () => this.act({ step_s: facts.step_s * 2 }) }, '× 2'));
    row('method', this.choice(changes.method || '', 'method', [['', 'that of the code'], ...['euler', 'symplectic', 'midpoint', 'verlet', 'rk4'].map(word => [word, word])], value => this.act({ method: value || null })));
    row('engine', this.choice(facts.engine, 'engine', [['rd', 'rd: step by step'], ['ca', 'ca: from impact to impact'], ['tw', 'tw: a clock for each body (timewarp)'], ['ordered', 'ordered: all events by their time']], value => this.act({ engine: value })));
    if (run.about.rods.length + run.about.joints.length > 0)
      row('coordinates', this.choice(changes.coordinates || '', 'coordinates', [['', 'those of the scene'], ['maximal', 'maximal: six a body, rows hold rods and joints'], ['reduced', 'reduced: what rods and joints leave free']], value => this.act({ coordinates: value || null })));
    form.append(html('label', { className: 'wide' }, this.keep, ' keep the pushes'), html('button', { className: 'wide', onclick: () => this.act({ all: null }) }, 'The scene as it is in its file'));
    this.box.textContent = '';
    this.showWhatGoes();
    this.box.append(this.whatGoes, form,
      html('p', { className: 'soft anywhere' }, `code: ${facts.modules || facts.motion}; engine ${facts.engine}, step ${short(facts.step_s)} s`));
  }
}

const kMostLines = 60;

// A pull is many short forces, each of which begins where the one before ends: one line.
function isPulledOn(before, push) { return before !== undefined && push.body === before.body && before.duration_s < 0.05 && push.duration_s < 0.05 && Math.abs(before.start_s + before.duration_s - push.start_s) < 1e-6; }

function foldPushes(pushes) {
  const lines = [];
  pushes.forEach((push, i) => {
    const size = Math.hypot(...push.force_n);
    if (!isPulledOn(pushes[i - 1], push)) lines.push({ push, count: 0, most_n: 0 });
    const line = lines[lines.length - 1];
    ++line.count;
    line.end_s = push.start_s + push.duration_s;
    line.most_n = Math.max(line.most_n, size);
  });
  return lines;
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
    if (pushes.length === this.count && pushes === this.listed) return;
    this.count = pushes.length;
    this.listed = pushes;
    const words = push => `${short(push.start_s, 5)} s, ${push.body}: (${push.force_n.map(x => short(x, 3)).join(', ')}) N for ${short(push.duration_s, 3)} s`;
    this.list.textContent = '';
    const lines = foldPushes(pushes), left = Math.max(0, lines.length - kMostLines);
    if (left > 0) this.list.append(html('li', { className: 'soft bare' }, `the latest ${kMostLines}; ${left} earlier ones are left out here, and are in the run`));
    this.list.append(...lines.slice(left).map((line, i) => html('li', { value: left + i + 1 }, line.count === 1 ? words(line.push) : `${short(line.push.start_s, 5)} s to ${short(line.end_s, 5)} s, ${line.push.body}: a pull of up to ${short(line.most_n, 3)} N (${line.count} forces)`)));
    if (pushes.length === 0) this.list.append(html('li', { className: 'soft bare' }, 'nothing yet'));
  }
}
