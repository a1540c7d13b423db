// Yarns: each shape once, in parts and levels of detail; what is drawn of them is chosen by distance, copy by copy.

// What a copy is, for the shader: four texels of the motion, and one of colour and state.
const YARNS_A_ROW = 1024;

const YARN_HEAD = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform highp sampler2D motions;
uniform sampler2D looks;
in float yarn;
out vec3 inWorld, inView;
flat out vec4 inLook;
flat out float inYarn;
mat4 motion_of(int k) {
  ivec2 at = ivec2(3 * (k % ${YARNS_A_ROW}), k / ${YARNS_A_ROW});
  vec4 x = texelFetch(motions, at, 0), y = texelFetch(motions, at + ivec2(1, 0), 0), z = texelFetch(motions, at + ivec2(2, 0), 0);
  return transpose(mat4(x, y, z, vec4(0, 0, 0, 1)));
}
vec4 look_of(int k) { return texelFetch(looks, ivec2(k % ${YARNS_A_ROW}, k / ${YARNS_A_ROW}), 0); }
`;

const TUBE_VERTEX = `${YARN_HEAD}
uniform vec3 origin;
uniform float step;
in vec3 position, normal;
in float fibre;
out vec3 inNormal;
out float inFibre;
void main() {
  inFibre = fibre;
  int k = int(yarn + 0.5);
  mat4 motion = motion_of(k);
  vec4 world = motion * vec4((origin + position) * step, 1.0);
  vec4 view = viewMatrix * world;
  inNormal = mat3(viewMatrix) * mat3(motion) * normal;
  inWorld = world.xyz;
  inView = view.xyz;
  inLook = look_of(k);
  inYarn = yarn;
  gl_Position = projectionMatrix * view;
}`;

// A strip that faces the eye, as wide as the elliptic section looks from there, and a pixel at least.
const RIBBON_VERTEX = `${YARN_HEAD}
uniform float pixel;
uniform float parallel;
in vec3 position, across, up;
in float side;
out vec3 inNormal;
out vec3 inSide;
out float inShare;
void main() {
  int k = int(yarn + 0.5);
  mat4 motion = motion_of(k);
  vec4 view = viewMatrix * (motion * vec4(position, 1.0));
  mat3 turn = mat3(viewMatrix) * mat3(motion);
  vec3 a = turn * across, u = turn * up;
  vec3 eye = parallel > 0.5 ? vec3(0, 0, 1) : normalize(-view.xyz);
  vec3 beside = cross(cross(a, u), eye);
  float size = length(beside);
  beside = size > 1e-20 ? beside / size : normalize(a);
  float reach = sqrt(dot(beside, a) * dot(beside, a) + dot(beside, u) * dot(beside, u));
  float least = 0.55 * pixel * (parallel > 0.5 ? 1.0 : -view.z);
  view.xyz += side * max(reach, least) * beside;
  inSide = beside;
  inNormal = eye;
  inShare = side;
  inView = view.xyz;
  // The view is turned and moved only.
  inWorld = transpose(mat3(viewMatrix)) * (view.xyz - viewMatrix[3].xyz);
  inLook = look_of(k);
  inYarn = yarn;
  gl_Position = projectionMatrix * view;
}`;

// The alpha of a look: 255 as it is, 128 pointed at, 64 chosen.
const YARN_FRAGMENT = `
flat in vec4 inLook;
flat in float inYarn;
uniform vec3 eyePosition;
void show(vec3 normal, bool inside, float shade) {
  if (is_cut()) discard;
  bool fills = inside && dot(plane.xyz, plane.xyz) > 0.0;
  if (picking == 1) {
    color = vec4(fills ? on_section(eyePosition) : inWorld, inYarn + 1.0);
    return;
  }
  vec3 base = inLook.rgb * shade;
  if (inLook.a < 0.4) base = mix(base, vec3(1.0, 0.86, 0.35), 0.55);
  else if (inLook.a < 0.8) base = mix(base, vec3(1.0), 0.28);
  if (fills) {
    // The section is flat and hatched.
    float line = smoothstep(0.35, 0.65, abs(fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0) - 0.5) * 2.0);
    color = vec4(mix(base * 0.82, mix(base, vec3(1.0), 0.35), line), 1.0);
    return;
  }
  color = vec4(as_srgb(shaded(base, inside ? -normal : normal) * (inside ? 0.45 : 1.0)), 1.0);
}
`;
const TUBE_FRAGMENT = `${YARN_FRAGMENT}
uniform float fibres;
in vec3 inNormal;
in float inFibre;
void main() {
  // Stripes where they are wide enough to see.
  float phase = inFibre * fibres, width = fwidth(phase);
  float depth = fibres > 0.0 ? 0.2 * (1.0 - smoothstep(0.2, 0.5, width)) : 0.0;
  show(normalize(inNormal), !gl_FrontFacing, 1.0 - depth * (0.5 + 0.5 * cos(6.2831853 * phase)));
}`;
const RIBBON_FRAGMENT = `${YARN_FRAGMENT}
in vec3 inNormal, inSide;
in float inShare;
void main() { show(normalize(inShare * inSide + sqrt(max(0.0, 1.0 - inShare * inShare)) * inNormal), false, 1.0); }`;

// The grid's triangles, counter-clockwise from outside, and the fans of its ends.
function tubeIndex(rows, columns, hasStart, hasEnd) {
  const index = [];
  for (let row = 0; row + 1 < rows; ++row)
    for (let column = 0; column + 1 < columns; ++column) {
      const a = row * columns + column, d = a + columns;
      index.push(a, a + 1, d + 1, a, d + 1, d);
    }
  let first = rows * columns;
  for (const [has, last] of [[hasStart, false], [hasEnd, true]]) {
    if (!has) continue;
    for (let column = 0; column + 1 < columns; ++column) {
      const rim = last ? [first + column, first + column + 1] : [first + column + 1, first + column];
      index.push(first + columns, ...rim);
    }
    first += columns + 1;
  }
  return {index, count: first};
}

class Yarns {
  constructor(data) {
    const count = this.count = data.count;
    this.names = data.names;
    this.threads = data.threads;
    this.roleNames = data.roles;
    this.roleColors = data.role_colors;
    this.motions = numbers(Float32Array, data.motions, 12 * count);
    this.measures = numbers(Float32Array, data.measures, 2 * count);
    this.shapeOf = numbers(Uint32Array, data.shape_of, count);
    this.threadOf = numbers(Uint32Array, data.thread_of, count);
    this.ownLooks = numbers(Uint8Array, data.looks, 4 * count);
    this.visible = new Uint8Array(count).fill(1);
    this.group = new THREE.Group();
    this.uniforms = {eyePosition: {value: new THREE.Vector3()}, ...this.makeTextures()};
    this.paint('role');
    this.shapes = DATA.shapes.map((shape, k) => this.makeShape(shape, k));
    for (let yarn = 0; yarn < count; ++yarn) this.shapes[this.shapeOf[yarn]].copies.push(yarn);
    this.placed = new Map();  // boxes of parts of yarns, as they were asked for
  }

  role(yarn) { return this.roleNames[this.ownLooks[4 * yarn + 3]]; }
  isSelected(yarn) { return this.selected === yarn; }

  makeTextures() {
    const rows = Math.max(1, Math.ceil(this.count / YARNS_A_ROW));
    const motions = new Float32Array(4 * 3 * YARNS_A_ROW * rows);
    motions.set(this.motions);
    this.lookBytes = new Uint8Array(4 * YARNS_A_ROW * rows);
    const texture = (bytes, width, type) => {
      const made = new THREE.DataTexture(bytes, width, rows, THREE.RGBAFormat, type);
      made.needsUpdate = true;
      return made;
    };
    this.lookTexture = texture(this.lookBytes, YARNS_A_ROW, THREE.UnsignedByteType);
    return {motions: {value: texture(motions, 3 * YARNS_A_ROW, THREE.FloatType)}, looks: {value: this.lookTexture}};
  }

  // By role, as the file has it, or each its own.
  colorOf(yarn, way = this.way) {
    const own = [...this.ownLooks.subarray(4 * yarn, 4 * yarn + 3)];
    if (way === 'file') return own;
    if (way === 'each') return hueColor(yarn);
    return this.roleColors[this.ownLooks[4 * yarn + 3]][yarn % 2];
  }
  paint(way = this.way) {
    this.way = way;
    for (let yarn = 0; yarn < this.count; ++yarn) {
      this.lookBytes.set(this.colorOf(yarn), 4 * yarn);
      this.lookBytes[4 * yarn + 3] = this.selected === yarn ? 64 : this.pointed === yarn ? 128 : 255;
    }
    this.lookTexture.needsUpdate = true;
  }
  mark(which, yarn) {
    if (this[which] === yarn) return false;
    this[which] = yarn;
    this.paint();
    return true;
  }

  makeShape(data, number) {
    const boxes = data.boxes.map(([low, high]) => new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high)));
    const box = boxes.reduce((all, one) => all.union(one), new THREE.Box3());
    return {...data, number, boxes, box, copies: [], meshes: new Map(), spheres: boxes.map((one) => one.getBoundingSphere(new THREE.Sphere()))};
  }

  // The mesh of a part at a level, made when it is first needed.
  meshOf(shape, level, part) {
    const key = level * shape.boxes.length + part;
    const known = shape.meshes.get(key);
    if (known) return known;
    const description = shape.levels[level];
    const {geometry, made} = description.tube ? this.makeTube(shape, description, part) : this.makeRibbon(description, part);
    geometry.setAttribute('yarn', new THREE.InstancedBufferAttribute(new Float32Array(shape.copies.length), 1).setUsage(THREE.DynamicDrawUsage));
    const mesh = new THREE.Mesh(geometry, made);
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    this.group.add(mesh);
    shape.meshes.set(key, mesh);
    return mesh;
  }
  makeTube(shape, level, part) {
    const [at, rows, hasStart, hasEnd, ...origin] = level.parts[part];
    const {index, count} = tubeIndex(rows, level.columns, hasStart, hasEnd);
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(numbers(Uint16Array, at, 3 * count), 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(numbers(Int8Array, at + 6 * count, 3 * count), 3, true));
    // Of a yarn without twist all are 0, and so are those of ends.
    const fibre = new Float32Array(count);
    if (shape.twisted) {
      const along = numbers(Float32Array, at + 9 * count, rows);
      for (let k = 0; k < rows * level.columns; ++k) fibre[k] = level.around[k % level.columns] - along[Math.floor(k / level.columns)];
    }
    geometry.setAttribute('fibre', new THREE.BufferAttribute(fibre, 1));
    geometry.setIndex(index);
    return {geometry, made: material(TUBE_VERTEX, TUBE_FRAGMENT, {...this.uniforms, origin: {value: new THREE.Vector3(...origin)},
      step: {value: shape.step}, fibres: {value: shape.twisted ? 8 : 0}})};
  }
  makeRibbon(level, part) {
    const [at, rows] = level.parts[part];
    const values = numbers(Float32Array, at, 9 * rows), twice = new Float32Array(20 * rows), index = [];
    for (let row = 0; row < rows; ++row) {
      for (const [k, side] of [[0, -1], [1, 1]]) {
        twice.set(values.subarray(9 * row, 9 * row + 9), 10 * (2 * row + k));
        twice[10 * (2 * row + k) + 9] = side;
      }
      if (row + 1 < rows) index.push(2 * row, 2 * row + 1, 2 * row + 3, 2 * row, 2 * row + 3, 2 * row + 2);
    }
    const all = new THREE.InterleavedBuffer(twice, 10), geometry = new THREE.InstancedBufferGeometry();
    for (const [name, size, offset] of [['position', 3, 0], ['across', 3, 3], ['up', 3, 6], ['side', 1, 9]])
      geometry.setAttribute(name, new THREE.InterleavedBufferAttribute(all, size, offset));
    geometry.setIndex(index);
    this.ribbon ??= material(RIBBON_VERTEX, RIBBON_FRAGMENT, this.uniforms);
    return {geometry, made: this.ribbon};
  }

  // The coarsest level whose error cannot be seen: ribbons only where the yarn is thin on the screen.
  levelFor(shape, pixels, patience) {
    const {levels} = shape, allowed = 0.6 * patience / pixels;
    for (let level = levels.length - 1; level > 0; --level) {
      if (!levels[level].tube && shape.thickness * pixels > 3.5 * patience) continue;
      if (levels[level].chord <= allowed) return level;
    }
    return 0;
  }

  // Chooses for each part of each yarn what is drawn of it. `patience` above 1: coarser, while things move.
  choose(eye, patience) {
    const camera = eye.camera, view = camera.matrixWorldInverse.elements;
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const planes = frustum.planes.map(({normal, constant}) => [normal.x, normal.y, normal.z, constant]);
    const perUnit = eye.pixelsPerUnit(1);
    this.uniforms.eyePosition.value.copy(eye.parallel ? eye.axes().toward : camera.position.setFromMatrixPosition(camera.matrixWorld));
    this.triangles = 0;
    const m = this.motions;
    for (const shape of this.shapes) {
      for (const mesh of shape.meshes.values()) mesh.geometry.instanceCount = 0;
      for (let part = 0; part < shape.boxes.length; ++part) {
        const {center: {x, y, z}, radius} = shape.spheres[part];
        for (const yarn of shape.copies) {
          if (!this.visible[yarn]) continue;
          const k = 12 * yarn;
          const px = m[k] * x + m[k + 1] * y + m[k + 2] * z + m[k + 3];
          const py = m[k + 4] * x + m[k + 5] * y + m[k + 6] * z + m[k + 7];
          const pz = m[k + 8] * x + m[k + 9] * y + m[k + 10] * z + m[k + 11];
          if (planes.some((plane) => plane[0] * px + plane[1] * py + plane[2] * pz + plane[3] < -radius)) continue;
          // The nearest point of the part decides.
          const depth = -(view[2] * px + view[6] * py + view[10] * pz + view[14]);
          const pixels = eye.parallel ? perUnit : perUnit / Math.max(depth - radius, camera.near);
          const {geometry} = this.meshOf(shape, this.levelFor(shape, pixels, patience), part);
          geometry.attributes.yarn.array[geometry.instanceCount === Infinity ? (geometry.instanceCount = 0) : geometry.instanceCount] = yarn;
          ++geometry.instanceCount;
        }
      }
      for (const mesh of shape.meshes.values()) {
        const {geometry} = mesh;
        mesh.visible = geometry.instanceCount > 0;
        if (!mesh.visible) continue;
        this.triangles += geometry.instanceCount * geometry.index.count / 3;
        geometry.attributes.yarn.needsUpdate = true;
      }
    }
  }

  boxOf(yarn) {
    const motion = new THREE.Matrix4().fromArray([...this.motions.subarray(12 * yarn, 12 * yarn + 12), 0, 0, 0, 1]).transpose();
    return this.shapes[this.shapeOf[yarn]].box.clone().applyMatrix4(motion);
  }

  // What the page lists: [key, what it is called, colour, its yarns].
  groups() {
    const found = new Map();
    for (let yarn = 0; yarn < this.count; ++yarn) {
      const role = this.role(yarn);
      if (!found.has(role)) found.set(role, []);
      found.get(role).push(yarn);
    }
    return [...found.entries()];
  }
  describe(yarn) {
    const thread = this.threads[this.threadOf[yarn]];
    return `${this.names[yarn]}${thread ? `, of ${thread}` : ''}: ${this.role(yarn)}, ${lengthText(this.measures[2 * yarn])} long`;
  }
}
