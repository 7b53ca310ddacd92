// What a graded page lets a reader try with the functions of a2: each run calls them. The right-hand
// sides are this page's, but for the tumbling brick, whose derivative is the file's own.

const laws = {
  // f: (t, y) -> y', called back by the module
  step: (to, method, f, t, y, h) => to.number(method, w => w.u32(0).f64(t).vector(y).f64(h), r => sized(method, r.vector(), y.length),
    [bytes => { const r = new Reader(bytes), at = r.f64(); return new Writer().vector(f(at, r.vector())).bytes(); }]),
  derivative: (to, y, body) => sized('rigid_body_derivative', to.number('rigid_body_derivative', w => {
    const inverseMass = inverse(body.mass), diagonal = f => [0, 1, 2].map(i => [0, 1, 2].map(j => i === j ? f(body.moments[i]) : 0));
    w.vector(y.slice(0, 3)).quaternion(y.slice(3, 7)).vector(y.slice(7, 10)).vector(y.slice(10, 13));
    w.f64(body.mass).f64(inverseMass).matrix(diagonal(m => m)).matrix(diagonal(m => 1 / m)).vector([0, 0, 0]).vector([0, 0, 0]);
  }, r => r.vector()), 13),
  renormalize: (to, [w, x, y, z]) => {
    const [a, b, c, d] = to.number('renormalize', out => out.quaternion([w, x, y, z]), r => [r.f64(), r.f64(), r.f64(), r.f64()]);
    return [d, a, b, c];
  },
};
function sized(name, y, n) {
  if (y.length !== n) throw new Ended('wrong', name, `it returned ${y.length} numbers, but ${n} are needed`);
  return y;
}
const methods = ['euler_step', 'rk4_step'];
const method = { id: 'method', label: 'method: 1 Euler, 2 RK4', min: 1, max: 2, step: 1, value: 2, unit: '' };

// A ball on a circle: x' = v, v' = -k x with k of one turn in two seconds. Known in closed form.
const swing = {
  id: 'swing', title: 'A ball on a circle, by steps', about: "Attracted to the middle, with the speed of a circle of 0.4 m. Method 1 is euler_step, method 2 is rk4_step; its error is what the page measures against the closed form.",
  controls: [
    { id: 'h', label: 'step', min: 0.01, max: 0.25, step: 0.01, value: 0.1, unit: 's' },
    method,
    { id: 'turns', label: 'turns', min: 1, max: 5, step: 1, value: 2, unit: '' },
  ],
  error(to, method, h, turns, frames) {
    const omega = Math.PI, radius = 0.4, centre = [0, 0, 0.4], steps = Math.max(1, Math.round(2 * turns / h));
    const f = (t, y) => [y[2], y[3], -omega * omega * y[0], -omega * omega * y[1]];
    let y = [radius, 0, 0, omega * radius];
    const length = 2 * turns / steps;   // so that the last step ends at the end
    for (let i = 0; ; ++i) {
      to.t = i * length;
      if (frames) {
        const exact = ball('closed form', 1, 0.02, add(centre, [radius * Math.cos(omega * to.t), 0, radius * Math.sin(omega * to.t)]), [0, 0, 0]);
        to.frame([ball('ball', 1, 0.04, add(centre, [y[0], 0, y[1]]), [0, 0, 0]), exact]);
      }
      if (i === steps) return { off: Math.hypot(y[0] - radius, y[1]), energy: (y[2] * y[2] + y[3] * y[3] + omega * omega * (y[0] * y[0] + y[1] * y[1])) / (2 * omega * omega * radius * radius) };
      y = laws.step(to, method, f, to.t, y, length);
      if (Math.hypot(y[0], y[1]) > 1e3) throw new Ended('wrong', method, 'the ball is more than 1 km away');
    }
  },
  run(to, { h, method, turns }) {
    const name = methods[method - 1], whole = this.error(to, name, h, turns, true);
    const fine = this.error(to, name, 1 / 64, 1, false), finer = this.error(to, name, 1 / 128, 1, false);
    to.fact('error at the end', whole.off, 'm');
    to.fact('energy at the end / at the start', whole.energy, '');
    // of the ratio of two errors: asymptotic to 0.1 at these steps (2.13 for Euler in place of 2, 15.9 for RK4)
    to.fact('order: log2 of the errors of steps of 1/64 s and 1/128 s', Math.log2(fine.off / finer.off), '', method === 1 ? 1 : 4, 0.2);
  },
};

const tumble = {
  id: 'tumble', title: 'A brick tumbles about its middle axis', about: 'Without forces: rk4_step (or euler_step) over the rigid_body_derivative of the file, renormalize after each step.',
  controls: [
    { id: 'h', label: 'step', min: 0.005, max: 0.1, step: 0.005, value: 0.02, unit: 's' },
    method,
    { id: 'spin', label: 'spin', min: 1, max: 12, step: 0.5, value: 6, unit: 'rad/s' },
    { id: 'aside', label: 'of it, about the long axis', min: 0, max: 1, step: 0.05, value: 0.1, unit: 'rad/s' },
  ],
  run(to, { h, method, spin: w, aside }) {
    const q = product(turn([0, 0, Math.PI / 2]), turn([0.3, 0, 0]));
    const brick = box('brick', 3, [0.12, 0.0575, 0.0355], [0, 0, 0.4], q, [0, 0, 0], turned(q, [aside, w, 0]));
    let y = [...brick.x, ...brick.q, 0, 0, 0, ...spin(brick)];
    const f = (t, state) => laws.derivative(to, state, brick), level = energy(brick), first = y.slice(10);
    const shown = state => ({ ...brick, x: state.slice(0, 3), q: unit(state.slice(3, 7)) });
    const energyOf = state => { const L = turnedBack(unit(state.slice(3, 7)), state.slice(10)); return L.reduce((sum, l, i) => sum + l * l / brick.moments[i], 0) / 2; };
    let worst = 0, longest = 0, steps = Math.round(4 / h);
    for (let i = 0; i <= steps; ++i) {
      to.t = i * h;
      to.frame([shown(y)]);
      if (i === steps) break;
      y = laws.step(to, methods[method - 1], f, to.t, y, h);
      const tidy = laws.renormalize(to, y.slice(3, 7));
      longest = Math.max(longest, Math.abs(Math.hypot(...tidy) - 1));
      y = [...y.slice(0, 3), ...tidy, ...y.slice(7)];
      worst = Math.max(worst, Math.abs(energyOf(y) / level - 1));
    }
    to.fact('angular momentum, change', norm(sub(y.slice(10), first)) / norm(first), 'of it', 0, 1e-12);
    to.fact('length of the orientation after renormalize, away from 1', longest, '', 0, 1e-12);
    to.fact('energy, largest change', worst, 'of it');
  },
};

const experiments = [swing, tumble];
