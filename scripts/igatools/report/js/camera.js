// The eye: it looks at a point, from a distance and two angles; z is up.

const HOME = {turn: -0.9, rise: 0.5};
const SIDES = {x: {turn: 0, rise: 0}, y: {turn: Math.PI / 2, rise: 0}, z: {turn: -Math.PI / 2, rise: Math.PI / 2 - 1e-3}};

class Eye {
  constructor(radius) {
    this.radius = radius;
    this.camera = new THREE.PerspectiveCamera(28, 1, 0.1, 10);
    this.camera.up.set(0, 0, 1);
    this.goHome();
  }

  goHome() {
    Object.assign(this, HOME, {distance: 1.06 * this.radius / Math.sin(14 * Math.PI / 180), target: new THREE.Vector3()});
  }

  lookFrom(side) {
    this.goHome();
    Object.assign(this, SIDES[side]);
  }

  rotate(turn, rise) {
    this.turn += turn;
    this.rise = Math.min(Math.max(this.rise + rise, -Math.PI / 2 + 1e-3), Math.PI / 2 - 1e-3);
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.2 * this.radius), 40 * this.radius);
  }

  // By shares of the picture's height.
  shift(right, up) {
    const height = 2 * this.distance * Math.tan(14 * Math.PI / 180);
    const matrix = this.camera.matrixWorld.elements;
    this.target.addScaledVector(new THREE.Vector3(matrix[0], matrix[1], matrix[2]), -right * height);
    this.target.addScaledVector(new THREE.Vector3(matrix[4], matrix[5], matrix[6]), -up * height);
  }

  place(aspect) {
    // A narrow picture is filled across.
    const distance = this.distance * Math.max(1, 1 / aspect);
    const flat = Math.cos(this.rise);
    this.camera.position.set(flat * Math.cos(this.turn), flat * Math.sin(this.turn), Math.sin(this.rise))
      .multiplyScalar(distance).add(this.target);
    this.camera.aspect = aspect;
    this.camera.near = Math.max(distance - 4 * this.radius, distance / 200);
    this.camera.far = distance + 4 * this.radius;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}
