// Vectors, quaternions (w x y z, body to world) and rigid bodies of a page, in SI units.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (k, a) => [k * a[0], k * a[1], k * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = a => Math.sqrt(dot(a, a));

function product(p, q) {
  return [p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
    p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]];
}
function unit(q) {
  const length = Math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return q.map(x => x / length);
}
// The turn by a rotation vector [rad].
function turn(v) {
  const angle = norm(v), half = angle / 2, k = angle < 1e-9 ? 0.5 : Math.sin(half) / angle;
  return [Math.cos(half), k * v[0], k * v[1], k * v[2]];
}
function turned(q, v) {
  const u = [q[1], q[2], q[3]], t = times(2, cross(u, v));
  return add(add(v, times(q[0], t)), cross(u, t));
}
const turnedBack = (q, v) => turned([q[0], -q[1], -q[2], -q[3]], v);

// A box of uniform density. half: half its edges [m].
function box(name, mass, half, x, q = [1, 0, 0, 0], v = [0, 0, 0], w = [0, 0, 0]) {
  const [a, b, c] = half.map(h => h * h);
  return { name, shape: { kind: 'box', half }, mass, moments: [mass * (b + c) / 3, mass * (a + c) / 3, mass * (a + b) / 3], x, q, v, w };
}
function ball(name, mass, radius, x, v) {
  const moment = 0.4 * mass * radius * radius;
  return { name, shape: { kind: 'ball', radius }, mass, moments: [moment, moment, moment], x, q: [1, 0, 0, 0], v, w: [0, 0, 0] };
}
// What nothing moves: the floor.
const wall = { name: 'floor', mass: Infinity, moments: [0, 0, 0], x: [0, 0, 0], q: [1, 0, 0, 0], v: [0, 0, 0], w: [0, 0, 0] };

const spin = body => turned(body.q, turnedBack(body.q, body.w).map((w, i) => w * body.moments[i]));   // L = R I R^T w
const omegaOf = (body, q, L) => turned(q, turnedBack(q, L).map((l, i) => l / body.moments[i]));
const energy = body => (body.mass * dot(body.v, body.v) + dot(body.w, spin(body))) / 2;
const pointVelocity = (body, p) => add(body.v, cross(body.w, sub(p, body.x)));
const inverse = mass => mass === Infinity ? 0 : 1 / mass;

// Free flight for h under gravity g: the angular momentum is kept, the orientation by the midpoint rule.
function flown(body, h, g) {
  const L = spin(body), middle = unit(product(turn(times(h / 2, body.w)), body.q));
  const q = unit(product(turn(times(h, omegaOf(body, middle, L))), body.q));
  return { ...body, x: [body.x[0] + h * body.v[0], body.x[1] + h * body.v[1], body.x[2] + h * body.v[2] - g * h * h / 2],
    v: [body.v[0], body.v[1], body.v[2] - g * h], q, w: omegaOf(body, q, L) };
}

function corners(body) {
  const [a, b, c] = body.shape.half, points = [];
  for (const i of [-1, 1]) for (const j of [-1, 1]) for (const k of [-1, 1]) points.push(add(body.x, turned(body.q, [i * a, j * b, k * c])));
  return points;
}
// The twelve triangles of a box.
function triangles(body) {
  const p = corners(body), faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
  return faces.flatMap(([a, b, c, d]) => [[p[a], p[b], p[c]], [p[a], p[c], p[d]]]);
}

// The first time in [0, h] at which gap(t) is no longer positive; gap(0) > 0 >= gap(h).
function closing(gap, h) {
  let open = 0, shut = h;
  for (let i = 0; i < 40; ++i) {
    const middle = (open + shut) / 2;
    if (gap(middle) > 0) open = middle;
    else shut = middle;
  }
  return shut;
}
