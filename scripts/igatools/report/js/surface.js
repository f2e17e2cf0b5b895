// The part's surface: vertices doubled at sharp edges, moved and lit on the graphics card.
// With p(s) = p + s d at the corners, a triangle's area vector is a0 + s a1 + s² a2; their sums at vertices are exact normals for
// every size s of the motion.

const SHARP = Math.cos(35 * Math.PI / 180);

const VERTEX_SHADER = `
  attribute vec3 displacement, normal1, normal2;
  attribute float value;
  uniform float size;
  varying vec3 direction;
  varying float share;
  #include <clipping_planes_pars_vertex>
  void main() {
    vec4 mvPosition = modelViewMatrix * vec4(position + size * displacement, 1.0);
    direction = normalMatrix * (normal + size * (normal1 + size * normal2));
    share = value;
    gl_Position = projectionMatrix * mvPosition;
    #include <clipping_planes_vertex>
  }`;

// Where the part is cut open its inside has one flat colour. Lines mark tenths of the colour scale.
const FRAGMENT_SHADER = `
  uniform vec3 plain, section;
  uniform sampler2D palette;
  uniform bool isColoured, isCut;
  varying vec3 direction;
  varying float share;
  #include <clipping_planes_pars_fragment>
  void main() {
    #include <clipping_planes_fragment>
    if (isCut && !gl_FrontFacing) { gl_FragColor = vec4(section, 1.0); return; }
    vec3 n = normalize(gl_FrontFacing ? direction : -direction);
    float light = 0.52 + 0.38 * max(dot(n, vec3(0.28, 0.55, 0.79)), 0.0) + 0.20 * max(dot(n, vec3(-0.70, -0.10, 0.71)), 0.0);
    vec3 colour = isColoured ? texture2D(palette, vec2(clamp(share, 0.002, 0.998), 0.5)).rgb : plain;
    if (isColoured && share > 0.05 && share < 1.0) {
      float tenths = share * 10.0;
      float line = abs(fract(tenths - 0.5) - 0.5) / max(fwidth(tenths), 1e-5);
      colour *= mix(0.72, 1.0, clamp(line, 0.0, 1.0));
    }
    gl_FragColor = vec4(colour * min(light, 1.06), 1.0);
  }`;

// Copies of vertices: corners whose triangles meet at less than the sharp angle share one.
function splitAtSharpEdges(vertices, triangles) {
  const count = triangles.length / 3;
  const normals = areaVectors(vertices, triangles, null, [new Float32Array(3 * count)])[0];
  const copiesOf = new Map();  // vertex: numbers of its copies
  const source = [], facing = [], corners = new Uint32Array(triangles.length);
  for (let t = 0; t < count; ++t) {
    const [x, y, z] = normals.subarray(3 * t, 3 * t + 3);
    const length = Math.hypot(x, y, z) || 1;
    for (let k = 3 * t; k < 3 * t + 3; ++k) {
      let copies = copiesOf.get(triangles[k]);
      if (!copies) copiesOf.set(triangles[k], copies = []);
      let copy = copies.find(c => (facing[c][0] * x + facing[c][1] * y + facing[c][2] * z) / length > SHARP);
      if (copy === undefined) {
        copy = source.length;
        source.push(triangles[k]);
        facing.push([x / length, y / length, z / length]);
        copies.push(copy);
      }
      corners[k] = copy;
    }
  }
  return {source: Uint32Array.from(source), corners};
}

// Twice the area vectors of all triangles by powers of the size of the motion; `moved` null: the constant term only.
function areaVectors(vertices, triangles, moved, terms) {
  const [constant, linear, square] = terms;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    for (let d = 0; d < 3; ++d) {
      const e = (d + 1) % 3, f = (d + 2) % 3;
      const pe = vertices[b + e] - vertices[a + e], pf = vertices[b + f] - vertices[a + f];
      const qe = vertices[c + e] - vertices[a + e], qf = vertices[c + f] - vertices[a + f];
      constant[t + d] = pe * qf - pf * qe;
      if (!moved) continue;
      const ue = moved[b + e] - moved[a + e], uf = moved[b + f] - moved[a + f];
      const ve = moved[c + e] - moved[a + e], vf = moved[c + f] - moved[a + f];
      linear[t + d] = ue * qf - uf * qe + pe * vf - pf * ve;
      square[t + d] = ue * vf - uf * ve;
    }
  }
  return terms;
}

function addedAtCorners(vectors, corners, count) {
  const sums = new Float32Array(3 * count);
  for (let k = 0; k < corners.length; ++k) {
    const from = 3 * Math.floor(k / 3), to = 3 * corners[k];
    for (let d = 0; d < 3; ++d) sums[to + d] += vectors[from + d];
  }
  return sums;
}

class Surface {
  constructor(vertices, triangles) {
    this.vertices = vertices;
    this.triangles = triangles;
    Object.assign(this, splitAtSharpEdges(vertices, triangles));
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(new THREE.BufferAttribute(this.corners, 1));
    this.set('position', this.atCopies(vertices, 3), 3);
    this.set('value', new Float32Array(this.source.length), 1);
    this.move(new Float32Array(vertices.length));
    this.material = new THREE.ShaderMaterial({
      vertexShader: VERTEX_SHADER, fragmentShader: FRAGMENT_SHADER, side: THREE.DoubleSide, clipping: true,
      extensions: {derivatives: true},
      uniforms: {size: {value: 0}, plain: {value: new THREE.Color()}, section: {value: new THREE.Color()},
        palette: {value: paletteTexture()}, isColoured: {value: false}, isCut: {value: false}}
    });
    this.mesh = new THREE.Mesh(this.geometry, this.material);
    this.mesh.frustumCulled = false;  // the motion may leave the box of the part
  }

  set(name, values, width) {
    this.geometry.setAttribute(name, new THREE.BufferAttribute(values, width));
  }

  atCopies(values, width) {
    const spread = new Float32Array(width * this.source.length);
    for (let k = 0; k < this.source.length; ++k)
      for (let d = 0; d < width; ++d) spread[width * k + d] = values[width * this.source[k] + d];
    return spread;
  }

  // Displacements (three for each vertex) of the motion of size 1.
  move(displacement) {
    const terms = [0, 1, 2].map(() => new Float32Array(this.triangles.length));
    areaVectors(this.vertices, this.triangles, displacement, terms);
    this.set('displacement', this.atCopies(displacement, 3), 3);
    ['normal', 'normal1', 'normal2'].forEach((name, power) =>
      this.set(name, addedAtCorners(terms[power], this.corners, this.source.length), 3));
  }

  // Values 0 … 1 at the vertices; null: one colour.
  colour(values) {
    this.material.uniforms.isColoured.value = Boolean(values);
    if (values) this.set('value', this.atCopies(values, 1), 1);
  }
}
