// What a graded page lets a reader try with the functions of a3: each run calls them. Bodies are
// moved by this page, by the classical Runge-Kutta method; forces, rows and multipliers are the file's.

const gravity = 9.81, step = 1 / 240, third = 1 / 3;

// Arguments, in the order of framework/dynamics/body.h and constraint.h.
const diagonal = (body, f) => [0, 1, 2].map(i => [0, 1, 2].map(j => i === j ? f(body.moments[i]) : 0));
function writeBody(to, body) {
  const inverseMass = inverse(body.mass);
  to.f64(body.mass).f64(inverseMass).matrix(diagonal(body, m => m)).matrix(diagonal(body, m => inverseMass === 0 ? 0 : 1 / m));
  return to.vector(body.x).quaternion(body.q).vector(body.v).vector(body.w);
}
const writeRow = (to, row) => to.vector(row.ja).vector(row.jb).f64(row.value).f64(row.rate).f64(row.product);
function writeRows(to, rows) {
  to.u32(rows.length);
  for (const { a, b, row } of rows) writeRow(to.i32(a).i32(b), row);
  return to;
}
// R diag(f(moments)) R^T
function worldMatrix(body, f) {
  const columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(e => turned(body.q, turnedBack(body.q, e).map((x, i) => f(body.moments[i]) * x)));
  return [0, 1, 2].map(i => columns.map(column => column[i]));
}
function writeBodies(to, bodies) {
  to.u32(bodies.length);
  for (const { body, free } of bodies) to.f64(inverse(body.mass)).matrix(worldMatrix(body, m => body.mass === Infinity ? 0 : 1 / m)).vector(free);
  return to;
}
function sized(name, y, n) {
  if (y.length !== n) throw new Ended('wrong', name, `it returned ${y.length} numbers, but ${n} are needed`);
  return y;
}
const laws = {
  position: (to, body, p) => to.number('anchor_position', w => writeBody(w, body).vector(p), r => r.vector()),
  velocity: (to, body, p) => to.number('anchor_velocity', w => writeBody(w, body).vector(p), r => r.vector()),
  spring: (to, { k, c, rest }, a, b) => to.number('spring_force', w => w.f64(k).f64(c).f64(rest).vector(a.p).vector(a.v).vector(b.p).vector(b.v), r => r.vector()),
  row: (to, a, pa, b, pb, length) => {
    const [ja, jb, value, rate, product] = to.number('rod_row', w => writeBody(writeBody(w, a).vector(pa), b).vector(pb).f64(length), r => [r.vector(), r.vector(), r.f64(), r.f64(), r.f64()]);
    return { ja: sized('rod_row', ja, 6), jb: sized('rod_row', jb, 6), value, rate, product };
  },
  baumgarte: (to, value, rate, T) => to.number('baumgarte_acceleration', w => w.f64(value).f64(rate).f64(T), r => r.f64()),
  multipliers: (to, rows, bodies, wanted) => sized('constraint_multipliers', to.number('constraint_multipliers', w => writeBodies(writeRows(w, rows), bodies).vector(wanted), r => r.vector()), rows.length),
  correction: (to, rows, bodies, error) => sized('constraint_correction', to.number('constraint_correction', w => writeBodies(writeRows(w, rows), bodies).vector(error), r => r.vector()), 6 * bodies.length),
  contacts: (to, A, b) => sized('contact_forces', to.number('contact_forces', w => w.matrix(A).vector(b), r => r.vector()), b.length),
  ends: (to, speed, e, rest) => to.ask('ends_in_contact', w => w.f64(speed).f64(e).f64(rest), r => r.u8()) === 1,
};
// What a function that is not written or fails leaves out of a run that can do without it.
function tried(to, name, run) {
  try {
    run();
  } catch (error) {
    if (!(error instanceof Ended) || error.kind === 'out of time') throw error;
    to.fact(`${name}: ${error.message}`, NaN, '', 'an answer');
  }
}

// One step of all bodies under `loads(bodies)`: (force, torque about the centre of mass) of each.
function moved(bodies, h, loads) {
  const rates = all => loads(all).map(({ F, tau }, i) => ({ x: all[i].v, q: product([0, ...all[i].w], all[i].q).map(n => n / 2), p: F, L: tau }));
  const after = (k, s) => bodies.map((body, i) => {
    const q = unit(body.q.map((n, j) => n + s * k[i].q[j])), L = add(spin(body), times(s, k[i].L));
    return { ...body, x: add(body.x, times(s, k[i].x)), q, v: add(body.v, times(s / body.mass, k[i].p)), w: omegaOf(body, q, L) };
  });
  const k1 = rates(bodies), k2 = rates(after(k1, h / 2)), k3 = rates(after(k2, h / 2)), k4 = rates(after(k3, h));
  const mean = k1.map((_, i) => {
    const of = part => k1[i][part].map((n, j) => (n + 2 * k2[i][part][j] + 2 * k3[i][part][j] + k4[i][part][j]) / 6);
    return { x: of('x'), q: of('q'), p: of('p'), L: of('L') };
  });
  const next = after(mean, h);
  if (next.some(body => norm(body.v) > 1e3 || norm(body.w) > 1e4)) throw new Ended('wrong', '', 'a body is faster than 1000 m/s');
  return next;
}
const anchor = (to, body, p) => body === wall ? { p, v: [0, 0, 0] } : { p: laws.position(to, body, p), v: laws.velocity(to, body, p) };
const load = (F, body, p) => ({ F, tau: cross(sub(p, body.x), F) });
const brickHalf = [0.12, 0.0575, 0.0355];

// Where an anchor is and how it moves, against the body's own motion: (after - before) / (2 h) to second order in h.
function tellAnchor(to, body, p) {
  const h = 1e-5, at = s => laws.position(to, flown(body, s, 0), p), v = laws.velocity(to, body, p);
  to.fact('anchor to centre of mass, away from the length of the arm', norm(sub(at(0), body.x)) - norm(p), 'm', 0, 1e-12);
  // h^2 |omega|^3 |arm| / 6 = 3e-9 m/s at 12 rad/s and 0.12 m; round-off 1e-16 / h
  to.fact('velocity of an anchor, away from how its place changes', norm(sub(v, times(1 / (2 * h), sub(at(h), at(-h))))), 'm/s', 0, 1e-7);
}

const hang = {
  id: 'hang', title: 'A brick hangs from a spring', about: 'From a fixed point to a place of the brick. Each step asks anchor_position, anchor_velocity and spring_force.',
  controls: [
    { id: 'k', label: 'stiffness k', min: 20, max: 400, step: 10, value: 120, unit: 'N/m' },
    { id: 'c', label: 'damping c', min: 0, max: 8, step: 0.25, value: 0, unit: 'N s/m' },
    { id: 'rest', label: 'rest length', min: 0, max: 0.3, step: 0.01, value: 0.15, unit: 'm' },
    { id: 'mass', label: 'mass', min: 0.5, max: 4, step: 0.25, value: 1, unit: 'kg' },
    { id: 'place', label: 'place of the anchor, along the brick', min: -0.12, max: 0.12, step: 0.01, value: 0.06, unit: 'm' },
    { id: 'aside', label: 'start aside', min: -0.2, max: 0.2, step: 0.01, value: 0.1, unit: 'm' },
  ],
  run(to, { k, c, rest, mass, place, aside }) {
    const top = [0, 0, 0.85], point = [place, 0, brickHalf[2]], spring = { k, c, rest };
    let [brick] = [box('brick', mass, brickHalf, [aside, 0, 0.5], turn([0, 0, 0.4]))];
    const fixed = { p: top, v: [0, 0, 0] };
    this.tellForce(to, spring);
    tellAnchor(to, { ...brick, w: [3, -2, 11] }, point);
    const stored = body => k * (norm(sub(laws.position(to, body, point), top)) - rest) ** 2 / 2;
    const whole = body => energy(body) + body.mass * gravity * body.x[2] + stored(body);
    const first = whole(brick), scale = mass * gravity * 0.1 + stored(brick);
    let gained = -Infinity, changed = 0;
    for (let i = 0; ; ++i) {
      to.t = i * step;
      if (i % 4 === 0) to.frame([brick], [{ kind: 'spring', from: top, to: laws.position(to, brick, point) }]);
      if (i >= 3 / step) break;
      [brick] = moved([brick], step, ([body]) => {
        const end = anchor(to, body, point), F = laws.spring(to, spring, end, fixed), { tau } = load(F, body, end.p);
        return [{ F: add(F, [0, 0, -mass * gravity]), tau }];
      });
      const more = whole(brick) - first;
      gained = Math.max(gained, more);
      changed = Math.max(changed, Math.abs(more));
    }
    // the page's method: below 1e-4 of it with the widest controls
    if (c === 0) to.fact('energy of motion, weight and spring, largest change', changed, 'J', 0, 1e-3 * scale);
    else to.fact('energy of motion, weight and spring, gained at most', gained, 'J', 'not above 0', 1e-3 * scale);
  },
  // Of a spring alone, along a slanted line.
  tellForce(to, { k, c, rest }) {
    const n = [2 * third, -third, 2 * third], zero = [0, 0, 0], damped = { k, c: Math.max(c, 1), rest };
    const at = (stretch, v = zero, spring = { k, c, rest }) => laws.spring(to, spring, { p: zero, v: zero }, { p: times(rest + stretch, n), v });
    for (const stretch of [0.1, 0.2]) to.fact(`force of a spring that is ${stretch} m longer than at rest, on A towards B`, dot(at(stretch), n), 'N', k * stretch, 1e-9 * k);
    if (rest > 0) to.fact('the same, half as long as at rest', dot(at(-rest / 2), n), 'N', -k * rest / 2, 1e-9 * k);
    to.fact(`of a damper of ${damped.c} N s/m whose ends part at 1 m/s, more than of the spring`, dot(sub(at(0.1, n, damped), at(0.1)), n), 'N', damped.c, 1e-9 * k);
    to.fact('the same where the ends move round each other', norm(sub(at(0.1, [third, 2 * third, 0], damped), at(0.1))), 'N', 0, 1e-9 * k);
  },
};

const pair = {
  id: 'pair', title: 'Two bricks on a spring', about: 'In free space. spring_force is asked for each brick by itself, with the other as its other end.',
  controls: [
    { id: 'k', label: 'stiffness k', min: 10, max: 300, step: 10, value: 60, unit: 'N/m' },
    { id: 'c', label: 'damping c', min: 0, max: 4, step: 0.25, value: 0, unit: 'N s/m' },
    { id: 'mass', label: 'mass of the second', min: 0.5, max: 8, step: 0.5, value: 2, unit: 'kg' },
    { id: 'place', label: 'places of the anchors, along the bricks', min: -0.12, max: 0.12, step: 0.01, value: 0.1, unit: 'm' },
    { id: 'spin', label: 'spin of the first', min: -8, max: 8, step: 0.5, value: 2, unit: 'rad/s' },
    { id: 'apart', label: 'speed apart', min: -0.5, max: 0.5, step: 0.05, value: 0.2, unit: 'm/s' },
  ],
  run(to, { k, c, mass, place, spin: w, apart }) {
    const spring = { k, c, rest: 0.3 }, point = [place, 0, brickHalf[2]];
    let bodies = [box('first', 1, brickHalf, [-0.28, 0, 0.4], turn([0, 0.3, 0]), [-apart / 2, 0, 0], [0, w, w / 4]), box('second', mass, brickHalf, [0.28, 0, 0.4], turn([0, 0, 0.5]), [apart / 2, 0, 0])];
    const ends = all => all.map(body => anchor(to, body, point));
    const whole = all => { const [a, b] = ends(all); return energy(all[0]) + energy(all[1]) + k * (norm(sub(a.p, b.p)) - spring.rest) ** 2 / 2; };
    const momentum = all => all.reduce((sum, body) => add(sum, times(body.mass, body.v)), [0, 0, 0]);
    const about = all => all.reduce((sum, body) => add(sum, add(spin(body), times(body.mass, cross(body.x, body.v)))), [0, 0, 0]);
    const first = { energy: whole(bodies), p: momentum(bodies), L: about(bodies) };
    let changed = 0, gained = -Infinity, opposite = 0, strongest = 0;
    for (let i = 0; ; ++i) {
      to.t = i * step;
      const [a, b] = ends(bodies);
      if (i % 4 === 0) to.frame(bodies, [{ kind: 'spring', from: a.p, to: b.p }]);
      if (i >= 3 / step) break;
      bodies = moved(bodies, step, all => {
        const [a, b] = ends(all), onA = laws.spring(to, spring, a, b), onB = laws.spring(to, spring, b, a);
        opposite = Math.max(opposite, norm(add(onA, onB)));
        strongest = Math.max(strongest, norm(onA));
        return [load(onA, all[0], a.p), load(onB, all[1], b.p)];
      });
      const more = whole(bodies) - first.energy;
      changed = Math.max(changed, Math.abs(more));
      gained = Math.max(gained, more);
    }
    to.fact('forces on the two ends added, largest', opposite, 'N', 0, 1e-12 * Math.max(1, strongest));
    to.fact('momentum of both, change', norm(sub(momentum(bodies), first.p)), 'N s', 0, 1e-9);
    // of the page's method: below 1e-6 with the widest controls
    to.fact('angular momentum of both, change', norm(sub(about(bodies), first.L)), 'kg m^2/s', 0, 1e-4);
    if (c === 0) to.fact('energy of motion and spring, largest change', changed, 'J', 0, 2e-3 * first.energy);
    else to.fact('energy of motion and spring, gained at most', gained, 'J', 'not above 0', 2e-3 * first.energy);
  },
};

const rods = {
  id: 'rods', title: 'A brick and a ball hang from rods', about: 'From the ceiling a rod to one end of a brick, from its other end a rod to a ball. Each step asks rod_row, baumgarte_acceleration and constraint_multipliers; the blow at the start, constraint_correction.',
  controls: [
    { id: 'length', label: 'length of each rod', min: 0.15, max: 0.3, step: 0.01, value: 0.22, unit: 'm' },
    { id: 'mass', label: 'mass of the ball', min: 0.1, max: 2, step: 0.1, value: 0.5, unit: 'kg' },
    { id: 'blow', label: 'speed of the ball by a blow', min: 0, max: 3, step: 0.25, value: 1.5, unit: 'm/s' },
    { id: 'off', label: 'upper rod too long at the start', min: 0, max: 0.05, step: 0.005, value: 0, unit: 'm' },
    { id: 'T', label: 'time constant of stabilisation', min: 0.03, max: 0.5, step: 0.01, value: 0.1, unit: 's' },
  ],
  run(to, { length, mass, blow, off, T }) {
    const top = [-0.1, 0, 0.9], left = [-0.12, 0, 0], right = [0.12, 0, 0];
    let bodies = [box('brick', 1, brickHalf, [0.02, 0, top[2] - length - off]), ball('ball', mass, 0.04, [0.14, 0, top[2] - 2 * length - off], [0.8 * blow, 0.36 * blow, 0.48 * blow])];
    const rowsOf = all => [
      { a: 0, b: 2, row: laws.row(to, all[0], left, wall, top, length) },
      { a: 1, b: 0, row: laws.row(to, all[1], [0, 0, 0], all[0], right, length) }];
    const shown = all => [{ kind: 'rod', from: top, to: laws.position(to, all[0], left) }, { kind: 'rod', from: laws.position(to, all[0], right), to: all[1].x }];
    // J of a row times what every body has: velocities or accelerations
    const along = ({ a, b, row }, six) => [[row.ja, a], [row.jb, b]].reduce((sum, [j, i]) => sum + j.reduce((s, x, n) => s + x * six[i][n], 0), 0);
    const velocities = all => [...all.map(body => [...body.v, ...body.w]), [0, 0, 0, 0, 0, 0]];
    const constrained = (all, frees) => [...all.map((body, i) => ({ body, free: frees[i] })), { body: wall, free: [0, 0, 0, 0, 0, 0] }];
    const alone = all => all.map(body => [0, 0, -gravity, ...freeTurn(body)]);
    const rates = { worst: 0 }, left_ = { worst: 0, least: Infinity };
    const forces = all => {
      const rows = rowsOf(all), frees = alone(all), u = velocities(all);
      for (const one of rows) rates.worst = Math.max(rates.worst, Math.abs(one.row.rate - along(one, u)));
      const wanted = rows.map(({ row }) => laws.baumgarte(to, row.value, row.rate, T)), lambda = laws.multipliers(to, rows, constrained(all, frees), wanted);
      const loads = all.map(body => ({ F: [0, 0, -body.mass * gravity], tau: [0, 0, 0] }));
      rows.forEach(({ a, b, row }, i) => { for (const [j, to_] of [[row.ja, a], [row.jb, b]]) if (to_ < 2) loads[to_] = { F: add(loads[to_].F, times(lambda[i], j.slice(0, 3))), tau: add(loads[to_].tau, times(lambda[i], j.slice(3))) }; });
      const accelerations = [...all.map((body, i) => [...times(1 / body.mass, loads[i].F), ...add(frees[i].slice(3), turned(body.q, turnedBack(body.q, loads[i].tau).map((n, m) => n / body.moments[m])))]), [0, 0, 0, 0, 0, 0]];
      rows.forEach((one, i) => { left_.worst = Math.max(left_.worst, Math.abs(along(one, accelerations) + one.row.product - wanted[i])); });
      left_.pull = Math.max(left_.pull ?? -Infinity, -lambda[0]);
      return { loads, rows };
    };
    bodies = this.struck(to, bodies, rowsOf(bodies), constrained(bodies, alone(bodies)), along, velocities);
    tried(to, 'a ball that hangs still', () => this.still(to, mass, length));
    this.settle(to, T);
    const whole = all => all.reduce((sum, body) => sum + energy(body) + body.mass * gravity * body.x[2], 0), first = whole(bodies);
    const begin = rowsOf(bodies).map(({ row }) => row), watched = 2 * T;
    let worst = 0, changed = 0, tracked = null;
    for (let i = 0; ; ++i) {
      to.t = i * step / 2;   // the brick is light and the rods pull hard: it swings fast
      if (i % 8 === 0) to.frame(bodies, shown(bodies));
      const now = shown(bodies).map(({ from, to: end }) => norm(sub(from, end)) - length);
      worst = Math.max(worst, ...now.map(Math.abs));
      if (tracked === null && to.t >= watched - 1e-9) tracked = { t: to.t, off: now[0] };
      changed = Math.max(changed, Math.abs(whole(bodies) - first));
      if (i >= 4 / step) break;
      bodies = moved(bodies, step / 2, all => forces(all).loads);
    }
    to.fact("C' of a row, away from J_a . u_a + J_b . u_b", rates.worst, 'm/s', 0, 1e-9);
    to.fact("C'' with the multipliers, away from the wanted one", left_.worst, 'm/s^2', 0, 1e-7 * Math.max(1, left_.pull));
    if (off === 0) {
      // the page's method at its step: below 1e-4 m and 1e-3 of the energy with the widest controls
      to.fact('length of a rod, farthest from its own', worst, 'm', 0, 5e-4);
      to.fact('energy of motion and weight, largest change', changed, 'J', 0, 5e-3 * (1 + mass) * gravity * length);
    } else {
      const closed = (begin[0].value + (begin[0].rate + begin[0].value / T) * tracked.t) * Math.exp(-tracked.t / T);
      to.fact(`how much too long the upper rod is after ${shownTime(tracked.t)} s`, tracked.off, 'm', closed, 0.02 * off);
    }
    to.fact('largest pull of the upper rod', left_.pull, 'N');
  },
  // A blow has given the ball a velocity that its rod does not allow.
  struck(to, bodies, rows, constrained, along, velocities) {
    let after = bodies;
    tried(to, 'constraint_correction after the blow', () => {
      const x = laws.correction(to, rows, constrained, rows.map(({ row }) => row.rate));
      after = bodies.map((body, i) => ({ ...body, v: add(body.v, x.slice(6 * i, 6 * i + 3)), w: add(body.w, x.slice(6 * i + 3, 6 * i + 6)) }));
      to.fact('speed along the rods after the blow and constraint_correction', Math.max(...rows.map(one => Math.abs(along(one, velocities(after))))), 'm/s', 0, 1e-9);
      // least in the metric of the kinetic energy: what it takes away is orthogonal to what it leaves
      const taken = bodies.reduce((sum, body, i) => sum + energy(body) - energy(after[i]), 0), own = bodies.reduce((sum, body, i) => sum + energy({ ...body, v: x.slice(6 * i, 6 * i + 3), w: x.slice(6 * i + 3, 6 * i + 6) }), 0);
      to.fact('energy that constraint_correction took away', taken, 'J', own, 1e-9);
    });
    return after;
  },
  // C'' as baumgarte_acceleration wants it, alone: a hundred steps, right to 1e-8 of the start.
  settle(to, T) {
    const h = T / 50, wanted = (C, rate) => laws.baumgarte(to, C, rate, T);
    let [C, rate] = [0.01, 0];
    for (let i = 0; i < 100; ++i) {
      const a = wanted(C, rate), b = wanted(C + h * rate / 2, rate + h * a / 2), c = wanted(C + h * rate / 2 + h * h * a / 4, rate + h * b / 2), d = wanted(C + h * rate + h * h * b / 2, rate + h * c);
      [C, rate] = [C + h * rate + h * h * (a + b + c) / 6, rate + h * (a + 2 * b + 2 * c + d) / 6];
    }
    to.fact('an error of 0.01 m under baumgarte_acceleration, after two time constants', C, 'm', 0.03 * Math.exp(-2), 1e-8);
  },
  still(to, mass, length) {
    const weight = ball('ball', mass, 0.04, [0, 0, 0.5], [0, 0, 0]), row = laws.row(to, weight, [0, 0, 0], wall, [0, 0, 0.5 + length], length);
    const [lambda] = laws.multipliers(to, [{ a: 0, b: 1, row }], [{ body: weight, free: [0, 0, -gravity, 0, 0, 0] }, { body: wall, free: [0, 0, 0, 0, 0, 0] }], [0]);
    to.fact('pull of a rod on a ball that hangs still, over its weight', -lambda / (mass * gravity), '', 1, 1e-9);
  },
};
const shownTime = t => String(+t.toPrecision(3));
// The angular acceleration of a body that nothing turns: the angular momentum stays.
function freeTurn(body) {
  const w = turnedBack(body.q, body.w), L = w.map((x, i) => x * body.moments[i]);
  return turned(body.q, cross(L, w).map((x, i) => x / body.moments[i]));
}

const rest = {
  id: 'rest', title: 'A ball comes to rest', about: 'Between bounces it flies by itself. Each impact asks ends_in_contact; where it says so, contact_forces carries the ball.',
  controls: [
    { id: 'e', label: 'restitution e', min: 0, max: 0.9, step: 0.05, value: 0.6, unit: '' },
    { id: 'height', label: 'height', min: 0.1, max: 0.8, step: 0.05, value: 0.6, unit: 'm' },
    { id: 'slow', label: 'rest speed', min: 0.05, max: 1, step: 0.05, value: 0.2, unit: 'm/s' },
    { id: 'mass', label: 'mass', min: 0.5, max: 4, step: 0.25, value: 1, unit: 'kg' },
  ],
  run(to, { e, height, slow, mass }) {
    const radius = 0.06;
    let z = height + radius, v = 0, resting = false, bounces = 0, slowest = Infinity, ended = null, held = null;
    for (let i = 0; ; ++i) {
      to.t = i * step;
      const force = resting ? [{ kind: 'force', from: [0, 0, 0], to: [0, 0, (held ?? 0) / (mass * gravity) * 0.3] }] : [];
      if (i % 4 === 0) to.frame([ball('ball', mass, radius, [0, 0, z], [0, 0, v])], force);
      if (i >= 3 / step) break;
      for (let left = step; left > 1e-12;) {
        if (resting) {
          [held] = laws.contacts(to, [[1 / mass]], [-gravity]);
          v += left * (held / mass - gravity);
          z += left * v;
          break;
        }
        const down = z - radius, t = (v + Math.sqrt(v * v + 2 * gravity * Math.max(0, down))) / gravity;   // until it touches
        if (t > left) { z += left * v - gravity * left * left / 2; v -= gravity * left; break; }
        z = radius;
        v -= gravity * t;
        left -= t;
        const speed = -v;
        if (laws.ends(to, speed, e, slow)) { resting = true; ended = e * speed; v = 0; }
        else { v = e * speed; slowest = Math.min(slowest, v); ++bounces; }
        if (bounces > 500) throw new Ended('wrong', 'ends_in_contact', 'the ball has bounced 500 times and does not come to rest');
      }
    }
    to.fact('bounces', bounces, '');
    if (bounces > 0) to.fact('slowest bounce, below the rest speed by', slow - slowest, 'm/s', 'not above 0', 1e-12);
    if (ended !== null) to.fact('bounce that was left out, above the rest speed by', ended - slow, 'm/s', 'not above 0', 1e-12);
    if (held !== null) to.fact('force of the floor on the resting ball, over its weight', held / (mass * gravity), '', 1, 1e-9);
    to.fact('lowest point of the ball, below the floor by', Math.max(0, radius - z), 'm', 0, 1e-6);
  },
};

const table = {
  id: 'table', title: 'A table with a weight', about: 'Four legs on the floor without friction: more contacts than a table needs. Each step asks contact_forces. Arrows are its forces. With the weight outside of the legs the table tips.',
  controls: [
    { id: 'mass', label: 'mass of the table', min: 1, max: 20, step: 1, value: 5, unit: 'kg' },
    { id: 'weight', label: 'mass of the weight', min: 0.5, max: 20, step: 0.5, value: 4, unit: 'kg' },
    { id: 'along', label: 'place of the weight, along', min: -0.34, max: 0.34, step: 0.02, value: 0.16, unit: 'm' },
    { id: 'across', label: 'place of the weight, across', min: -0.24, max: 0.24, step: 0.02, value: 0.04, unit: 'm' },
  ],
  // Table and weight are one body; its parts, from its centre of mass, with axes that stay principal enough
  // for a page: the weight is a point, and its share of the products of inertia is left out.
  build({ mass, weight, along, across }) {
    const all = mass + weight, half = [0.34, 0.24, 0.015], high = 0.4, place = [along, across, high + 0.06];
    const com = [weight * along / all, weight * across / all, (mass * high + weight * place[2]) / all];
    const [a, b, c] = half.map(h => h * h), arm = sub(place, com), shift = sub([0, 0, high], com);
    const moment = (i, j, own) => own + mass * (shift[i] ** 2 + shift[j] ** 2) + weight * (arm[i] ** 2 + arm[j] ** 2);
    const legs = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => sub([0.26 * x, 0.18 * y, 0], com));
    return { mass: all, moments: [moment(1, 2, mass * (b + c) / 3), moment(0, 2, mass * (a + c) / 3), moment(0, 1, mass * (a + b) / 3)], x: com, q: [1, 0, 0, 0], v: [0, 0, 0], w: [0, 0, 0], legs, half, shift, arm };
  },
  parts(body) {
    const at = p => add(body.x, turned(body.q, p)), piece = (name, half, p) => ({ ...box(name, 1, half, at(p)), q: body.q });
    return [piece('top', body.half, body.shift), ...body.legs.map((leg, i) => piece(`leg ${i + 1}`, [0.015, 0.015, 0.19], add(leg, [0, 0, 0.19]))), ball('weight', 1, 0.045, at(body.arm), [0, 0, 0])];
  },
  run(to, values) {
    let body = this.build(values);
    const up = [0, 0, 1], seen = { least: Infinity, slowest: Infinity, work: 0, sum: null }, inverted = (b, v) => turned(b.q, turnedBack(b.q, v).map((n, i) => n / b.moments[i]));
    const isInside = Math.abs(body.x[0]) < 0.26 && Math.abs(body.x[1]) < 0.18;
    for (let i = 0; ; ++i) {
      to.t = i * step;
      const feet = body.legs.map(leg => add(body.x, turned(body.q, leg))), touching = feet.filter(p => p[2] < 1e-3), arms = touching.map(p => sub(p, body.x)), turning = freeTurn(body);
      const jacobians = arms.map(r => cross(r, up));
      const A = jacobians.map(one => jacobians.map(other => 1 / body.mass + dot(one, inverted(body, other))));
      const b = arms.map((r, n) => -gravity + dot(jacobians[n], turning) + dot(up, cross(body.w, cross(body.w, r))));
      const f = touching.length > 0 ? laws.contacts(to, A, b) : [];
      const a = f.map((_, n) => b[n] + A[n].reduce((sum, x, m) => sum + x * f[m], 0)), scale = Math.max(...b.map(Math.abs), 1);
      seen.least = Math.min(seen.least, ...f);
      seen.slowest = Math.min(seen.slowest, ...a.map(x => x / scale));
      seen.work = Math.max(seen.work, Math.abs(f.reduce((sum, x, n) => sum + x * a[n], 0)) / (scale * body.mass * gravity));
      const total = f.reduce((sum, x) => sum + x, 0);
      seen.sum ??= total;
      if (i % 4 === 0) to.frame(this.parts(body), body.legs.map((_, n) => { const p = feet[n], m = touching.indexOf(p); return { kind: 'force', from: p, to: add(p, [0, 0, m < 0 ? 0 : 0.35 * f[m] / (body.mass * gravity)]) }; }));
      if (i >= 0.6 / step) break;
      const alpha = add(turning, inverted(body, arms.reduce((sum, r, n) => add(sum, cross(r, times(f[n], up))), [0, 0, 0])));
      const v = add(body.v, [0, 0, step * (total / body.mass - gravity)]), w = add(body.w, times(step, alpha));
      body = { ...body, v, w, x: add(body.x, times(step, v)), q: unit(product(turn(times(step, w)), body.q)) };
      if (body.x[2] < 0.15) break;
    }
    to.fact('least force of a leg', Math.min(0, seen.least) || 0, 'N', 0, 1e-9 * body.mass * gravity);
    to.fact('a foot is accelerated into the floor by, of its weight', Math.min(0, seen.slowest) || 0, '', 0, 1e-9);
    to.fact('f . a, of weight and acceleration', seen.work, '', 0, 1e-8);
    to.fact('all forces at the start, over the weight', seen.sum / (body.mass * gravity), '', isInside ? 1 : null, 1e-9);
  },
};

const experiments = [hang, pair, rods, rest, table];
