// The eye: it looks at a point from two angles; z is up. Its distance is a multiple of the one from which the part fills the
// picture.

const HOME = {turn: -0.9, rise: 0.5};
const OPENING = 28 * Math.PI / 180;  // angle of the picture's height
const ROOM = 1.08;                   // around the part
const SIDES = {x: {turn: 0, rise: 0}, y: {turn: Math.PI / 2, rise: 0}, z: {turn: -Math.PI / 2, rise: Math.PI / 2 - 1e-3}};

class Eye {
  // half: half the sides of the part's box.
  constructor(half) {
    this.half = half;
    this.radius = Math.hypot(...half);
    this.camera = new THREE.PerspectiveCamera(OPENING * 180 / Math.PI, 1, 0.1, 10);
    this.camera.up.set(0, 0, 1);
    this.distance = 1;
    this.goHome();
  }

  goHome() {
    Object.assign(this, HOME, {far: ROOM, target: new THREE.Vector3()});
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
    this.far = Math.min(Math.max(this.far * factor, 0.05), 10);
  }

  // By shares of the picture's height.
  shift(right, up) {
    const height = 2 * this.distance * Math.tan(OPENING / 2);
    const matrix = this.camera.matrixWorld.elements;
    this.target.addScaledVector(new THREE.Vector3(matrix[0], matrix[1], matrix[2]), -right * height);
    this.target.addScaledVector(new THREE.Vector3(matrix[4], matrix[5], matrix[6]), -up * height);
  }

  place(aspect) {
    const flat = Math.cos(this.rise);
    const back = new THREE.Vector3(flat * Math.cos(this.turn), flat * Math.sin(this.turn), Math.sin(this.rise));
    const distance = this.distance = this.far * this.filling(back, aspect);
    this.camera.position.copy(back).multiplyScalar(distance).add(this.target);
    this.camera.aspect = aspect;
    this.camera.near = Math.max(distance - 4 * this.radius, distance / 200);
    this.camera.far = distance + 4 * this.radius;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  // Least distance from which all corners of the box are in the picture; `back` points from the part to the eye.
  filling(back, aspect) {
    const right = new THREE.Vector3(-Math.sin(this.turn), Math.cos(this.turn), 0);
    const up = new THREE.Vector3().crossVectors(back, right);
    const slope = Math.tan(OPENING / 2);
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const place = new THREE.Vector3(...this.half.map((side, d) => corner >> d & 1 ? side : -side));
      const reach = Math.max(Math.abs(place.dot(right)) / aspect, Math.abs(place.dot(up)));
      distance = Math.max(distance, place.dot(back) + reach / slope);
    }
    return distance;
  }
}
