// Geometries and colours of bodies.

// Colours distinguishable for every colour vision (Okabe and Ito 2008), linear; as in the program's
// pictures.
const kPalette = [[0.000, 0.168, 0.445], [0.665, 0.112, 0.000], [0.000, 0.342, 0.171], [0.791, 0.347, 0.000], [0.604, 0.191, 0.386], [0.093, 0.456, 0.815]];
const kImmovable = [0.42, 0.45, 0.48];

function colorOf(body, index) { return body.color || (body.immovable ? kImmovable : kPalette[index % kPalette.length]); }

function geometryFrom(positions, normals, shades) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.Float32BufferAttribute(normals, 3));
  if (shades) geometry.setAttribute('color', new THREE.Float32BufferAttribute(shades, 3));
  return geometry;
}

// Ball of radius 1; two of its quarters are darker, so that its rotation is visible. Few corners,
// for software rendering.
function ballGeometry(isQuartered, segments) {
  const quarter = k => {
    const part = new THREE.SphereBufferGeometry(1, segments / 4, segments / 2, k * Math.PI / 2, Math.PI / 2).rotateX(Math.PI / 2);
    part.setAttribute('color', new THREE.Float32BufferAttribute(Array.from(part.attributes.position.array, () => (isQuartered && k % 2 === 0 ? 0.45 : 1)), 3));
    return part;
  };
  return merged([0, 1, 2, 3].map(quarter));
}

// Enough segments that a ball's outline looks round.
function segmentsFor(pixels) { return pixels < 7 ? 8 : pixels < 16 ? 12 : pixels < 45 ? 20 : 40; }

// Faces at less than 40 degrees to each other are shaded as one smooth surface; other edges stay
// sharp. The normal of a face's corner is the mean over the faces around the vertex within that
// angle of this face, weighted by their angles (Thuermer and Wuethrich 1998).
function meshGeometry(mesh) {
  const v = mesh.vertices, f = mesh.faces, count = f.length / 3, cosCrease = Math.cos(40 * Math.PI / 180);
  const corner = i => new THREE.Vector3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  const faceNormals = [], around = new Map();
  for (let i = 0; i < count; ++i) {
    const [a, b, c] = [0, 1, 2].map(k => corner(f[3 * i + k]));
    faceNormals.push(b.clone().sub(a).cross(c.clone().sub(a)).normalize());
    const points = [a, b, c];
    for (let k = 0; k < 3; ++k) {
      const index = f[3 * i + k], angle = points[(k + 1) % 3].clone().sub(points[k]).angleTo(points[(k + 2) % 3].clone().sub(points[k]));
      if (!around.has(index)) around.set(index, []);
      around.get(index).push([i, angle || 0]);
    }
  }
  const positions = [], normals = [];
  for (let i = 0; i < count; ++i)
    for (let k = 0; k < 3; ++k) {
      const index = f[3 * i + k], sum = new THREE.Vector3();
      for (const [other, angle] of around.get(index))
        if (faceNormals[other].dot(faceNormals[i]) >= cosCrease) sum.addScaledVector(faceNormals[other], angle);
      sum.normalize();
      positions.push(v[3 * index], v[3 * index + 1], v[3 * index + 2]);
      normals.push(sum.x, sum.y, sum.z);
    }
  return geometryFrom(positions, normals, positions.map(() => 1));
}

// A copy that shares the buffers: three.js r111 keeps the instance attributes of one instanced mesh
// bound for the next one with the same geometry.
function sameGeometry(geometry) {
  const same = new THREE.BufferGeometry();
  for (const [name, attribute] of Object.entries(geometry.attributes)) same.setAttribute(name, attribute);
  if (geometry.index) same.setIndex(geometry.index);
  return same;
}

function merged(parts) {
  const whole = new THREE.BufferGeometry(), index = [];
  for (const name of Object.keys(parts[0].attributes).filter(key => key !== 'uv')) {
    const joined = [].concat(...parts.map(part => Array.from(part.attributes[name].array)));
    whole.setAttribute(name, new THREE.Float32BufferAttribute(joined, 3));
  }
  let first = 0;
  for (const part of parts) {
    for (const i of part.index.array) index.push(first + i);
    first += part.attributes.position.count;
  }
  whole.setIndex(index);
  return whole;
}

// Along z from 0 to 1: an arrow, a rod of radius 1, a coil of radius 1.
function arrowGeometry() {
  const shaft = new THREE.CylinderBufferGeometry(0.035, 0.035, 0.72, 8), head = new THREE.ConeBufferGeometry(0.1, 0.28, 10);
  shaft.rotateX(Math.PI / 2).translate(0, 0, 0.36);
  head.rotateX(Math.PI / 2).translate(0, 0, 0.86);
  return merged([shaft, head]);
}

function rodGeometry(sides) { return new THREE.CylinderBufferGeometry(1, 1, 1, sides).rotateX(Math.PI / 2).translate(0, 0, 0.5); }

function coilGeometry(turns) {
  class Helix extends THREE.Curve {
    getPoint(share) {
      const ramp = Math.min(1, Math.min(share, 1 - share) / 0.07), radius = 0.83 * ramp * ramp * (3 - 2 * ramp), angle = 2 * Math.PI * turns * share;
      return new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), share * 0.9 * turns);
    }
  }
  // The wire is round where the turns are 0.9 radii apart.
  return new THREE.TubeBufferGeometry(new Helix(), 14 * turns, 0.17, 6).scale(1, 1, 1 / (0.9 * turns));
}

function geometryOf(shape, meshes, isQuartered, segments) {
  if (shape.kind === 'sphere') return ballGeometry(isQuartered, segments);
  if (shape.kind === 'mesh') return meshGeometry(meshes[shape.mesh]);
  const flat = shape.kind === 'box' ? new THREE.BoxBufferGeometry(2, 2, 2).toNonIndexed() : new THREE.PlaneBufferGeometry(2, 2).toNonIndexed();
  const { position, normal } = flat.attributes, pips = (shape.pips || []).map(pipGeometry);
  const joined = (own, key) => [].concat(Array.from(own), ...pips.map(pip => pip[key]));
  return geometryFrom(joined(position.array, 'positions'), joined(normal.array, 'normals'), joined(Array.from(position.array, () => 1), 'shades'));
}

// A dark disc on a face of a box whose half edges are 1, a little above it.
function pipGeometry(pip) {
  const kSides = 14, kLift = 1.004, axis = pip.normal.findIndex(x => x !== 0), sign = pip.normal[axis], positions = [], normals = [], shades = [];
  const corner = (k, reach) => {
    const point = pip.point.slice(), angle = 2 * Math.PI * k / kSides * sign, [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    point[axis] *= kLift;
    point[u] += reach * pip.radii[u] * Math.cos(angle);
    point[v] += reach * pip.radii[v] * Math.sin(angle);
    return point;
  };
  for (let k = 0; k < kSides; ++k)
    for (const point of [corner(0, 0), corner(k, 1), corner(k + 1, 1)]) {
      positions.push(...point);
      normals.push(...pip.normal);
      shades.push(0.02, 0.02, 0.02);
    }
  return { positions, normals, shades };
}

function scaleOf(body, sight) {
  const shape = body.shape;
  if (shape.kind === 'sphere') return new THREE.Vector3().setScalar(shape.radius > 0 ? shape.radius : 0.008 * sight);   // a point mass is drawn as a dot
  if (shape.kind === 'box') return new THREE.Vector3(...shape.half);
  if (shape.kind === 'plane') return new THREE.Vector3(shape.extent, shape.extent, 1);
  return new THREE.Vector3(1, 1, 1);
}
