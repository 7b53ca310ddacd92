// Marks of a drawing: impulses, forces, contact points, paths.

const kFlashSeconds = 0.25;      // of real time: long enough to be noticed
const kMostFlashes = 40;         // the latest; more would hide the bodies
const kColors = { impulse: 0xc14d00, force: 0x9a4f86, contact: 0x007a57, path: 0x00446b, spring: 0x1a212b, rod: 0x29313b, joint: 0x8a5a00 };

// A varying number of instances of one geometry.
class Pool {
  constructor(scene, geometry, color, opacity = 1) {
    this.scene = scene;
    this.geometry = sameGeometry(geometry);
    this.material = new THREE.MeshLambertMaterial({ color: new THREE.Color(color).convertGammaToLinear(2.2), transparent: opacity < 1, opacity });
    this.size = 0;
    this.mesh = null;
  }

  begin() { this.used = 0; this.matrices = this.matrices || []; }

  add(matrix) {
    if (!this.matrices[this.used]) this.matrices[this.used] = new THREE.Matrix4();
    this.matrices[this.used++].copy(matrix);
  }

  end() {
    if (this.used > this.size) {
      if (this.mesh) this.scene.remove(this.mesh);
      this.size = Math.max(16, 2 * this.used);
      this.mesh = new THREE.InstancedMesh(this.geometry, this.material, this.size);
      this.mesh.frustumCulled = false;
      this.scene.add(this.mesh);
    }
    if (!this.mesh) return;
    for (let i = 0; i < this.used; ++i) this.mesh.setMatrixAt(i, this.matrices[i]);
    this.mesh.count = this.used;
    this.mesh.visible = this.used > 0;
    this.mesh.instanceMatrix.needsUpdate = true;
  }
}

// An instance with its local z axis from one point to another, `width` the scale across it; null
// where the points coincide.
function laidBetween(from, to, width) {
  const along = to.clone().sub(from), length = along.length();
  if (!(length > 0)) return null;
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), along.divideScalar(length));
  return new THREE.Matrix4().compose(from, turn, new THREE.Vector3(width, width, length));
}

function ballAt(point, radius) { return new THREE.Matrix4().compose(point, new THREE.Quaternion(), new THREE.Vector3(radius, radius, radius)); }

// Marks of one run. @param runs  all that are shown: the strongest of them sets the scale
class Marks {
  constructor(scene, run, about, sight, runs) {
    this.run = run;
    this.about = about;
    this.sight = sight;
    const arrow = arrowGeometry(), ball = ballGeometry(false, 8);
    this.arrows = new Pool(scene, arrow, kColors.impulse);
    this.flashes = new Pool(scene, ball, kColors.impulse, 0.75);
    this.pushes = new Pool(scene, arrow, kColors.force);
    this.dots = new Pool(scene, ball, kColors.contact);
    this.supports = new Pool(scene, arrow, kColors.contact);
    this.strongest = { impulse: 0, contact: 0, force: 0 };
    for (const { events, contacts, head } of runs) {
      for (let i = 0; i < events.count; ++i) if (events.kind[i] === kCollision) this.strongest.impulse = Math.max(this.strongest.impulse, events.impulse[i]);
      const f = contacts.slice(5);
      for (let i = 0; i < head.contacts; ++i) this.strongest.contact = Math.max(this.strongest.contact, Math.hypot(f[0][i], f[1][i], f[2][i]));
    }
    for (const push of about.forces) this.strongest.force = Math.max(this.strongest.force, Math.hypot(...push.force));
    this.path = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: new THREE.Color(kColors.path).convertGammaToLinear(2.2) }));
    this.path.frustumCulled = false;
    this.path.visible = false;
    scene.add(this.path);
  }

  show(t, at, speed, shown, pose) {
    for (const pool of [this.arrows, this.flashes, this.pushes, this.dots, this.supports]) pool.begin();
    if (shown.impulses) this.addImpulses(t, speed);
    if (shown.forces) this.addPushes(t, speed, pose);
    if (shown.contacts) this.addContacts(at);
    for (const pool of [this.arrows, this.flashes, this.pushes, this.dots, this.supports]) pool.end();
  }

  addImpulses(t, speed) {
    const e = this.run.events, life = kFlashSeconds * speed, point = new THREE.Vector3(), normal = new THREE.Vector3();
    for (let i = this.run.eventFrom(t + 1e-5) - 1, drawn = 0; i >= 0 && t - e.time[i] < life && drawn < kMostFlashes; --i) {
      if (e.kind[i] !== kCollision || !(e.impulse[i] > 0)) continue;
      const age = Math.max(0, t - e.time[i]) / life, share = Math.sqrt(e.impulse[i] / this.strongest.impulse);
      point.set(e.point[0][i], e.point[1][i], e.point[2][i]);
      normal.set(e.normal[0][i], e.normal[1][i], e.normal[2][i]);
      this.flashes.add(ballAt(point, this.flashRadius(e.a[i], e.b[i]) * (0.6 + 0.4 * age)));
      for (const [body, sign] of [[e.a[i], 1], [e.b[i], -1]]) {
        const about = this.about.bodies[body];
        if (!about || about.immovable) continue;
        const length = share * Math.min(0.17 * this.sight, 2.6 * (about.radius || 0.06 * this.sight)) * (1 - 0.6 * age);
        const arrow = laidBetween(point, point.clone().addScaledVector(normal, sign * length), length);
        if (arrow) this.arrows.add(arrow);
      }
      ++drawn;
    }
  }

  // Smaller than the colliding bodies.
  flashRadius(a, b) {
    const radii = [a, b].map(i => this.about.bodies[i]).filter(body => body && !body.immovable && body.radius > 0).map(body => 0.3 * body.radius);
    return Math.min(0.009 * this.sight, ...radii);
  }

  // A force is an arrow with its head at the point of application, which moves with the body.
  addPushes(t, speed, pose) {
    const place = new THREE.Vector3(), turn = new THREE.Quaternion();
    for (const push of this.about.forces) {
      if (t < push.start - sameInstant(this.run.times) || t > push.start + push.duration + 0.12 * speed) continue;
      if (!push.local) {   // the point in the body frame, from the pose at the start of the force
        this.run.pose(push.body, this.run.frameAt(push.start), place, turn);
        push.local = new THREE.Vector3(...push.point).sub(place).applyQuaternion(turn.clone().conjugate());
      }
      pose(push.body, place, turn);
      const tip = push.local.clone().applyQuaternion(turn).add(place), force = new THREE.Vector3(...push.force);
      const length = 0.17 * this.sight * Math.sqrt(force.length() / this.strongest.force), tail = tip.clone().addScaledVector(force.normalize(), -length);
      const arrow = laidBetween(tail, tip, length);
      if (arrow) this.pushes.add(arrow);
    }
  }

  addContacts(at) {
    const run = this.run, row = Math.floor(at.k / run.head.contactStride), c = run.contacts, point = new THREE.Vector3(), force = new THREE.Vector3();
    for (let i = run.contactBegins[row]; i < run.contactBegins[row + 1]; ++i) {
      point.set(c[2][i], c[3][i], c[4][i]);
      this.dots.add(ballAt(point, 0.0035 * this.sight));
      force.set(c[5][i], c[6][i], c[7][i]);
      // Of the two opposite forces the one on the moving body; where both move, the one on the
      // upper body.
      const a = this.about.bodies[c[0][i]], b = this.about.bodies[c[1][i]];
      if (a.immovable || (!(b && b.immovable) && force.z < 0)) force.negate();
      const length = 0.1 * this.sight * Math.sqrt(force.length() / (this.strongest.contact || 1));
      const arrow = length > 2e-3 * this.sight && laidBetween(point, force.normalize().multiplyScalar(length).add(point), length);
      if (arrow) this.supports.add(arrow);
    }
  }

  // The path of the chosen body's centre of mass.
  tracePath(body) {
    const c = this.run.moving.get(body);
    this.path.visible = Boolean(c);
    if (!c) return;
    const points = new Float32Array(3 * this.run.times.length);
    for (let i = 0; i < this.run.times.length; ++i) points.set([c[0][i], c[1][i], c[2][i]], 3 * i);
    this.path.geometry.dispose();
    this.path.geometry = new THREE.BufferGeometry();
    this.path.geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
  }
}
