// What a graded page lets a reader try with the functions of a1: each run calls them, and nothing of
// a1 is computed here. Vectors and bodies: framework/report/bench/solid.js.

const gravity = 9.81, step = 1 / 240, brickHalf = [0.12, 0.0575, 0.0355];   // a brick of a wall [m]

// Arguments, in the order of framework/dynamics/body.h.
function writeBody(to, body) {
  const inverseMass = inverse(body.mass), diagonal = f => [0, 1, 2].map(i => [0, 1, 2].map(j => i === j ? f(body.moments[i]) : 0));
  to.f64(body.mass).f64(inverseMass).matrix(diagonal(m => m)).matrix(diagonal(m => inverseMass === 0 ? 0 : 1 / m));
  return to.vector(body.x).quaternion(body.q).vector(body.v).vector(body.w);
}
const writeContact = (to, contact) => to.vector(contact.p).vector(contact.n);

const laws = {
  relativeNormalVelocity: (to, c, a, b) => to.number('relative_normal_velocity', w => writeBody(writeBody(writeContact(w, c), a), b), r => r.f64()),
  impulse: (to, c, a, b, e) => to.number('collision_impulse', w => writeBody(writeBody(writeContact(w, c), a), b).f64(e), r => r.f64()),
  apply: (to, body, J, p) => {
    const [v, w] = to.number('apply_impulse', out => writeBody(out, body).vector(J).vector(p), r => [r.vector(), r.vector()]);
    return { ...body, v, w };
  },
  resolve: (to, c, a, b, e) => to.number('resolve_collision', w => writeBody(writeBody(writeContact(w, c), a), b).f64(e), r => [r.vector(), r.vector(), r.vector(), r.vector()]),
  wrench: (to, F, p, x) => to.number('wrench_of_point_force', w => w.vector(F).vector(p).vector(x), r => [r.vector(), r.vector()]),
  linear: (to, body, F) => to.number('linear_acceleration', w => writeBody(w, body).vector(F), r => r.vector()),
  angular: (to, body, tau) => to.number('angular_acceleration', w => writeBody(w, body).vector(tau), r => r.vector()),
  hit: (to, ray, [a, b, c]) => to.ask('intersect_ray_triangle', w => w.vector(ray.o).vector(ray.d).vector(a).vector(b).vector(c), r => r.u8() === 1 ? [r.f64(), r.vector()] : []),
};

// A push by hand: from the pixel a ray, from the ray a point of the brick, from the point a wrench.
class Pushes {
  constructor(pushes) { this.waiting = pushes.map(push => ({ ...push, seconds: 0.1 })); this.acting = []; }

  begin(to, body) {
    this.waiting = this.waiting.filter(push => {
      if (push.t > to.t + 1e-9) return true;
      let nearest = Infinity;
      for (const triangle of triangles(body)) {
        const hit = laws.hit(to, push.ray, triangle);
        if (hit.length > 0 && hit[0] >= 0 && hit[0] < nearest) nearest = hit[0];
      }
      if (nearest < Infinity) this.acting.push({ F: push.F, left: push.seconds, point: turnedBack(body.q, sub(add(push.ray.o, times(nearest, push.ray.d)), body.x)) });
      return false;
    });
  }

  // The velocities after h under all forces that act now.
  moved(to, body, h) {
    this.begin(to, body);
    for (const push of this.acting) {
      const [F, tau] = laws.wrench(to, push.F, add(body.x, turned(body.q, push.point)), body.x);
      const a = laws.linear(to, body, F), alpha = laws.angular(to, body, tau), still = laws.angular(to, body, [0, 0, 0]);
      // free flight turns the brick already: only what the torque adds
      body = { ...body, v: add(body.v, times(h, a)), w: add(body.w, times(h, sub(alpha, still))) };
      push.left -= h;
    }
    this.acting = this.acting.filter(push => push.left > 1e-9);
    return body;
  }
}

const up = [0, 0, 1];
const lowest = body => Math.min(...corners(body).map(p => p[2]));
const rate = (body, p) => pointVelocity(body, p)[2];   // of the gap to the floor [m/s]

// The impulses at every corner that touches the floor and comes nearer.
function bounced(to, brick, e, seen) {
  for (let round = 0; round < 8; ++round) {
    let any = false;
    for (const p of corners(brick)) {
      if (p[2] > 1e-6) continue;
      const contact = { p, n: up }, before = laws.relativeNormalVelocity(to, contact, brick, wall);
      if (before > -1e-9) continue;
      const speed = rate(brick, p), slow = speed > -0.05;   // rests
      const j = laws.impulse(to, contact, brick, wall, slow ? 0 : e);
      const after = laws.apply(to, brick, times(j, up), p);
      any = any || j !== 0;
      if (!slow) seen.push({ ratio: -rate(after, p) / speed, gain: energy(after) - energy(brick), level: energy(brick), about: norm(sub(aboutPoint(after, p), aboutPoint(brick, p))), L: norm(aboutPoint(brick, p)) });
      brick = after;
    }
    if (!any) break;
  }
  return brick;
}
const aboutPoint = (body, p) => add(spin(body), times(body.mass, cross(sub(body.x, p), body.v)));

const drop = {
  id: 'drop', takesPushes: true, title: 'A brick falls on the floor', about: 'Without friction. Each corner that meets the floor asks relative_normal_velocity, collision_impulse and apply_impulse. Drag from the brick to push it.',
  controls: [
    { id: 'e', label: 'restitution e', min: 0, max: 1, step: 0.05, value: 0.5, unit: '' },
    { id: 'mass', label: 'mass', min: 0.5, max: 10, step: 0.5, value: 3, unit: 'kg' },
    { id: 'height', label: 'height', min: 0.3, max: 1.5, step: 0.1, value: 0.8, unit: 'm' },
    { id: 'tilt', label: 'tilt', min: 0, max: 90, step: 1, value: 35, unit: 'degrees' },
    { id: 'spin', label: 'spin about its long axis', min: -10, max: 10, step: 0.5, value: 2, unit: 'rad/s' },
  ],
  run(to, { e, mass, height, tilt, spin: w }, pushes) {
    const q = product(turn([0, tilt * Math.PI / 180, 0]), turn([0.6, 0, 0]));
    let brick = box('brick', mass, brickHalf, [0, 0, height], q, [0, 0, 0], turned(q, [w, 0, 0]));
    const hands = new Pushes(pushes), seen = [];
    for (let i = 0; i < 2 / step; ++i) {
      to.t = i * step;
      if (i % 4 === 0) to.frame([brick]);
      brick = hands.moved(to, brick, step);
      let left = step;
      for (let impacts = 0; impacts < 8 && left > 1e-9; ++impacts) {
        const start = brick, end = flown(start, left, gravity);
        if (lowest(end) > 0) { brick = end; left = 0; break; }
        const t = lowest(start) > 1e-7 ? closing(s => lowest(flown(start, s, gravity)), left) : 0;
        brick = bounced(to, flown(start, t, gravity), e, seen);
        left -= t;
        if (t === 0 && impacts > 2) break;
      }
      if (left > 1e-9) brick = flown(brick, left, gravity);
      const deepest = lowest(brick);   // a corner that the law lets rest or leave is set on the floor again
      if (deepest < 0 && corners(brick).every(p => p[2] > 1e-3 || rate(brick, p) > -0.2)) brick = { ...brick, x: add(brick.x, [0, 0, -deepest]) };
      if (brick.x[2] < -0.6) { to.frame([brick]); throw new Ended('wrong', 'collision_impulse', 'the brick has fallen through the floor'); }
      if (norm(brick.v) > 1e3) throw new Ended('wrong', 'apply_impulse', 'the brick is faster than 1000 m/s');
    }
    to.frame([brick]);
    this.tell(to, e, seen);
  },
  tell(to, e, seen) {
    if (seen.length === 0) return;
    to.fact('speed apart after / together before, first impact', seen[0].ratio, '', e, 1e-9);
    const worst = seen.reduce((a, b) => Math.abs(b.ratio - e) > Math.abs(a.ratio - e) ? b : a);
    to.fact(`the same, the worst of ${seen.length} impacts`, worst.ratio, '', e, 1e-9);
    to.fact('energy gained by an impact, at most', Math.max(...seen.map(s => s.gain)), 'J', 'not above 0', 1e-9 * Math.max(...seen.map(s => s.level)));
    to.fact('angular momentum about the corner, largest change', Math.max(...seen.map(s => s.about)), 'kg m^2/s', 0, 1e-9 * Math.max(...seen.map(s => s.L)) + 1e-12);
  },
};

// The point of a box that is nearest to p, outside of it.
function nearestOfBox(body, p) {
  const q = turnedBack(body.q, sub(p, body.x));
  return add(body.x, turned(body.q, q.map((x, i) => Math.max(-body.shape.half[i], Math.min(body.shape.half[i], x)))));
}
const gapOf = (a, b) => norm(sub(a.x, nearestOfBox(b, a.x))) - a.shape.radius;

const strike = {
  id: 'strike', takesPushes: true, title: 'A ball strikes a brick', about: 'In free space. The two touch once: collision_impulse and apply_impulse, and resolve_collision beside them. Drag from the brick to push it.',
  controls: [
    { id: 'e', label: 'restitution e', min: 0, max: 1, step: 0.05, value: 0.8, unit: '' },
    { id: 'ball', label: 'mass of the ball', min: 0.1, max: 10, step: 0.1, value: 1, unit: 'kg' },
    { id: 'mass', label: 'mass of the brick', min: 0.5, max: 10, step: 0.5, value: 3, unit: 'kg' },
    { id: 'aside', label: 'place of the blow, aside', min: -0.12, max: 0.12, step: 0.01, value: 0.08, unit: 'm' },
    { id: 'above', label: 'place of the blow, above', min: -0.06, max: 0.06, step: 0.005, value: 0.02, unit: 'm' },
    { id: 'tilt', label: 'tilt of the brick', min: 0, max: 90, step: 1, value: 30, unit: 'degrees' },
  ],
  run(to, { e, ball: ballMass, mass, aside, above, tilt }, pushes) {
    const q = product(turn([0, tilt * Math.PI / 180, 0]), turn([0.5, 0, Math.PI / 2]));
    let brick = box('brick', mass, brickHalf, [0, 0, 0.4], q);
    let striker = ball('ball', ballMass, 0.05, [-0.7, aside, 0.4 + above], [2, 0, 0]);
    const hands = new Pushes(pushes), sum = (f, ...all) => all.reduce((a, b) => add(a, f(b)), [0, 0, 0]);
    const momentum = body => times(body.mass, body.v), about = body => aboutPoint(body, [0, 0, 0]);
    let touches = 0;
    for (let i = 0; i < 1.5 / step; ++i) {
      to.t = i * step;
      if (i % 4 === 0) to.frame([brick, striker]);
      brick = hands.moved(to, brick, step);
      const gap = s => gapOf(flown(striker, s, 0), flown(brick, s, 0));
      let left = step;
      if (touches < 20 && gap(step) <= 0) {
        const t = gap(0) > 0 ? closing(gap, step) : 0;
        [brick, striker, left] = [flown(brick, t, 0), flown(striker, t, 0), step - t];
        const p = nearestOfBox(brick, striker.x), n = times(1 / norm(sub(striker.x, p)), sub(striker.x, p)), contact = { p, n };
        const together = dot(n, sub(pointVelocity(striker, p), pointVelocity(brick, p)));
        if (together < 0) {
          const j = laws.impulse(to, contact, striker, brick, e);
          const a = laws.apply(to, striker, times(j, n), p), b = laws.apply(to, brick, times(-j, n), p);
          if (touches++ === 0) {
            const level = energy(brick) + energy(striker), apart = dot(n, sub(pointVelocity(a, p), pointVelocity(b, p)));
            to.fact('speed apart after / together before', -apart / together, '', e, 1e-9);
            to.fact('momentum of both, change', norm(sub(sum(momentum, a, b), sum(momentum, brick, striker))), 'N s', 0, 1e-9 * mass);
            to.fact('angular momentum of both, change', norm(sub(sum(about, a, b), sum(about, brick, striker))), 'kg m^2/s', 0, 1e-9 * mass);
            to.fact('energy of both, change', energy(a) + energy(b) - level, 'J', e === 1 ? 0 : 'not above 0', 1e-9 * level);
            this.whole(to, contact, striker, brick, e, a, b);
          }
          [striker, brick] = [a, b];
        }
      }
      [brick, striker] = [flown(brick, left, 0), flown(striker, left, 0)];
    }
    to.frame([brick, striker]);
  },
  // resolve_collision has to say the same; where it is not written the run goes on by its parts.
  whole(to, contact, a, b, e, partsA, partsB) {
    try {
      const [va, wa, vb, wb] = laws.resolve(to, contact, a, b, e);
      const off = Math.max(norm(sub(va, partsA.v)), norm(sub(wa, partsA.w)), norm(sub(vb, partsB.v)), norm(sub(wb, partsB.w)));
      to.fact('resolve_collision against collision_impulse and apply_impulse', off, 'm/s, rad/s', 0, 1e-9);
    } catch (error) {
      if (!(error instanceof Ended) || error.kind === 'out of time') throw error;
      to.fact(`resolve_collision: ${error.message}`, NaN, '', 'an answer');
    }
  },
};

const push = {
  id: 'push', takesPushes: true, title: 'A force pushes a brick', about: 'In free space, for 0.2 s, at a place of the brick. Each step asks wrench_of_point_force, linear_acceleration and angular_acceleration. Drag from the brick to push it once more.',
  controls: [
    { id: 'force', label: 'force, to the right', min: 0, max: 20, step: 1, value: 8, unit: 'N' },
    { id: 'mass', label: 'mass', min: 0.5, max: 10, step: 0.5, value: 3, unit: 'kg' },
    { id: 'along', label: 'place of the force, along the brick', min: -0.12, max: 0.12, step: 0.01, value: 0.1, unit: 'm' },
    { id: 'across', label: 'place of the force, across', min: -0.0575, max: 0.0575, step: 0.0025, value: 0.03, unit: 'm' },
    { id: 'spin', label: 'spin before, about its middle axis', min: 0, max: 15, step: 0.5, value: 4, unit: 'rad/s' },
  ],
  run(to, { force, mass, along, across, spin: w }, pushes) {
    const q = product(turn([0, 0, Math.PI / 2]), turn([0.3, 0, 0]));
    let brick = box('brick', mass, brickHalf, [0, 0, 0.4], q, [0, 0, 0], turned(q, [0, w, 0.05 * w]));
    const place = [along, across, brickHalf[2]], hands = new Pushes(pushes), zero = [0, 0, 0];
    let after = null, worstEnergy = 0, worstSpin = 0;
    for (let i = 0; i < 2 / step; ++i) {
      to.t = i * step;
      if (i % 4 === 0) to.frame([brick]);
      const F = i * step < 0.2 - 1e-9 ? [force, 0, 0] : zero;
      // the derivative of the velocities, asked at the start and in the middle of the step
      const asked = body => {
        const [f, tau] = laws.wrench(to, F, add(body.x, turned(body.q, place)), body.x);
        return [laws.linear(to, body, f), laws.angular(to, body, tau)];
      };
      const [a, alpha] = asked(brick);
      const middle = { ...brick, x: add(brick.x, times(step / 2, brick.v)), q: unit(product(turn(times(step / 2, brick.w)), brick.q)), v: add(brick.v, times(step / 2, a)), w: add(brick.w, times(step / 2, alpha)) };
      const [b, beta] = asked(middle);
      brick = { ...brick, x: add(brick.x, times(step, middle.v)), q: unit(product(turn(times(step, middle.w)), brick.q)), v: add(brick.v, times(step, b)), w: add(brick.w, times(step, beta)) };
      brick = hands.moved(to, brick, step);
      if (norm(brick.w) > 1e4) throw new Ended('wrong', 'angular_acceleration', 'the brick turns faster than 10,000 rad/s');
      if (F === zero && pushes.length === 0) {
        after = after || { energy: energy(brick), spin: spin(brick) };
        worstEnergy = Math.max(worstEnergy, Math.abs(energy(brick) / after.energy - 1));
        worstSpin = Math.max(worstSpin, norm(sub(spin(brick), after.spin)) / norm(after.spin));
      }
    }
    to.frame([brick]);
    if (pushes.length > 0) return;
    to.fact('velocity after the push', brick.v[0], 'm/s', force * 0.2 / mass, 1e-9);
    // the midpoint rule of this page: measured below 2e-3 with the widest controls
    to.fact('energy after the push, largest relative change', worstEnergy || 0, '', 0, 5e-3);
    to.fact('angular momentum after the push, largest relative change', worstSpin || 0, '', 0, 5e-3);
  },
};

const experiments = [drop, strike, push];
