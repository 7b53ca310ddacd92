// One run in three dimensions, with the camera, light and colours of the program's pictures.

const kChosen = 0xffb000, kGhostColor = 0x2a4a6a, kGhost = 0.38, kXray = 0.28;
const kLevel = 1 - 1e-8;   // cosine: within 0.008 degrees of level a plane is the ground; others have an edge
let kSky = 0xf1f4f7, kFloor = 0xe3e8ec, kLine = 0xb9c4cd;   // a page that follows the dark scheme has others

class Stage {
  // @param runs  all that are shown: arrows have one scale, and grids one height
  constructor(about, run, runs = [run]) {
    this.about = about;
    this.run = run;
    this.runs = runs;
    this.eye = new THREE.Vector3(...about.camera.eye);
    this.target = new THREE.Vector3(...about.camera.target);
    this.sight = this.eye.distanceTo(this.target);
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(kSky);
    this.place = new THREE.Vector3();
    this.turn = new THREE.Quaternion();
    this.lastPlaces = about.bodies.map(() => new THREE.Vector3());
    this.findFloor();
    this.findExtent();
    this.addBodies();
    this.addLight();
    this.addGround();
    this.marks = new Marks(this.scene, run, about, this.sight, runs);
    this.addLinks();
    this.addSheets();
    this.addOutline();
  }

  // The first level plane is the ground; it is drawn without an edge.
  findFloor() {
    this.floor = this.about.bodies.findIndex((body, i) => {
      if (body.shape.kind !== 'plane' || this.run.moving.has(i)) return false;
      this.run.pose(i, { k: 0, part: 0 }, this.place, this.turn);
      return new THREE.Vector3(0, 0, 1).applyQuaternion(this.turn).z > kLevel;
    });
  }

  findExtent() {
    this.extent = this.extentOf(this.run);
    this.lowest = Math.min(...this.runs.map(run => (run === this.run ? this.extent : this.extentOf(run)).min.z));
  }

  // Extent of all finite bodies over a run.
  extentOf(run) {
    const extent = new THREE.Box3(), frames = run.times.length, stride = Math.max(1, Math.floor(frames / 100));
    this.about.bodies.forEach((body, i) => {
      if (body.radius === null) return;
      const r = new THREE.Vector3().setScalar(body.radius), last = run.moving.has(i) ? frames : 1;
      for (let k = 0; k < last; k += stride)
        if (run.pose(i, { k, part: 0 }, this.place, this.turn)) extent.expandByPoint(this.place.clone().add(r)).expandByPoint(this.place.clone().sub(r));
    });
    return extent.isEmpty() ? extent.expandByPoint(this.target) : extent;
  }

  // Bodies with equal geometry, colour and opacity are drawn by one call.
  addBodies() {
    const groups = new Map(), meshes = this.about.meshes;
    this.scales = this.about.bodies.map(body => scaleOf(body, this.sight));
    this.about.bodies.forEach((body, i) => {
      if (i === this.floor) return;
      const isQuartered = !body.immovable && body.shape.kind === 'sphere' && body.shape.radius > 0, color = colorOf(body, i), glass = this.isGlass(i);
      const key = JSON.stringify([body.shape.kind, body.shape.mesh, body.shape.pips, isQuartered, color, glass]);
      if (!groups.has(key)) groups.set(key, { body, color, glass, isQuartered, members: [] });
      groups.get(key).members.push(i);
    });
    this.groups = [...groups.values()];
    const geometries = new Map();
    const made = (shape, isQuartered, segments) => {
      const key = JSON.stringify([shape.kind, shape.mesh, shape.pips, isQuartered, segments]);
      if (!geometries.has(key)) geometries.set(key, geometryOf(shape, meshes, isQuartered, segments));
      return sameGeometry(geometries.get(key));
    };
    for (const group of this.groups) {
      const shape = group.body.shape, levels = new Map();
      group.geometry = segments => levels.get(segments) || levels.set(segments, made(shape, group.isQuartered, segments)).get(segments);
      group.radius = Math.max(...group.members.map(i => this.scales[i].x));
      const material = new THREE.MeshLambertMaterial({ color: new THREE.Color(...group.color), vertexColors: THREE.VertexColors, transparent: group.glass > 0,
        opacity: group.glass || 1, depthWrite: !group.glass, side: shape.kind === 'plane' ? THREE.DoubleSide : THREE.FrontSide });
      group.mesh = new THREE.InstancedMesh(group.geometry(12), material, group.members.length);
      group.mesh.frustumCulled = false;
      group.mesh.castShadow = !group.glass;
      group.mesh.receiveShadow = !group.glass;
      if (group.glass) group.mesh.renderOrder = 1;
      this.scene.add(group.mesh);
    }
  }

  // An immovable body that occludes moving ones is glass. @return its opacity, or 0
  isGlass(index) {
    const body = this.about.bodies[index];
    if (!body.immovable) return 0;
    this.run.pose(index, { k: 0, part: 0 }, this.place, this.turn);
    if (body.shape.kind === 'plane') return Math.abs(new THREE.Vector3(0, 0, 1).applyQuaternion(this.turn).z) < 0.5 ? 0.22 : 0;
    const wall = { place: this.place.clone(), turn: this.turn.clone() }, frames = this.run.times.length;
    for (const moving of [...this.run.moving.keys()].slice(0, 40))
      for (let k = 0; k < frames; k += Math.max(1, Math.floor(frames / 12))) {
        if (!this.run.pose(moving, { k, part: 0 }, this.place, this.turn)) continue;
        const to = this.place.clone().sub(this.eye), distance = to.length();
        if (hitBody(body, this.about.meshes, wall.place, wall.turn, this.eye, to.divideScalar(distance)) < distance - (this.about.bodies[moving].radius || 0)) return 0.25;
      }
    return 0;
  }

  addLight() {
    const forward = this.target.clone().sub(this.eye).normalize(), right = forward.clone().cross(new THREE.Vector3(0, 0, 1));
    if (right.length() < 1e-6) right.set(1, 0, 0);
    right.normalize();
    const toLight = right.clone().multiplyScalar(-0.55).add(right.clone().cross(new THREE.Vector3(0, 0, 1)).multiplyScalar(0.35)).add(new THREE.Vector3(0, 0, 0.95)).normalize();
    const sky = new THREE.HemisphereLight(0xffffff, 0xb8b0a8, 0.55), key = new THREE.DirectionalLight(0xffffff, 0.75);
    sky.position.set(0, 0, 1);
    const radius = Math.min(this.sight, 0.5 * this.extent.getSize(new THREE.Vector3()).length() + 1e-3 * this.sight);
    const centre = radius < this.sight ? this.extent.getCenter(new THREE.Vector3()) : this.target;
    key.position.copy(centre).addScaledVector(toLight, 3 * radius);
    key.target.position.copy(centre);
    key.castShadow = true;
    Object.assign(key.shadow.camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: radius, far: 6 * radius });
    key.shadow.mapSize.set(1024, 1024);
    key.shadow.bias = -0.002;
    this.key = key;
    this.scene.add(sky, key, key.target);
  }

  // A grid with lines that fade with distance, and the floor where there is one.
  addGround() {
    const given = this.about.grid.spacing, sight = this.sight;
    if (given === null && this.floor < 0) return;
    const decade = Math.pow(10, Math.floor(Math.log10(sight / 12))), spacing = given || [1, 2, 5, 10].map(x => x * decade).find(x => x >= sight / 12 * (1 - 1e-9));
    let height = this.about.grid.height;
    if (this.floor >= 0) height = (this.run.pose(this.floor, { k: 0, part: 0 }, this.place, this.turn), this.place.z);
    else if (this.about.camera.follow < 0) height = Math.min(height, this.lowest);
    this.spacing = spacing;
    const sky = new THREE.Color(kSky).convertGammaToLinear(2.2), line = new THREE.Color(kLine).convertGammaToLinear(2.2), floor = new THREE.Color(kFloor).convertGammaToLinear(2.2);
    const nearest = axis => Math.round((this.target[axis] + this.run.origin['xy'.indexOf(axis)]) / spacing) * spacing - this.run.origin['xy'.indexOf(axis)];   // of the world's grid
    const cx = nearest('x'), cy = nearest('y'), reach = 2.6 * sight;
    const fade = (from, r) => from.clone().lerp(sky, Math.min(1, r / Math.min(reach, 60 * spacing)));
    this.ground = new THREE.Group();
    const count = Math.min(60, Math.ceil(reach / spacing)), points = [], colors = [], parts = 6;
    for (let i = -count; i <= count; ++i)
      for (let k = -parts; k < parts; ++k)
        for (const [x, y] of [[i * spacing, k], [i * spacing, k + 1]]) {
          const along = y * count * spacing / parts, color = fade(line, Math.hypot(x, along));
          points.push(cx + x, cy + along, height, cx + along, cy + x, height);
          colors.push(color, color);
        }
    const ordered = [], shades = [];   // the two ends of each line are adjacent, for both directions
    for (let i = 0; i < points.length; i += 12)
      for (const offset of [0, 6, 3, 9]) {
        ordered.push(points[i + offset], points[i + offset + 1], points[i + offset + 2]);
        const color = colors[(i + offset) / 3];
        shades.push(color.r, color.g, color.b);
      }
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', new THREE.Float32BufferAttribute(ordered, 3));
    lines.setAttribute('color', new THREE.Float32BufferAttribute(shades, 3));
    const grid = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors }));
    grid.renderOrder = -1;
    this.ground.add(grid);
    if (this.floor >= 0) this.ground.add(this.floorDisc(cx, cy, height, reach, floor, sky));
    const shadow = new THREE.Mesh(new THREE.PlaneBufferGeometry(2 * reach, 2 * reach), new THREE.ShadowMaterial({ opacity: 0.28, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, depthWrite: false }));
    shadow.position.set(cx, cy, height);
    shadow.receiveShadow = true;
    shadow.renderOrder = -1;
    this.shadowed = shadow;
    if (this.floor >= 0) this.ground.add(shadow);
    this.scene.add(this.ground);
  }

  // Without shadows: the plane that takes them would be drawn over the whole ground for nothing.
  castNone() {
    this.key.castShadow = false;
    if (this.shadowed) this.shadowed.visible = false;
    for (const group of this.groups) group.mesh.castShadow = group.mesh.receiveShadow = false;
  }

  floorDisc(cx, cy, height, reach, floor, sky) {
    const disc = new THREE.RingBufferGeometry(1e-3 * reach, reach, 48, 12), colors = [], p = disc.attributes.position;
    for (let i = 0; i < p.count; ++i) {
      const color = floor.clone().lerp(sky, Math.min(1, Math.hypot(p.getX(i), p.getY(i)) / reach));
      colors.push(color.r, color.g, color.b);
    }
    disc.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
    const mesh = new THREE.Mesh(disc, new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 }));
    mesh.position.set(cx, cy, height);
    mesh.renderOrder = -2;
    return mesh;
  }

  addLinks() {
    const at = { k: 0, part: 0 };
    const slim = (share, anchors) => Math.min(share * this.sight, ...anchors.filter(a => a.body >= 0 && this.about.bodies[a.body].radius > 0).map(a => 0.4 * this.about.bodies[a.body].radius));
    const isMany = this.about.rods.length + this.about.joints.length > 150, sides = isMany ? 5 : 12, segments = isMany ? 8 : 16;
    const metal = new Pool(this.scene, rodGeometry(sides), kColors.rod), balls = new Pool(this.scene, ballGeometry(false, segments), kColors.rod);
    const joints = new Pool(this.scene, ballGeometry(false, segments), kColors.joint), pins = new Pool(this.scene, rodGeometry(sides), kColors.joint);
    const coils = [10, 20, 40].map(turns => new Pool(this.scene, coilGeometry(turns), kColors.spring));
    this.pools = [metal, balls, joints, pins, ...coils];
    this.links = [];
    for (const spring of this.about.springs) {
      const length = Math.max(this.anchorAt(spring.a, at).distanceTo(this.anchorAt(spring.b, at)), spring.rest || 0, 0.05 * this.sight);
      const width = Math.min(0.016 * this.sight, length / 7), turns = length / (0.9 * width);
      const coil = coils[turns > 28 ? 2 : turns > 14 ? 1 : 0];
      this.links.push((a, b) => { const m = laidBetween(a, b, width); if (m) coil.add(m); });
    }
    for (const rod of this.about.rods) {
      const width = slim(0.0032, [rod.a, rod.b]);
      this.links.push((a, b) => {
        const m = laidBetween(a, b, width);
        if (m) metal.add(m);
        balls.add(ballAt(a, 1.7 * width));
        balls.add(ballAt(b, 1.7 * width));
      });
    }
    for (const joint of this.about.joints) {
      const width = slim(0.0075, [joint.a]);
      if (joint.kind === 'weld') this.links.push(() => {});   // a weld is not drawn
      else if (joint.kind === 'ball') this.links.push(a => joints.add(ballAt(a, width)));
      else this.links.push((a, b) => {
        const half = b.sub(a).normalize().multiplyScalar(2.2 * width), m = laidBetween(a.clone().sub(half), a.clone().add(half), 0.7 * width);
        if (m) pins.add(m);
      });
    }
    this.linked = [...this.about.springs, ...this.about.rods, ...this.about.joints];
  }

  // Level surfaces that one sees through, so wide that their edges are far beyond what is looked at.
  addSheets() {
    for (const sheet of this.about.sheets) {
      const material = new THREE.MeshLambertMaterial({ color: new THREE.Color(...sheet.color), transparent: true, opacity: 0.35, depthWrite: false, side: THREE.DoubleSide });
      const surface = new THREE.Mesh(new THREE.PlaneBufferGeometry(5.2 * this.sight, 5.2 * this.sight), material);
      surface.position.set(this.target.x, this.target.y, sheet.height);
      surface.renderOrder = 1;
      this.scene.add(surface);
    }
  }

  anchorAt(anchor, at) {
    const point = new THREE.Vector3(...anchor.point);
    if (anchor.body < 0) return point;
    this.run.pose(anchor.body, at, this.place, this.turn);
    return point.applyQuaternion(this.turn).add(this.place);
  }

  // The outline of the chosen body: its own shape, a little larger, of which only the far side is
  // drawn.
  addOutline() {
    this.outline = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ color: new THREE.Color(kChosen).convertGammaToLinear(2.2), side: THREE.BackSide }));
    this.outline.visible = false;
    this.outline.frustumCulled = false;
    this.scene.add(this.outline);
  }

  choose(body) {
    this.chosen = body;
    this.marks.tracePath(body);
    const group = this.groups.find(g => g.members.includes(body));
    if (group) this.outline.geometry = group.geometry(24);
  }

  // As a ghost behind another run: bodies that one sees through, without ground and marks.
  haunt(isGhost) {
    if (this.isGhost === isGhost) return;
    this.isGhost = isGhost;
    this.scene.background = isGhost ? null : new THREE.Color(kSky);
    for (const group of this.groups) {
      const material = group.mesh.material;
      Object.assign(material, { transparent: isGhost || group.glass > 0, opacity: isGhost ? kGhost * (group.glass || 1) : group.glass || 1, depthWrite: !isGhost && !group.glass,
        polygonOffset: isGhost, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });   // where both are at one place the first run hides the ghost
      material.color.setRGB(...group.color);
      if (isGhost) material.color.lerp(new THREE.Color(kGhostColor), 0.6);
      material.needsUpdate = true;
    }
    this.dressed = undefined;
  }

  // Bodies that one sees through, or the edges of their triangles, where asked for.
  dress({ xray = false, wires = false }) {
    const words = `${xray} ${wires}`;
    if (this.dressed === words) return;
    const isFirst = this.dressed === undefined && !xray && !wires;
    this.dressed = words;
    if (isFirst) return;
    for (const group of this.groups) {
      const material = group.mesh.material, solid = this.isGhost ? kGhost * (group.glass || 1) : group.glass || 1;
      Object.assign(material, { wireframe: wires, transparent: xray || solid < 1, opacity: xray ? Math.min(solid, kXray) : solid, depthWrite: !xray && solid === 1 });
      group.mesh.castShadow = !xray && !wires && !group.glass;
      material.needsUpdate = true;
    }
  }

  // Levels of detail of balls, by their size in the picture. @param pixels  per metre at the
  // camera's target
  refine(pixels) {
    for (const group of this.groups) if (group.body.shape.kind === 'sphere') group.mesh.geometry = group.geometry(segmentsFor(group.radius * pixels));
  }

  // Updates everything to time t. @param speed  of playing, for the duration of a flash
  show(t, speed, shown) {
    const at = this.run.frameAt(t), matrix = new THREE.Matrix4();
    this.dress(shown);
    for (const group of this.groups) {
      group.members.forEach((i, slot) => {
        const seen = this.run.pose(i, at, this.place, this.turn);
        this.lastPlaces[i].copy(this.place);
        group.mesh.setMatrixAt(slot, seen ? matrix.compose(this.place, this.turn, this.scales[i]) : matrix.makeScale(0, 0, 0));
      });
      group.mesh.instanceMatrix.needsUpdate = true;
    }
    for (const pool of this.pools) pool.begin();
    if (shown.links) this.links.forEach((draw, i) => {
      const link = this.linked[i], a = this.anchorAt(link.a, at), b = link.b ? this.anchorAt(link.b, at) : null;
      if (Number.isFinite(a.x)) draw(a, b);
    });
    for (const pool of this.pools) pool.end();
    this.marks.show(t, at, speed, shown, (body, place, turn) => this.run.pose(body, at, place, turn));
    this.marks.path.visible = shown.path && this.chosen !== undefined && this.run.moving.has(this.chosen);
    if (this.ground) this.ground.visible = shown.ground && !this.isGhost;
    const chosen = this.about.bodies[this.chosen];
    this.outline.visible = Boolean(chosen && chosen.radius > 0 && shown.halo && !this.isGhost) && this.run.pose(this.chosen, at, this.outline.position, this.outline.quaternion);
    if (this.outline.visible) this.outline.scale.copy(this.scales[this.chosen]).multiplyScalar(1 + Math.min(0.3, Math.max(0.03, 0.006 * this.sight / chosen.radius)));
  }

  placeOf(body, t) {
    this.run.pose(body, this.run.frameAt(t), this.place, this.turn);
    return this.place.clone();
  }

  // The first movable body that a ray hits, through walls; where there is none, the first immovable
  // one; -1: none.
  pick(origin, direction, t) {
    const at = this.run.frameAt(t), best = [Infinity, Infinity], found = [-1, -1];
    this.about.bodies.forEach((body, i) => {
      if (!this.run.pose(i, at, this.place, this.turn)) return;
      const distance = hitBody(body, this.about.meshes, this.place, this.turn, origin, direction), kind = body.immovable ? 1 : 0;
      if (distance < best[kind]) [best[kind], found[kind]] = [distance, i];
    });
    return found[0] >= 0 ? found[0] : found[1];
  }
}
