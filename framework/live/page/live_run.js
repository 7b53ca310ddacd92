// A run that is still going on, with the interface of the player's Run: frames are appended.

const kMostPoses = 700000;   // kept; above it every second of the older frames is let go

function floatsOf(text) {
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);   // of 300 bodies 16000
  return new Float32Array(bytes.buffer);
}

class LiveRun extends Run {
  constructor(head, label) {
    super({ label, contactStride: 1, contacts: 0, frames: 0 }, undefined, head.scene.origin);
    this.about = head.scene;
    this.facts = head;
    this.times = [];
    this.moving = new Map();
    this.resting = new Map();
    this.contactBegins = [0];
    this.contacts = Array.from({ length: 8 }, () => []);
    this.events = { count: 0, time: [], kind: [], a: [], b: [], point: [[], [], []], normal: [[], [], []], impulse: [], before: [], after: [] };
    this.impacts = new Map();
    this.series = [];
    this.curves = { kinetic: [], potential: [], drift: [], px: [], py: [], pz: [], lx: [], ly: [], lz: [], gap: [] };
    this.springs = [];   // by frame
    this.rods = [];
    this.joints = [];
    this.stopped = '';
  }

  get length() { return this.times.length; }

  // numbers: history.h, frame_for_page.
  addFrame(numbers) {
    const [time, kinetic, potential, px, py, pz, lx, ly, lz, gap, bodies, springs, rods, joints, contacts] = numbers;
    if (this.times.length > 0 && time <= this.times[this.times.length - 1] + 1e-9) return;
    let at = 15;
    if (this.times.length === 0) this.sortBodies(numbers, at, bodies);
    for (let i = 0; i < bodies; ++i, at += 13) {
      const c = this.moving.get(i);
      if (c) for (let k = 0; k < 13; ++k) c[k].push(numbers[at + k]);
    }
    const slice = count => { const part = numbers.slice(at, at + count); at += count; return part; };
    this.springs.push(slice(springs));
    this.rods.push(slice(rods));
    this.joints.push(slice(joints));
    for (let i = 0; i < contacts; ++i, at += 11)
      [0, 1, 2, 3, 4, 8, 9, 10].forEach((from, k) => this.contacts[k].push(numbers[at + from]));
    this.contactBegins.push(this.contacts[0].length);
    this.head.contacts = this.contacts[0].length;
    this.times.push(time);
    const c = this.curves, drift = numbers[at];
    for (const [name, value] of Object.entries({ kinetic, potential, drift, px, py, pz, lx, ly, lz, gap })) c[name].push(value);
    if (this.moving.size * this.times.length > kMostPoses) this.thin();
  }

  sortBodies(numbers, at, bodies) {
    for (let i = 0; i < bodies; ++i, at += 13) {
      const still = [7, 8, 9].every(k => numbers[at + k] === 0);
      if (this.about.bodies[i].immovable && still) this.resting.set(i, Array.from(numbers.slice(at, at + 7)));
      else this.moving.set(i, Array.from({ length: 13 }, () => []));
    }
  }

  // numbers: time, kind, a, b, point, normal, impulse, normal velocity before and after.
  addEvent(numbers) {
    const e = this.events;
    ++e.count;
    e.time.push(numbers[0]);
    e.kind.push(numbers[1]);
    e.a.push(numbers[2]);
    e.b.push(numbers[3]);
    for (let i = 0; i < 3; ++i) { e.point[i].push(numbers[4 + i]); e.normal[i].push(numbers[7 + i]); }
    e.impulse.push(numbers[10]);
    e.before.push(numbers[11]);
    e.after.push(numbers[12]);
    if (numbers[1] !== kCollision) return;
    for (const body of [numbers[2], numbers[3]]) {
      if (!this.moving.has(body)) continue;
      if (!this.impacts.has(body)) this.impacts.set(body, []);
      this.impacts.get(body).push(numbers[0]);
    }
  }

  // Keeps frames for which keep(index) holds.
  filterFrames(keep) {
    const kept = [...this.times.keys()].filter(keep), pick = list => kept.map(k => list[k]);
    const contacts = this.contacts.map(() => []), begins = [0];
    for (const k of kept) {
      for (let i = this.contactBegins[k]; i < this.contactBegins[k + 1]; ++i) this.contacts.forEach((list, n) => contacts[n].push(list[i]));
      begins.push(contacts[0].length);
    }
    this.contacts = contacts;
    this.contactBegins = begins;
    this.head.contacts = contacts[0].length;
    for (const c of this.moving.values()) for (let k = 0; k < 13; ++k) c[k] = pick(c[k]);
    for (const name of Object.keys(this.curves)) this.curves[name] = pick(this.curves[name]);
    for (const name of ['springs', 'rods', 'joints', 'times']) this[name] = pick(this[name]);
  }

  thin() {
    const half = this.times.length / 2;
    this.filterFrames(k => k === 0 || k >= half || k % 2 === 0);
  }

  // Forgets what came at this time or later.
  cut(time) {
    const before = time - sameInstant(this.times);   // as the frames were before any is forgotten
    this.filterFrames(k => this.times[k] < before);
    const e = this.events, count = e.time.filter(t => t < before).length;
    for (const list of [e.time, e.kind, e.a, e.b, ...e.point, ...e.normal, e.impulse, e.before, e.after]) list.length = count;
    e.count = count;
    for (const [body, times] of this.impacts) this.impacts.set(body, times.filter(t => t < before));
  }

  velocity(body, k) { const c = this.moving.get(body); return c ? [c[7][k], c[8][k], c[9][k]] : [0, 0, 0]; }
  omega(body, k) { const c = this.moving.get(body); return c ? [c[10][k], c[11][k], c[12][k]] : [0, 0, 0]; }
}

// Eigenvalues and unit eigenvectors of a symmetric 3x3 matrix, by Jacobi's rotations.
function principalOf(matrix) {
  const a = matrix.map(row => row.slice()), v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; ++sweep)
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (Math.abs(a[p][q]) < 1e-15 * (Math.abs(a[p][p]) + Math.abs(a[q][q]))) continue;
      const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]), t = Math.sign(theta || 1) / (Math.abs(theta) + Math.hypot(theta, 1)), c = 1 / Math.hypot(t, 1), s = t * c;
      for (let k = 0; k < 3; ++k) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      for (let k = 0; k < 3; ++k) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
      for (let k = 0; k < 3; ++k) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  return [0, 1, 2].map(i => ({ moment: a[i][i], axis: [v[0][i], v[1][i], v[2][i]] }));
}
