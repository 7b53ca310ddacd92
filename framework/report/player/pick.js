// The first body that a ray hits: tested in the body frame, by its shape.

function hitSphere(origin, along, radius) {
  const b = origin.dot(along), c = origin.lengthSq() - radius * radius, root = b * b - c;
  return root < 0 ? Infinity : -b - Math.sqrt(root);
}

function hitBox(origin, along, half) {
  let near = -Infinity, far = Infinity;
  ['x', 'y', 'z'].forEach((axis, i) => {
    const a = (-half[i] - origin[axis]) / along[axis], b = (half[i] - origin[axis]) / along[axis];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  });
  return near <= far ? near : Infinity;
}

function hitMesh(origin, along, mesh) {
  const ray = new THREE.Ray(origin, along), at = new THREE.Vector3(), v = mesh.vertices, f = mesh.faces;
  const corner = i => new THREE.Vector3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  let best = Infinity;
  for (let i = 0; i < f.length; i += 3)
    if (ray.intersectTriangle(corner(f[i]), corner(f[i + 1]), corner(f[i + 2]), true, at)) best = Math.min(best, at.distanceTo(origin));
  return best;
}

// @return distance along the unit direction to the body's surface; Infinity: no hit. Planes are not
//   tested.
function hitBody(body, meshes, place, turn, origin, direction) {
  const back = turn.clone().conjugate(), from = origin.clone().sub(place), reach = body.radius;
  if (reach === null || from.clone().cross(direction).length() > reach) return Infinity;
  const o = from.applyQuaternion(back), d = direction.clone().applyQuaternion(back), shape = body.shape;
  const distance = shape.kind === 'sphere' ? hitSphere(o, d, shape.radius) : shape.kind === 'box' ? hitBox(o, d, shape.half) : hitMesh(o, d, meshes[shape.mesh]);
  return distance > 0 ? distance : Infinity;
}
