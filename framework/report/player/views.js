// Where the camera may stand, and the directions of x, y, z in a corner of the picture.

// From which direction one looks (world frame, z up), or what shall fill the picture.
const kLooks = {
  front: { text: 'from the front, along +y', from: [0, -1, 0] },
  back: { text: 'from the back, along −y', from: [0, 1, 0] },
  left: { text: 'from the left, along +x', from: [-1, 0, 0] },
  right: { text: 'from the right, along −x', from: [1, 0, 0] },
  top: { text: 'from above', from: [0, -1e-3, 1] },   // y is up: the line of sight must not be parallel to the camera's up direction
  below: { text: 'from below', from: [0, -1e-3, -1] },
  all: { text: 'all bodies', of: 'all' },
  body: { text: 'the chosen body', of: 'body' },
  scene: { text: 'as the scene has it', of: 'scene' },
};
const kTriadPixels = 84;
const kAxisColors = ['#a82c00', '#00664b', '#00446b'];

class Triad {
  constructor() {
    this.scene = new THREE.Scene();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 1));
    this.camera = new THREE.OrthographicCamera(-1.55, 1.55, 1.55, -1.55, 0, 10);
    ['x', 'y', 'z'].forEach((name, i) => {
      const along = new THREE.Vector3().setComponent(i, 1), material = new THREE.MeshLambertMaterial({ color: new THREE.Color(kAxisColors[i]).convertGammaToLinear(2.2) });
      const arrow = new THREE.Mesh(arrowGeometry(), material);
      arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), along);
      arrow.scale.set(1.6, 1.6, 1);
      const letter = new THREE.Sprite(new THREE.SpriteMaterial({ map: this.letter(name, kAxisColors[i]), depthTest: false }));
      letter.position.copy(along).multiplyScalar(1.28);
      letter.scale.setScalar(0.5);
      this.scene.add(arrow, letter);
    });
  }

  letter(name, color) {
    const canvas = document.createElement('canvas'), g = canvas.getContext('2d');
    canvas.width = canvas.height = 64;
    g.font = 'bold 46px "DejaVu Sans", Arial, sans-serif';
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    g.fillStyle = color;
    g.fillText(name, 32, 32);
    const texture = new THREE.CanvasTexture(canvas);
    texture.encoding = THREE.sRGBEncoding;
    return texture;
  }

  // In the lower left corner, as the picture's camera sees it.
  draw(renderer, camera, target) {
    const back = camera.position.clone().sub(target).normalize();
    this.camera.position.copy(back).multiplyScalar(5);
    this.camera.quaternion.copy(camera.quaternion);
    renderer.setViewport(4, 4, kTriadPixels, kTriadPixels);
    renderer.setScissor(4, 4, kTriadPixels, kTriadPixels);
    renderer.autoClear = false;
    renderer.clearDepth();
    renderer.render(this.scene, this.camera);
    renderer.autoClear = true;
  }
}
