// What a reader of a handout can change: a panel stands where the handout says <!-- explore: NAME -->, and
// computes from the equations of its section. Without scripts, and on paper, a handout has none of it.
(() => {
'use strict';

const make = (tag, words = '', attributes = {}) => {
  const node = document.createElement(tag);
  node.textContent = words;
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
};
const digits = (x, n = 3) => x === 0 ? '0' : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(n - 1).replace('e', ' e') : String(+x.toPrecision(n));

// ---- A panel: controls, a picture, a sentence ----

class Panel {
  constructor(root, { title, about, label, controls, draw }) {
    Object.assign(this, { root, paint: draw, values: {} });
    root.append(make('p', title, { class: 'explore-title' }), make('p', about));
    const box = make('div', '', { class: 'explore-controls' });
    for (const control of controls) box.append(this.control(control));
    this.canvas = make('canvas', '', { role: 'img', 'aria-label': label });
    this.words = make('p', '', { role: 'status', 'aria-live': 'polite' });
    root.append(box, this.canvas, this.words);
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
    this.draw();
  }
  control({ id, label, min, max, step, value, unit = '', shown = x => `${digits(x)} ${unit}` }) {
    const row = make('label'), input = make('input', '', { type: 'range', min, max, step, value }), out = make('output');
    const take = () => { this.values[id] = +input.value; out.textContent = shown(+input.value); input.setAttribute('aria-valuetext', out.textContent); };
    input.oninput = () => { take(); this.draw(); };
    take();
    row.append(make('span', label), input, out);
    return row;
  }
  draw() {
    if (!this.words) return;
    const { canvas } = this, ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (width === 0) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const g = canvas.getContext('2d'), style = getComputedStyle(this.root), colour = name => style.getPropertyValue(`--${name}`).trim();
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.font = '13px "DejaVu Sans", sans-serif';
    g.lineJoin = 'round';
    this.words.textContent = this.paint({ g, width, height, colour, values: this.values });
  }
}

function line(g, points, colour, width = 2, dash = []) {
  g.strokeStyle = colour;
  g.lineWidth = width;
  g.setLineDash(dash);
  g.beginPath();
  points.forEach(([x, y], i) => i === 0 ? g.moveTo(x, y) : g.lineTo(x, y));
  g.stroke();
  g.setLineDash([]);
}
function disc(g, [x, y], radius, fill, edge) {
  g.beginPath();
  g.arc(x, y, radius, 0, 2 * Math.PI);
  g.fillStyle = fill;
  g.fill();
  if (edge) { g.strokeStyle = edge; g.lineWidth = 1.5; g.stroke(); }
}
function arrow(g, [x, y], [dx, dy], colour) {
  const length = Math.hypot(dx, dy);
  if (length < 2) return;
  const end = [x + dx, y + dy], head = Math.min(9, length / 2), angle = Math.atan2(dy, dx);
  line(g, [[x, y], end], colour, 2.5);
  for (const side of [-0.45, 0.45]) line(g, [end, [end[0] - head * Math.cos(angle + side), end[1] - head * Math.sin(angle + side)]], colour, 2.5);
}
// Words that stay on the picture.
function words(g, text, x, y, colour, align = 'left') {
  g.fillStyle = colour;
  g.textAlign = align;
  g.textBaseline = 'middle';
  const wide = g.measureText(text).width, left = align === 'left' ? x : align === 'right' ? x - wide : x - wide / 2;
  g.fillText(text, x + Math.max(0, 2 - left), y);
}

// Axes with a frame and a scale that is linear or logarithmic; `at` is where a value lies.
class Chart {
  constructor({ g, colour }, { left, top, width, height }, x, y) {
    Object.assign(this, { g, colour, box: { left, top, width, height }, x, y });
    line(g, [[left, top], [left, top + height], [left + width, top + height]], colour('soft'), 1);
    for (const [axis, is_x] of [[x, true], [y, false]]) {
      for (const tick of axis.ticks) {
        const [px, py] = is_x ? this.at(tick, y.range[0]) : this.at(x.range[0], tick);
        line(g, is_x ? [[px, top], [px, top + height]] : [[left, py], [left + width, py]], colour('line'), 1);
        words(g, (axis.words || digits)(tick), is_x ? px : left - 6, is_x ? top + height + 11 : py, colour('soft'), is_x ? 'center' : 'right');
      }
    }
    words(g, x.name, left + width, top + height + 27, colour('soft'), 'right');
    words(g, y.name, left, top - 11, colour('soft'));
  }
  at(x, y) {
    const part = ({ range: [from, to], log }, v) => log ? Math.log(v / from) / Math.log(to / from) : (v - from) / (to - from);
    const { left, top, width, height } = this.box;
    return [left + width * part(this.x, x), top + height * (1 - part(this.y, y))];
  }
  curve(points, colour, width = 2, dash = []) {
    const { g, box } = this;
    g.save();
    g.beginPath();
    g.rect(box.left, box.top, box.width, box.height);
    g.clip();
    line(g, points.map(([x, y]) => this.at(x, y)), colour, width, dash);
    g.restore();
  }
  dots(points, colour, radius = 3) {
    const { g, box } = this;
    for (const [x, y] of points) {
      const p = this.at(x, y);
      if (p[1] >= box.top - 1 && p[1] <= box.top + box.height + 1) disc(g, p, radius, colour);
    }
  }
}
const powers = (from, to, by = 1) => Array.from({ length: Math.floor((to - from) / by) + 1 }, (_, i) => 10 ** (from + by * i));
const asPower = x => `1e${Math.round(Math.log10(x))}`;
const steps = (from, to, n) => Array.from({ length: n + 1 }, (_, i) => from + (to - from) * i / n);

// ---- a1: an impulse on a bar, (A1.9) in the plane ----

const impulse = {
  title: 'Try it: a ball falls on a bar',
  about: 'In the plane (A1.9) is j = (1 + e) |u| / K. The bar is 1 m long, weighs 1 kg and rests in free space; I = l\u00b2 m / 12. The ball comes at 1 m/s.',
  label: 'A ball above a bar, before and after their impact',
  controls: [
    { id: 'e', label: 'restitution e', min: 0, max: 1, step: 0.05, value: 0.5 },
    { id: 'mass', label: 'mass of the ball', min: 0.1, max: 4, step: 0.1, value: 0.5, unit: 'kg' },
    { id: 'arm', label: 'arm r: blow from the middle of the bar', min: -0.5, max: 0.5, step: 0.02, value: 0.3, unit: 'm' },
    { id: 't', label: 'time since the impact', min: -0.4, max: 0.8, step: 0.02, value: 0.4, unit: 's' },
  ],
  draw({ g, width, height, colour, values: { e, mass, arm, t } }) {
    const inertia = 1 / 12, turning = arm * arm / inertia, K = 1 / mass + 1 + turning, j = (1 + e) / K;
    const scale = Math.min(width / 1.5, height / 1.15), middle = [width / 2, height * 0.46], radius = 0.07;
    const place = (x, y) => [middle[0] + scale * x, middle[1] - scale * y];
    const after = Math.max(0, t), ball = [arm, radius + 0.02 + (t < 0 ? -t : after * (j / mass - 1))];
    const angle = -arm * j / inertia * after, down = -j * after, end = side => place(side * Math.cos(angle) / 2, down + side * Math.sin(angle) / 2);
    line(g, [end(-1), end(1)], colour('ink'), scale * 0.04);
    disc(g, place(0, down), 4, colour('wash'), colour('ink'));
    disc(g, place(...ball), scale * radius, colour('link'));
    arrow(g, place(...ball), [0, scale * 0.35 * (t < 0 ? 1 : 1 - j / mass)], colour('bad'));
    if (t >= 0) arrow(g, place(0, down), [0, scale * 0.35 * j], colour('bad'));
    words(g, 'red: velocities of the two centres of mass', width - 8, height - 14, colour('soft'), 'right');
    const lost = (1 - e) * j / 2, had = mass / 2;
    return `K = 1/m(ball) + 1/m(bar) + r\u00b2/I = ${digits(1 / mass)} + 1 + ${digits(turning)} = ${digits(K)} per kg, so j = ${digits(j)} N s` +
      `${arm === 0 ? ', the largest that this ball can give' : ` (in the middle ${digits((1 + e) / (1 / mass + 1))})`}. The points part at e |u| = ${digits(e)} m/s; the bar turns at ${digits(Math.abs(arm * j / inertia))} rad/s. ` +
      `Lost: (1 - e) j |u| / 2 = ${digits(lost)} J, ${digits(100 * lost / had)} % of the ball's energy.`;
  },
};

// ---- a2: the step under a method's error ----

// A ball on a circle of one turn a second. The equation is linear, so a step of any method multiplies the
// complex number x + i y by a polynomial of z = i omega h: the beginning of the series of exp(z).
const kOrders = [['Euler', 1, 'bad'], ['Runge-Kutta', 4, 'link']];
function factor(order, step) {
  const z = 2 * Math.PI * step;
  let [re, im] = [0, 0], size = 1;
  for (let n = 0; n <= order; ++n) {   // i^n is 1, i, -1, -i
    if (n % 2 === 0) re += (n % 4 === 0 ? 1 : -1) * size; else im += (n % 4 === 1 ? 1 : -1) * size;
    size *= z / (n + 1);
  }
  return [re, im];
}
function walked(order, n) {
  const [re, im] = factor(order, 1 / n), path = [[1, 0]];
  for (let i = 0; i < n; ++i) { const [x, y] = path.at(-1); path.push([x * re - y * im, x * im + y * re]); }
  return path;
}
const missed = (order, n) => { const [x, y] = walked(order, n).at(-1); return Math.hypot(x - 1, y); };

const order = {
  title: 'Try it: the step and the error',
  about: 'A ball goes once around a circle of 1 m in one second. Left its path in n steps; right how far from the start it ends.',
  label: 'Left: paths by Euler and Runge-Kutta beside the circle. Right: error against step on logarithmic axes',
  controls: [{ id: 'n', label: 'steps for the turn', min: 4, max: 100, step: 1, value: 12, shown: n => `${n}` }],
  draw(view) {
    const { g, width, height, colour, values: { n } } = view, half = Math.min(width * 0.45, height), centre = [half / 2 + 4, height / 2], scale = half * 0.28;
    const place = ([x, y]) => [centre[0] + scale * x, centre[1] - scale * y];
    g.save();
    g.beginPath();
    g.rect(0, 0, half + 8, height);
    g.clip();
    line(g, steps(0, 2 * Math.PI, 120).map(a => place([Math.cos(a), Math.sin(a)])), colour('soft'), 1.5, [4, 4]);
    for (const [, p, name] of kOrders) {
      const path = walked(p, n).map(place);
      line(g, path, colour(name), 1.5);
      if (n <= 40) for (const point of path) disc(g, point, 2.5, colour(name));
    }
    g.restore();
    const left = half + 62, chart = new Chart(view, { left, top: 26, width: width - left - 20, height: height - 66 },
      { name: 'step h [s]', range: [0.01, 0.25], log: true, ticks: [0.01, 0.03, 0.1] }, { name: 'error [m]', range: [1e-6, 1e2], log: true, ticks: powers(-6, 2, 2), words: asPower });
    const counts = [4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 100];
    for (const [, p, name] of kOrders) {
      chart.curve(counts.map(m => [1 / m, missed(p, m)]), colour(name));
      chart.dots([[1 / n, missed(p, n)]], colour(name), 5);
    }
    words(g, 'Euler', 8, 14, colour('bad'));
    words(g, 'Runge-Kutta', 54, 14, colour('link'));
    const [euler, rk4] = kOrders.map(([, p]) => missed(p, n)), [twiceE, twiceR] = kOrders.map(([, p]) => missed(p, 2 * n));
    return `With ${n} steps of ${digits(1 / n)} s Euler ends ${digits(euler)} m away after ${n} evaluations of f, Runge-Kutta ${digits(rk4)} m after ${4 * n}. Half the step makes Euler's error ${digits(euler / twiceE)} times smaller, Runge-Kutta's ${digits(rk4 / twiceR)} times ` +
      '(2 and 16 where steps are small).';
  },
};

// ---- a3: a damped spring (A3.3), and the return of a drifting rod (A3.6) ----

// x'' = -k/m x - c/m x' from x = 1, x' = 0.
function swung(k, c, mass) {
  const a = c / (2 * mass), d = k / mass - a * a, w = Math.sqrt(Math.abs(d));
  if (w < 1e-6) return t => (1 + a * t) * Math.exp(-a * t);
  if (d > 0) return t => Math.exp(-a * t) * (Math.cos(w * t) + a / w * Math.sin(w * t));
  return t => ((w + a) * Math.exp((w - a) * t) + (w - a) * Math.exp(-(w + a) * t)) / (2 * w);
}
const spring = {
  title: 'Try it: a damped spring',
  about: 'A ball of 1 kg on a spring that is fixed at its other end, pulled 1 m too long and let go: the motion under (A3.3), without gravity.',
  label: 'How much too long the spring is, against time',
  controls: [
    { id: 'k', label: 'stiffness k', min: 5, max: 200, step: 5, value: 40, unit: 'N/m' },
    { id: 'c', label: 'damping c', min: 0, max: 40, step: 0.5, value: 2, unit: 'N s/m' },
  ],
  draw(view) {
    const { g, width, height, colour, values: { k, c } } = view, x = swung(k, c, 1), critical = 2 * Math.sqrt(k);
    const chart = new Chart(view, { left: 40, top: 26, width: width - 52, height: height - 66 }, { name: 't [s]', range: [0, 3], ticks: [0, 1, 2, 3] }, { name: '|d| - L0 [m]', range: [-1, 1], ticks: [-1, -0.5, 0, 0.5, 1] });
    const times = steps(0, 3, 300), still = swung(k, critical, 1);
    chart.curve(times.map(t => [t, still(t)]), colour('soft'), 1.5, [4, 4]);
    chart.curve(times.map(t => [t, x(t)]), colour('link'), 2.5);
    words(g, `dashed: c = 2 \u221a(k m) = ${digits(critical)} N s/m`, width - 14, 40, colour('soft'), 'right');
    const speed = t => (x(t + 1e-5) - x(t - 1e-5)) / 2e-5, held = (k * x(3) ** 2 + speed(3) ** 2) / k;
    const how = c === 0 ? 'Nothing is lost: it swings for ever' : c < critical * (1 - 1e-9) ? `It swings, and has ${digits(100 * held)} % of its energy left after 3 s` : 'It returns without swinging';
    return `${how}. At the start the force is k \u00b7 1 m = ${digits(k)} N; a turn without damping takes 2\u03c0 \u221a(m/k) = ${digits(2 * Math.PI / Math.sqrt(k))} s. With c above ${digits(critical)} N s/m it comes back more slowly, not faster.`;
  },
};

const baumgarte = {
  title: 'Try it: time constant and step',
  about: 'A rod is 1 mm too long. The line is C(t) of (A3.6); the dots are an engine with steps of h that asks for C\u2033 once a step, then changes the velocity, then the place.',
  label: 'The error of a rod against time: closed form and steps',
  controls: [
    { id: 'T', label: 'time constant T', min: 0.005, max: 0.3, step: 0.005, value: 0.1, unit: 's' },
    { id: 'h', label: 'step h', min: 0.002, max: 0.1, step: 0.002, value: 0.016, unit: 's' },
  ],
  draw(view) {
    const { g, width, height, colour, values: { T, h } } = view;
    const chart = new Chart(view, { left: 40, top: 26, width: width - 52, height: height - 66 }, { name: 't [s]', range: [0, 1], ticks: [0, 0.25, 0.5, 0.75, 1] }, { name: 'C [mm]', range: [-1.5, 1.5], ticks: [-1, 0, 1] });
    chart.curve(steps(0, 1, 400).map(t => [t, (1 + t / T) * Math.exp(-t / T)]), colour('link'), 2.5);
    const dots = [[0, 1]];
    for (let C = 1, rate = 0, n = 1; n * h <= 1 && Math.abs(C) < 1e6; ++n) {
      rate += h * (-2 / T * rate - C / (T * T));
      C += h * rate;
      dots.push([n * h, C]);
    }
    chart.curve(dots, colour('bad'), 1);
    chart.dots(dots, colour('bad'));
    const grows = Math.abs(dots.at(-1)[1]) > 1.5 || h / T > 2 * (Math.SQRT2 - 1);
    words(g, grows ? 'unstable' : 'returns', width - 14, 40, grows ? colour('bad') : colour('soft'), 'right');
    return `h / T = ${digits(h / T)}. ${grows ? 'Each step overshoots by more than the one before: T is too short for this step.' : `After T the closed form has 2/e = 74 % of the error left, after 4 T ${digits(500 * Math.exp(-4), 2)} %.`} ` +
      'This engine is stable below h / T = 2 (\u221a2 - 1) = 0.83; Runge-Kutta\u2019s method, with four evaluations a step, below 2.8.';
  },
};

// ---- a4: the walk ----

// The moves of `tumble run late_hit --html`: [ball or null for all three, its new local virtual time, global virtual
// time after it, what happens]. Places follow from them: the balls are equal, and their impacts elastic.
const kHitAB = 0.8 / 1.05, kHitBC = 0.622071825, kHitAC = 1.079844674;
const kMoves = [
  [null, 0.2, 0.2, 'Each ball advances by its own step. No impact is known.'],
  [null, 0.4, 0.4, 'Each advances as if nothing would hit it.'],
  [null, 0.6, 0.6, 'Up to 0.6 s every pair has been searched: this is certain.'],
  [null, 0.8, 0.6, 'All three are at 0.8 s. The checks of the pairs are due, and are safe up to 0.6 s only.'],
  [0, kHitAB, 0.6, 'The check of A and B finds their impact at 0.762 s, in the past of both. A rolls back to it.'],
  [1, kHitAB, 0.6, 'B rolls back, too, and the impulse is applied. C is not affected.'],
  [1, kHitAB + 0.2, 0.6, 'B advances with its new velocity.'],
  [0, kHitAB, 0.6, 'The check of B and C finds that C hit B at 0.622 s, before A did. The impact of A and B has never happened: an anti-message cancels it, and A discards it.'],
  [1, kHitBC, 0.6, 'B rolls back to 0.622 s.'],
  [2, kHitBC, kHitBC, 'C rolls back, too, and the impulse is applied. The check of A and B was safe up to 0.762 s on a motion that is undone: it moves to 0.622 s.'],
  [0, kHitAB + 0.2, kHitBC, 'A goes on: B is no longer where A would have hit it.'],
  [1, kHitBC + 0.2, kHitBC, 'B advances, downwards now.'],
  [2, kHitBC + 0.2, kHitBC, 'C advances with what is left to it.'],
  [1, kHitBC + 0.4, kHitBC, 'B is searched against both others and found free.'],
  [2, kHitBC + 0.4, kHitBC + 0.2, 'The impact of B and C is earlier than global virtual time: it is committed.'],
  [0, kHitAB + 0.4, kHitAB + 0.2, 'A advances.'],
  [1, kHitBC + 0.6, kHitAB + 0.2, 'B advances.'],
  [2, kHitBC + 0.6, kHitAB + 0.2, 'C advances.'],
  [0, kHitAC, kHitAB + 0.2, 'The check of A and C finds their impact at 1.08 s. A rolls back to it.'],
  [2, kHitAC, kHitBC + 0.4, 'C rolls back, too. B, which is ahead of both, is not affected.'],
  [0, kHitAC + 0.2, kHitBC + 0.4, 'A advances, slower now.'],
  [2, kHitAC + 0.2, kHitBC + 0.4, 'C advances.'],
  [1, kHitBC + 0.8, kHitBC + 0.4, 'B advances.'],
  [0, kHitAC + 0.4, kHitBC + 0.4, 'A is searched against both others.'],
  [2, kHitAC + 0.4, 1.274828133, 'Global virtual time passes the second impact: it is committed, too, in the order of time. The impact at 0.762 s was executed, and never committed.'],
];
const kWalk = [{ times: [0, 0, 0], from: [0, 0, 0], certain: 0, held: [], says: 'All three start at 0.' }];
kMoves.forEach(([ball, to, certain, says], i) => {
  const from = kWalk.at(-1).times, times = from.map((t, k) => ball === null || k === ball ? to : t);
  kWalk.push({ times, from, certain, says, held: i < 4 ? [] : i < 8 ? [[kHitAB, 0, 1]] : [[kHitBC, 1, 2], [kHitAC, 0, 2]] });
});

// The number of a move as the figures and the page of a run count: a step of all three is one of each ball.
const moveOf = place => kMoves.slice(0, place).reduce((sum, [ball]) => sum + (ball === null ? 3 : 1), 0);

const radius = 0.1;
const kStart = [{ x: [-1, 0], v: [1.05, 0] }, { x: [0, 0], v: [0, 0] }, { x: [0.05, 1.5], v: [0, -2.1] }];
// Where a ball is at its own time, after those impacts that it holds: [time, two balls].
function placed(ball, time, held) {
  const all = kStart.map(one => ({ x: [...one.x], v: [...one.v], t: 0 }));
  const go = (one, t) => { one.x = one.x.map((x, i) => x + (t - one.t) * one.v[i]); one.t = t; };
  for (const [t, a, b] of held) {
    if (t > time) break;
    for (const one of [all[a], all[b]]) go(one, t);
    const d = [0, 1].map(i => all[a].x[i] - all[b].x[i]), far = Math.hypot(...d), n = d.map(x => x / far);
    const speed = [0, 1].reduce((sum, i) => sum + n[i] * (all[a].v[i] - all[b].v[i]), 0);
    for (const i of [0, 1]) { all[a].v[i] -= speed * n[i]; all[b].v[i] += speed * n[i]; }   // equal masses exchange it
  }
  go(all[ball], time);
  return all[ball].x;
}

const walk = {
  title: 'Try it: the walk, move by move',
  about: 'Left the three balls, each at its own local virtual time. Right their times: dark is certain, light is ahead of that, a cut is a rollback.',
  label: 'Three balls and bars of their local virtual times',
  controls: [{ id: 'move', label: 'after move', min: 0, max: kWalk.length - 1, step: 1, value: 5, shown: i => `${moveOf(i)}` }],
  draw({ g, width, height, colour, values: { move } }) {
    const now = kWalk[move], names = ['A', 'B', 'C'], half = Math.min(width * 0.42, 300), scale = Math.min(half / 2.4, height / 2.3), centre = [half * 0.5, height * 0.62];
    const inks = [colour('bad'), colour('soft'), colour('warn')];
    names.forEach((name, i) => {
      const [x, y] = placed(i, now.times[i], now.held), p = [centre[0] + scale * x, centre[1] - scale * y];
      disc(g, p, scale * radius, inks[i], colour('ink'));
      if (scale * radius > 8) words(g, name, p[0], p[1] + 1, colour('page'), 'center');
    });
    const left = half + 34, most = 1.6, wide = width - left - 58, at = t => left + wide * Math.min(t, most) / most, bar = Math.min(30, height / 7), gap = height / 4.6;
    names.forEach((name, i) => {
      const top = 24 + i * gap;
      words(g, name, left - 14, top + bar / 2, colour('ink'), 'center');
      g.fillStyle = inks[i];
      g.globalAlpha = 0.35;
      g.fillRect(left, top, at(now.times[i]) - left, bar);
      g.globalAlpha = 1;
      g.fillRect(left, top, at(Math.min(now.certain, now.times[i])) - left, bar);
      if (now.from[i] > now.times[i]) {
        g.strokeStyle = colour('ink');
        g.lineWidth = 1;
        g.setLineDash([3, 3]);
        g.strokeRect(at(now.times[i]), top, at(now.from[i]) - at(now.times[i]), bar);
        g.setLineDash([]);
        line(g, [[at(now.times[i]), top - 5], [at(now.times[i]), top + bar + 5]], colour('ink'), 2.5);
      }
      words(g, `${digits(now.times[i])} s`, at(Math.max(now.times[i], now.from[i])) + 6, top + bar / 2, colour('ink'));
    });
    const bottom = 24 + 2 * gap + bar + 12;
    line(g, [[at(now.certain), 12], [at(now.certain), bottom]], colour('link'), 1.5, [5, 3]);
    words(g, `certain to ${digits(now.certain)} s`, Math.min(at(now.certain), width - 70), bottom + 10, colour('link'), 'center');
    return now.says;
  },
};

const panels = { impulse, order, spring, baumgarte, walk };
for (const root of document.querySelectorAll('.explore')) {
  const panel = panels[root.dataset.panel];
  if (panel) new Panel(root, panel);
}
})();
