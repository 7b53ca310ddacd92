// The picture of a run that goes on: the stage of the player's page, a ghost of the run before,
// vectors to scale, and what a pointer does to bodies.

const kVectors = {
  v: { text: 'velocity v', color: 0x00798c, unit: 'm/s' },
  omega: { text: 'angular velocity ω', color: 0x8a5a00, unit: 'rad/s' },
  L: { text: 'angular momentum L', color: 0x5f7a00, unit: 'kg m²/s' },
  impulse: { text: 'impulses of impacts', color: 0xc14d00, unit: 'N s' },
  contact: { text: 'contact forces', color: 0x007a57, unit: 'N' },
  constraint: { text: 'forces of springs and rods', color: 0x4a5bbf, unit: 'N' },
};
const kFormerColor = 0x6f8dad, kHandColor = 0xd0306c;
const cssColor = color => '#' + color.toString(16).padStart(6, '0');

// The 1, 2 or 5 times a power of ten that is not above x.
function roundDown(x) {
  const power = Math.pow(10, Math.floor(Math.log10(x))), part = x / power;
  return (part >= 5 ? 5 : part >= 2 ? 2 : 1) * power;
}

// Small balls, each as one point of the graphics with the shading of a ball: where the processor draws, the corners of
// some hundred balls cost more than their pixels. The depth is that of the centre: a disc that faces the eye cuts no
// plane that the ball does not cut. Light as in Stage.addLight().
class Discs {
  // groups: [{mesh, members, color, isQuartered}], whose instances it draws in their place
  constructor(stage, groups, opacity = 1) {
    this.groups = groups;
    this.key = stage.key;
    const count = groups.reduce((sum, group) => sum + group.members.length, 0), tints = [];
    for (const group of groups) for (let k = 0; k < group.members.length; ++k) tints.push(...group.color, group.isQuartered ? 1 : 0);
    const geometry = new THREE.BufferGeometry(), add = (name, array, size) => { geometry.setAttribute(name, new THREE.BufferAttribute(array, size)); return geometry.attributes[name]; };
    this.position = add('position', new Float32Array(3 * count), 3);
    this.along = [add('alongX', new Float32Array(3 * count), 3), add('alongY', new Float32Array(3 * count), 3)];   // axes of the body, as long as its radius
    add('tint', new Float32Array(tints), 4);
    this.uniforms = { height: { value: 1 }, key: { value: new THREE.Vector3() }, up: { value: new THREE.Vector3() }, opacity: { value: opacity } };
    const material = new THREE.ShaderMaterial({
      uniforms: this.uniforms, transparent: opacity < 1, depthWrite: opacity === 1,
      vertexShader: `attribute vec3 alongX, alongY; attribute vec4 tint; uniform float height; varying vec3 vX, vY; varying vec4 vTint;
        void main() {
          vec4 place = modelViewMatrix * vec4(position, 1.0);
          vX = mat3(viewMatrix) * alongX; vY = mat3(viewMatrix) * alongY; vTint = tint;
          gl_Position = projectionMatrix * place;
          gl_PointSize = height * projectionMatrix[1][1] * length(alongX) / -place.z;
        }`,
      fragmentShader: `uniform vec3 key, up; uniform float opacity; varying vec3 vX, vY; varying vec4 vTint;
        void main() {
          vec2 at = vec2(2.0, -2.0) * gl_PointCoord + vec2(-1.0, 1.0);
          float reach = dot(at, at);
          if (reach > 1.0) discard;
          vec3 normal = vec3(at, sqrt(1.0 - reach));
          float shade = vTint.a > 0.0 && dot(normal, vX) * dot(normal, vY) > 0.0 ? 0.45 : 1.0;
          vec3 light = 0.75 * max(dot(normal, key), 0.0) + 0.55 * mix(vec3(0.722, 0.690, 0.659), vec3(1.0), 0.5 + 0.5 * dot(normal, up));
          gl_FragColor = linearToOutputTexel(vec4(vTint.rgb * shade * light, opacity));
        }` });
    this.points = new THREE.Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = opacity < 1 ? 1 : 0;
    stage.scene.add(this.points);
  }

  // @param height  of the canvas, in pixels
  show(camera, height, isShown) {
    this.points.visible = isShown;
    for (const group of this.groups) group.mesh.visible = !isShown;
    if (!isShown) return;
    let at = 0;
    for (const { mesh, members } of this.groups)
      for (let k = 0; k < members.length; ++k, at += 3) {
        const m = mesh.instanceMatrix.array, from = 16 * k;
        for (let i = 0; i < 3; ++i) {
          this.position.array[at + i] = m[from + 12 + i];
          this.along[0].array[at + i] = m[from + i];
          this.along[1].array[at + i] = m[from + 4 + i];
        }
      }
    for (const attribute of [this.position, ...this.along]) attribute.needsUpdate = true;
    camera.updateMatrixWorld();
    this.uniforms.height.value = height;
    this.uniforms.key.value.copy(this.key.position).sub(this.key.target.position).transformDirection(camera.matrixWorldInverse);
    this.uniforms.up.value.set(0, 0, 1).transformDirection(camera.matrixWorldInverse);
  }
}
const kMostOfDisc = 40;   // pixels: of larger balls the outline is no circle, and few are in sight

class Ghost {
  constructor(stage, run) {
    this.run = run;
    this.meshes = stage.groups.filter(group => group.members.some(i => run.moving.has(i))).map(group => {
      const material = new THREE.MeshLambertMaterial({ color: new THREE.Color(kFormerColor).convertGammaToLinear(2.2), transparent: true, opacity: 0.3, depthWrite: false });
      const mesh = new THREE.InstancedMesh(sameGeometry(group.geometry(12)), material, group.members.length);
      mesh.frustumCulled = false;
      mesh.renderOrder = 1;
      stage.scene.add(mesh);
      return { mesh, members: group.members, group };
    });
    this.scales = stage.scales;
    this.shift = new THREE.Vector3(...run.origin).sub(new THREE.Vector3(...stage.run.origin));   // the scene before may have another origin
    this.place = new THREE.Vector3();
    this.turn = new THREE.Quaternion();
  }

  show(t, isShown) {
    const at = this.run.frameAt(Math.min(t, this.run.end)), matrix = new THREE.Matrix4();
    for (const { mesh, members } of this.meshes) {
      mesh.visible = isShown;
      if (!isShown) continue;
      members.forEach((i, slot) => {
        const seen = this.run.moving.has(i) && this.run.pose(i, at, this.place, this.turn);
        mesh.setMatrixAt(slot, seen ? matrix.compose(this.place.add(this.shift), this.turn, this.scales[i]) : matrix.makeScale(0, 0, 0));
      });
      mesh.instanceMatrix.needsUpdate = true;
    }
  }
}

// Arrows with lengths in proportion to what they stand for.
class Vectors {
  constructor(stage, run) {
    this.stage = stage;
    this.run = run;
    const arrow = arrowGeometry();
    this.pools = Object.fromEntries(Object.entries(kVectors).map(([name, about]) => [name, new Pool(stage.scene, arrow, about.color)]));
    this.axes = [0xb03030, 0x2f7d32, 0x3050b0].map(color => new Pool(stage.scene, rodGeometry(8), color));
    this.centres = new Pool(stage.scene, ballGeometry(false, 12), 0x101418);
    for (const pool of [this.centres, ...this.axes]) { pool.material.depthTest = false; pool.material.transparent = true; }
    this.largest = Object.fromEntries(Object.keys(kVectors).map(name => [name, 0]));
    this.principal = run.facts.bodies.map(body => (body.inertia_kg_m2 ? principalOf(body.inertia_kg_m2) : null));
    this.place = new THREE.Vector3();
    this.turn = new THREE.Quaternion();
  }

  // Metres of picture for one unit: the largest arrow so far is 0.16 of the sight, rounded down.
  scaleOf(name) { return this.largest[name] > 0 ? roundDown(0.16 * this.stage.sight / this.largest[name]) : 0; }

  momentumOf(body, k) {
    const rows = this.run.facts.bodies[body].inertia_kg_m2, omega = new THREE.Vector3(...this.run.omega(body, k)).applyQuaternion(this.turn.clone().conjugate());
    return new THREE.Vector3(...rows.map(row => row[0] * omega.x + row[1] * omega.y + row[2] * omega.z)).applyQuaternion(this.turn);
  }

  add(name, from, vector) {
    const size = vector.length();
    if (!Number.isFinite(size)) return;
    this.largest[name] = Math.max(this.largest[name], size);
    const length = size * this.scaleOf(name);
    if (!(length > 1e-3 * this.stage.sight)) return;
    const arrow = laidBetween(from, from.clone().addScaledVector(vector, length / size), length);
    if (arrow) this.pools[name].add(arrow);
  }

  show(t, shown, chosen) {
    const run = this.run, at = run.frameAt(t), all = [...Object.values(this.pools), ...this.axes, this.centres];
    for (const pool of all) pool.begin();
    const bodies = shown.chosenOnly && chosen >= 0 ? [chosen] : [...run.moving.keys()];
    if (shown.v || shown.omega || shown.L || shown.axes || shown.centres)
      for (const body of bodies) {
        if (!run.moving.has(body) || !run.pose(body, at, this.place, this.turn)) continue;
        const place = this.place.clone(), about = this.stage.about.bodies[body];
        if (shown.v) this.add('v', place, new THREE.Vector3(...run.velocity(body, at.k)));
        if (about.immovable) continue;
        if (shown.omega) this.add('omega', place, new THREE.Vector3(...run.omega(body, at.k)));
        if (shown.L) this.add('L', place, this.momentumOf(body, at.k));
        if (shown.centres) this.centres.add(ballAt(place, 0.006 * this.stage.sight));
        if (shown.axes && this.principal[body]) this.addAxes(body, place, about);
      }
    if (shown.contact) this.addContacts(at);
    if (shown.constraint) this.addConstraints(at);
    if (shown.impulse) this.addImpulses(t);
    for (const pool of all) pool.end();
  }

  addAxes(body, place, about) {
    const reach = 1.25 * (about.radius || 0.05 * this.stage.sight);
    this.principal[body].forEach(({ axis }, i) => {
      const along = new THREE.Vector3(...axis).applyQuaternion(this.turn).multiplyScalar(reach);
      const rod = laidBetween(place.clone().sub(along), place.clone().add(along), 0.0022 * this.stage.sight);
      if (rod) this.axes[i].add(rod);
    });
  }

  addContacts(at) {
    const run = this.run, c = run.contacts;
    for (let i = run.contactBegins[at.k]; i < run.contactBegins[at.k + 1]; ++i) {
      const a = this.stage.about.bodies[c[0][i]], b = this.stage.about.bodies[c[1][i]], force = new THREE.Vector3(c[5][i], c[6][i], c[7][i]);
      if (a.immovable || (!(b && b.immovable) && force.z < 0)) force.negate();
      this.add('contact', new THREE.Vector3(c[2][i], c[3][i], c[4][i]), force);
    }
  }

  // On both ends along the link: tension pulls them together.
  addConstraints(at) {
    const links = [...this.stage.about.springs.map((link, i) => [link, this.run.springs[at.k][i]]), ...this.stage.about.rods.map((link, i) => [link, this.run.rods[at.k][i]])];
    for (const [link, tension] of links) {
      const a = this.stage.anchorAt(link.a, at), b = this.stage.anchorAt(link.b, at), along = b.clone().sub(a).normalize();
      if (link.a.body >= 0) this.add('constraint', a, along.clone().multiplyScalar(tension));
      if (link.b.body >= 0) this.add('constraint', b, along.clone().multiplyScalar(-tension));
    }
  }

  addImpulses(t) {
    const e = this.run.events, life = 0.4;
    for (let i = this.run.eventFrom(t + 1e-5) - 1, drawn = 0; i >= 0 && t - e.time[i] < life && drawn < kMostFlashes; --i) {
      if (e.kind[i] !== kCollision || !(e.impulse[i] > 0)) continue;
      const point = new THREE.Vector3(...e.point.map(c => c[i])), normal = new THREE.Vector3(...e.normal.map(c => c[i]));
      [[e.a[i], 1], [e.b[i], -1]].forEach(([body, sign]) => {
        const about = this.stage.about.bodies[body];
        if (about && !about.immovable) this.add('impulse', point, normal.clone().multiplyScalar(sign * e.impulse[i]));
      });
      ++drawn;
    }
  }
}

function drawnBySoftware() {
  const gl = document.createElement('canvas').getContext('webgl', { antialias: false }), info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const is = Boolean(info) && /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
  if (gl && gl.getExtension('WEBGL_lose_context')) gl.getExtension('WEBGL_lose_context').loseContext();
  return is;
}

// Where the processor draws, the power of each pixel's colour costs more than all else of it: roots come as near as
// 0.01 to it. Before the first material is compiled.
function takeRoots() {
  const chunk = THREE.ShaderChunk.encodings_pars_fragment, power = 'pow( value.rgb, vec3( 1.0 / gammaFactor ) )';
  THREE.ShaderChunk.encodings_pars_fragment = chunk.replace(power, '( 0.85 * sqrt( value.rgb ) + 0.15 * sqrt( sqrt( value.rgb ) ) )');
}

// The canvas, the camera, and the pointer.
class LivePicture {
  // hand: {aim(ray), showPush(body, way, span), push(body, way, span), pull(to), release(), choose(body), tool()}
  constructor(canvas, box, shown, hand) {
    this.canvas = canvas;
    this.box = box;
    this.shown = shown;
    this.hand = hand;
    this.isSoftware = drawnBySoftware();
    if (this.isSoftware) takeRoots();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.isSoftware });
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.renderer.shadowMap.enabled = !this.isSoftware;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.ratio = Math.min(2, window.devicePixelRatio || 1);
    this.movingRatio = 0;   // while it is paused: that of the run as it went
    this.drag = null;
    this.dark = window.matchMedia('(prefers-color-scheme: dark)');
    this.isFollowing = false;
    this.followed = null;   // {body, place}: where the view has followed it to
    this.addPointer();
    new ResizeObserver(() => this.resize()).observe(box);
  }

  // Nothing is shown until another scene has begun.
  clear() {
    if (this.stage) this.dispose(this.stage.scene);
    this.stage = this.run = this.ghost = this.drag = this.followed = null;
    this.canvas.classList.add('empty');
  }

  setRun(run, formerRun, keepsCamera) {
    this.run = run;
    [kSky, kFloor, kLine] = this.dark.matches ? [0x1b222a, 0x262f38, 0x46535f] : [0xf1f4f7, 0xe3e8ec, 0xb9c4cd];
    if (this.stage) this.dispose(this.stage.scene);
    this.stage = new Stage(run.about, run);
    if (this.isSoftware) this.stage.castNone();
    this.stage.marks.strongest = { impulse: 1e-12, contact: 1e-12, force: 1e-12 };
    this.ghost = formerRun && formerRun.length > 1 && formerRun.about.bodies.length === run.about.bodies.length ? new Ghost(this.stage, formerRun) : null;
    this.vectors = new Vectors(this.stage, run);
    this.discs = this.ghostDiscs = null;
    const isBall = ({ body, glass }) => this.isSoftware && body.shape.kind === 'sphere' && body.shape.radius > 0 && !glass, balls = this.stage.groups.filter(isBall);
    if (balls.length > 0) this.discs = new Discs(this.stage, balls);
    const former = this.ghost ? this.ghost.meshes.filter(({ group }) => isBall(group)) : [], pale = new THREE.Color(kFormerColor).convertGammaToLinear(2.2).toArray();
    if (former.length > 0) this.ghostDiscs = new Discs(this.stage, former.map(one => ({ ...one, color: pale, isQuartered: false })), 0.3);
    this.drawn = '';
    this.time = undefined;
    this.followed = null;
    this.handArrow = new Pool(this.stage.scene, arrowGeometry(), kHandColor);
    this.handLine = new Pool(this.stage.scene, rodGeometry(8), kHandColor);
    this.handBall = new Pool(this.stage.scene, ballGeometry(false, 12), kHandColor);
    if (!this.camera || !keepsCamera) this.reset();
    this.resize();
  }

  dispose(scene) {
    scene.traverse(object => {
      if (object.geometry) object.geometry.dispose();
      if (object.material) object.material.dispose();
    });
    this.renderer.renderLists.dispose();
  }

  reset() {
    const stage = this.stage, about = this.run.about.camera;
    if (this.orbit) this.orbit.dispose();
    this.camera = new THREE.PerspectiveCamera(about.fov, 1, 0.01 * stage.sight, 200 * stage.sight);
    this.camera.up.set(0, 0, 1);
    this.camera.position.copy(stage.eye);
    this.orbit = new THREE.OrbitControls(this.camera, this.canvas);
    this.orbit.enableKeys = false;
    this.orbit.screenSpacePanning = true;
    this.orbit.target.copy(stage.target);
    if (Math.hypot(stage.eye.x - stage.target.x, stage.eye.y - stage.target.y) < 1e-6 * stage.sight) this.camera.position.y -= 1e-3 * stage.sight;
    this.orbit.update();
  }

  resize() {
    const width = Math.max(1, this.box.clientWidth), height = Math.max(1, this.box.clientHeight);
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(width, height, false);
    this.width = width;
    this.height = height;
    if (this.stage && this.time !== undefined) this.draw(this.time, this.stage.chosen);   // the new canvas is blank
  }

  // ---- The view ----

  // The view goes by as much as the body has gone; to the body, where it begins to follow.
  follow(t, chosen) {
    const place = new THREE.Vector3(), turn = new THREE.Quaternion();
    if (!this.isFollowing || !this.run.moving.has(chosen) || !this.run.pose(chosen, this.run.frameAt(t), place, turn)) { this.followed = null; return; }
    const way = place.clone().sub(this.followed && this.followed.body === chosen ? this.followed.place : this.orbit.target);
    this.camera.position.add(way);
    this.orbit.target.add(way);
    this.followed = { body: chosen, place };
  }

  // Places of movable bodies, of many some.
  placesAt(t) {
    const at = this.run.frameAt(t), turn = new THREE.Quaternion(), all = [...this.run.moving.keys()].filter(i => !this.run.about.bodies[i].immovable), stride = Math.ceil(all.length / 400) || 1, places = [];
    for (let k = 0; k < all.length; k += stride) {
      const place = new THREE.Vector3();
      if (this.run.pose(all[k], at, place, turn)) places.push({ place, radius: this.run.about.bodies[all[k]].radius || 0.02 * this.stage.sight });
    }
    return places;
  }

  // Turns nothing: the view moves, so that all movable bodies are in it. A view that follows a body goes on from there.
  findAll(t, chosen) {
    this.follow(t, chosen);
    const box = new THREE.Box3();
    for (const { place, radius } of this.placesAt(t)) box.expandByPoint(place.clone().addScalar(radius)).expandByPoint(place.clone().addScalar(-radius));
    if (box.isEmpty()) return;
    const centre = box.getCenter(new THREE.Vector3()), reach = 0.5 * box.getSize(new THREE.Vector3()).length();
    const half = Math.min(Math.tan(this.camera.fov * Math.PI / 360), Math.tan(this.camera.fov * Math.PI / 360) * this.camera.aspect), back = this.camera.position.clone().sub(this.orbit.target).normalize();
    this.orbit.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(back, Math.max(1.15 * reach / Math.sin(Math.atan(half)), 0.3 * this.stage.sight));
    this.orbit.update();
  }

  // Whether no part of a movable body is in the picture; a body is as large as the ball around it.
  isLost(t) {
    if (!this.stage || !this.camera) return false;
    this.camera.updateMatrixWorld();
    const { matrixWorldInverse, fov, aspect, far } = this.camera, places = this.placesAt(t);
    return places.length > 0 && places.every(({ place, radius }) => {
      const seen = place.clone().applyMatrix4(matrixWorldInverse), half = -seen.z * Math.tan(fov * Math.PI / 360);   // of the picture's height, there
      return half <= 0 || -seen.z > far || Math.abs(seen.x) - radius > half * aspect || Math.abs(seen.y) - radius > half;
    });
  }

  // The grid goes with the view by whole meshes, and the camera reaches as far as it stands away.
  moveGround() {
    const { stage, camera } = this, way = this.orbit.target.clone().sub(stage.target), distance = camera.position.distanceTo(this.orbit.target);
    camera.near = 0.01 * Math.min(distance, 10 * stage.sight);
    camera.far = 200 * Math.max(distance, stage.sight);
    if (stage.ground) stage.ground.position.set(Math.round(way.x / stage.spacing) * stage.spacing, Math.round(way.y / stage.spacing) * stage.spacing, 0);
  }

  // Whether anything has changed since the last picture.
  needsDrawing(t, chosen) {
    const now = `${t} ${chosen} ${this.camera.position.toArray()} ${this.camera.quaternion.toArray()} ${this.width} ${this.height} ${this.ratio} ${JSON.stringify(this.shown)} ${this.run.about.forces.length}`;
    const is = now !== this.drawn || Boolean(this.drag);
    this.drawn = now;
    return is;
  }

  // Fewer pixels where pictures come slowly, more again where the browser has turns to spare; all of them where the run
  // is paused.
  adapt(picturesPerSecond, turnsPerSecond, isPaused) {
    const full = Math.min(2, window.devicePixelRatio || 1), kNotch = 0.75, kSlow = 25, kSpare = 52;
    if (isPaused !== Boolean(this.movingRatio)) {   // paused now, or going on
      const ratio = isPaused ? full : this.movingRatio;
      this.movingRatio = isPaused ? this.ratio : 0;
      this.setRatio(ratio);
    } else if (!isPaused) {
      this.setRatio(picturesPerSecond < kSlow ? Math.max(0.4 * full, kNotch * this.ratio) : turnsPerSecond > kSpare ? Math.min(full, this.ratio / kNotch) : this.ratio);
    }
  }

  setRatio(ratio) {
    if (ratio === this.ratio) return;
    this.ratio = ratio;
    this.resize();
  }

  draw(t, chosen) {
    const { stage, camera } = this;
    this.canvas.classList.remove('empty');
    this.follow(t, chosen);
    this.moveGround();
    const half = Math.tan(this.run.about.camera.fov * Math.PI / 360), aspect = this.width / this.height;
    camera.fov = 2 * Math.atan(half * Math.max(1, 4 / 3 / aspect)) * 180 / Math.PI;
    camera.aspect = aspect;
    camera.updateProjectionMatrix();
    const pixels = 0.5 * this.height * this.ratio / (Math.tan(camera.fov * Math.PI / 360) * camera.position.distanceTo(this.orbit.target));
    if (stage.chosen !== chosen) stage.chosen = chosen;
    stage.key.castShadow = !this.isSoftware && this.shown.shadows;
    stage.refine(pixels);
    for (const push of this.run.about.forces) stage.marks.strongest.force = Math.max(stage.marks.strongest.force, Math.hypot(...push.force));
    stage.show(t, 1, { impulses: false, contacts: false, forces: this.shown.forces, links: this.shown.links, path: false, halo: this.shown.halo, ground: this.shown.ground });
    if (this.ghost) this.ghost.show(t, this.shown.ghost);
    this.showDiscs(pixels);
    this.vectors.show(t, this.shown, chosen);
    this.drawHand(t);
    this.renderer.render(stage.scene, camera);
  }

  showDiscs(pixels) {
    const { camera } = this, height = this.height * this.ratio, areSmall = discs => discs.groups.every(({ members }) => members.every(i => this.stage.scales[i].x * pixels < kMostOfDisc));
    if (this.discs) this.discs.show(camera, height, areSmall(this.discs));
    if (this.ghostDiscs && this.shown.ghost) this.ghostDiscs.show(camera, height, areSmall(this.ghostDiscs));
    else if (this.ghostDiscs) this.ghostDiscs.points.visible = false;
  }

  // Where the point that was aimed at is now.
  heldPoint(t) {
    if (!this.drag || !(this.drag.body >= 0)) return null;
    const place = new THREE.Vector3(), turn = new THREE.Quaternion();
    this.run.pose(this.drag.body, this.run.frameAt(t), place, turn);
    return this.drag.local.clone().applyQuaternion(turn).add(place);
  }

  drawHand(t) {
    for (const pool of [this.handArrow, this.handLine, this.handBall]) pool.begin();
    this.time = t;
    const point = this.heldPoint(t);
    if (point) {
      this.handBall.add(ballAt(point, 0.007 * this.stage.sight));
      const to = this.drag.to;
      if (to && this.drag.tool === 'push') {
        const arrow = laidBetween(point, point.clone().add(this.drag.way), this.drag.way.length());
        if (arrow) this.handArrow.add(arrow);
      } else if (to) {
        const line = laidBetween(point, to, 0.002 * this.stage.sight);
        if (line) this.handLine.add(line);
      }
    }
    for (const pool of [this.handArrow, this.handLine, this.handBall]) pool.end();
  }

  inWorld(point) { return point.toArray().map((x, i) => x + this.run.origin[i]); }

  rayOf(event) {
    const box = this.canvas.getBoundingClientRect(), x = (event.clientX - box.left) / box.width, y = (event.clientY - box.top) / box.height;
    const spot = new THREE.Vector3(2 * x - 1, 1 - 2 * y, 0.5).unproject(this.camera);
    return new THREE.Ray(this.camera.position.clone(), spot.sub(this.camera.position).normalize());
  }

  // The first movable body on a ray, and the point on it; glass and other immovable bodies are seen
  // through.
  hitOn(ray) {
    const at = this.run.frameAt(this.time), place = new THREE.Vector3(), turn = new THREE.Quaternion();
    let best = null;
    for (const body of this.run.moving.keys()) {
      const about = this.run.about.bodies[body];
      if (about.immovable || !this.run.pose(body, at, place, turn)) continue;
      const seen = about.shape.kind === 'sphere' && !(about.shape.radius > 0) ? { ...about, radius: 0.012 * this.stage.sight, shape: { kind: 'sphere', radius: 0.012 * this.stage.sight } } : about;
      const distance = hitBody(seen, this.run.about.meshes, place, turn, ray.origin, ray.direction);
      if (distance < Infinity && (!best || distance < best.distance))
        best = { body, distance, point: ray.at(distance, new THREE.Vector3()), place: place.clone(), turn: turn.clone() };
    }
    return best;
  }

  // The pointer on the plane through the held point that faces the camera.
  onPlane(event, point) {
    const normal = this.camera.getWorldDirection(new THREE.Vector3()), plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point);
    return this.rayOf(event).intersectPlane(plane, new THREE.Vector3());
  }

  // Metres across the picture, from top to bottom, at the depth of a point.
  spanAt(point) {
    return 2 * Math.tan(this.camera.fov * Math.PI / 360) * Math.max(1e-9, point.clone().sub(this.camera.position).dot(this.camera.getWorldDirection(new THREE.Vector3())));
  }

  addPointer() {
    const canvas = this.canvas;
    canvas.addEventListener('pointerdown', event => {
      if (!this.stage || event.button !== 0 || this.drag) return;
      const ray = this.rayOf(event), hit = this.hitOn(ray), tool = this.hand.tool();
      this.downAt = [event.clientX, event.clientY, hit ? hit.body : -1];
      if (!hit || tool === 'look') return;
      this.orbit.enabled = false;
      canvas.setPointerCapture(event.pointerId);
      canvas.classList.add('held');
      this.drag = { tool, body: hit.body, local: hit.point.clone().sub(hit.place).applyQuaternion(hit.turn.clone().conjugate()), to: null, way: new THREE.Vector3() };
      this.hand.choose(hit.body);
      this.hand.aim([...this.inWorld(ray.origin), ...ray.direction.toArray()]);
      event.preventDefault();
    });
    canvas.addEventListener('pointermove', event => {
      if (!this.stage) return;
      if (!this.drag) {
        if (event.buttons === 0) canvas.classList.toggle('over', this.hand.tool() !== 'look' && Boolean(this.hitOn(this.rayOf(event))));
        return;
      }
      const point = this.heldPoint(this.time), to = point && this.onPlane(event, point);
      if (!to) return;
      this.drag.to = to;
      this.drag.way = to.clone().sub(point);
      if (this.drag.tool === 'pull') this.hand.pull(this.inWorld(to));
      else this.hand.showPush(this.drag.body, this.drag.way.toArray(), this.spanAt(point));
    });
    const end = event => {
      if (this.downAt && Math.hypot(event.clientX - this.downAt[0], event.clientY - this.downAt[1]) < 4) this.hand.choose(this.downAt[2]);
      this.downAt = null;
      if (!this.drag) return;
      const drag = this.drag;
      this.drag = null;
      this.orbit.enabled = true;
      canvas.classList.remove('held');
      if (drag.tool === 'pull') this.hand.release();
      else if (event.type === 'pointerup' && drag.to && drag.way.length() > 1e-3 * this.stage.sight) this.hand.push(drag.body, drag.way.toArray(), this.spanAt(drag.to));
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
  }

  // What the laws' ray function has found replaces what the page has.
  aimed(body, local) {
    if (this.drag && body === this.drag.body) this.drag.local.set(...local);
    else if (this.drag) this.drag.body = -1;
  }
}
