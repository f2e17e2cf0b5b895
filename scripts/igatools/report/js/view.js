// The 3-D picture: surface, lines of spans, a cut, and how the surface moves. Draws when something changed.

class View {
  constructor(canvas, scene) {
    this.canvas = canvas;
    this.data = scene;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
    this.scene = new THREE.Scene();
    const vertices = unpack(scene.vertices);
    this.surface = new Surface(vertices, unpack(scene.triangles));
    this.scene.add(this.surface.mesh);
    this.half = scene.half;
    this.eye = new Eye(this.half);
    this.lines = scene.spans ? {interior: this.spanLines('interior'), trimmed: this.spanLines('trimmed')} : {};
    this.step = null;    // the chosen one
    this.largest = 0;    // displacement of the chosen step
    this.takeColours();
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  spanLines(kind) {
    const {low, high, size, rotation} = this.data.spans;
    const middle = low.map((value, d) => (value + high[d]) / 2);
    const corners = unpack(this.data.spans[kind]);
    const places = new Float32Array(corners.length);
    for (let k = 0; k < corners.length; k += 3) {
      const own = [0, 1, 2].map(d => low[d] + size[d] * corners[k + d] - middle[d]);
      for (let d = 0; d < 3; ++d) {
        const turned = rotation[d][0] * own[0] + rotation[d][1] * own[1] + rotation[d][2] * own[2];
        places[k + d] = middle[d] - this.data.centre[d] + turned;
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
    const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial());
    lines.visible = false;
    this.scene.add(lines);
    return lines;
  }

  takeColours() {
    const style = getComputedStyle(document.documentElement);
    const colour = name => new THREE.Color(style.getPropertyValue(name).trim());
    this.renderer.setClearColor(colour('--stage'));
    this.surface.material.uniforms.plain.value = colour('--part');
    this.surface.material.uniforms.section.value = colour('--section');
    for (const [kind, lines] of Object.entries(this.lines)) lines.material.color = colour(`--${kind}`);
    this.draw();
  }

  // number < 0: the part as it was given.
  chooseStep(number) {
    this.step = this.data.steps[number] || null;
    const displacement = this.step ? unpack(this.step.displacement) : new Float32Array(this.surface.vertices.length);
    this.largest = this.step ? this.step.largest : 0;
    if (this.largest > 0) for (let k = 0; k < displacement.length; ++k) displacement[k] /= this.largest;
    this.displacement = displacement;
    this.surface.move(displacement);
    this.draw();
  }

  // Largest displacement as drawn, in units of length.
  setSize(size) {
    this.surface.material.uniforms.size.value = size;
    this.draw();
  }

  // by: '', 'displacement' or 'von_mises'. Returns what the colour bar says, or null.
  colourBy(by) {
    const colouring = this.step && by ? this.colouring(by) : null;
    this.surface.colour(colouring && colouring.values.map(value => value / (colouring.largest || 1)));
    this.draw();
    return colouring;
  }

  colouring(by) {
    const {kind, units} = this.data;
    if (by === 'von_mises') {
      const [usual, most] = [this.overTimes('usual_stress'), this.overTimes('largest_stress')];
      const isSpiky = most > 1.3 * usual && usual > 0;
      return {values: unpack(this.step.von_mises), largest: isSpiky ? usual : most, 
        title: headed('von Mises stress', units.stress || 'units of the run'),
        note: isSpiky ? `Half a per cent of the vertices is above; the largest is ${shortNumber(most)}.` : ''};
    }
    const sizes = new Float32Array(this.displacement.length / 3);
    for (let k = 0; k < sizes.length; ++k) sizes[k] = Math.hypot(...this.displacement.subarray(3 * k, 3 * k + 3));
    if (kind === 'swing') return {values: sizes, largest: 1, title: 'Share of the largest displacement', note: ''};
    return {values: sizes.map(size => size * this.largest), largest: this.overTimes('largest'),
      title: headed('Displacement', units.length), note: ''};
  }

  // One colour scale for all times, so that they can be compared.
  overTimes(key) {
    return this.data.kind === 'time' ? Math.max(...this.data.steps.map(step => step[key])) : this.step[key];
  }

  // axis: '', 'x', 'y' or 'z'; share: 0 … 1 along the part. Cut away is the side where the eye stood when the axis was chosen.
  cut(axis, share) {
    this.surface.material.uniforms.isCut.value = Boolean(axis);
    if (!axis) {
      this.renderer.clippingPlanes = [];
    } else {
      const number = 'xyz'.indexOf(axis);
      const {camera, target} = this.eye;
      if (axis !== this.axis) this.side = camera.position.getComponent(number) < target.getComponent(number) ? 1 : -1;
      const normal = new THREE.Vector3().setComponent(number, this.side);
      this.renderer.clippingPlanes = [new THREE.Plane(normal, -this.side * (2 * share - 1) * this.half[number] * 1.001)];
    }
    this.axis = axis;
    this.draw();
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.drawNow();
  }

  draw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.isAsked = false;
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;  // its tab is not shown
    this.eye.place(width / height);
    this.renderer.render(this.scene, this.eye.camera);
  }
}

function headed(name, unit) {
  return unit ? `${name} [${unit}]` : name;
}
