// The skin of a mesh: its regions, coloured by themselves or by a field.
const SKIN_VERTEX = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform float stretch;
in vec3 position, moved;
in float value, inner;
out vec3 inWorld, inView;
out vec3 inCorner;
out float inValue;
flat out float inTriangle;
void main() {
  inWorld = position + stretch * moved;
  vec4 view = viewMatrix * vec4(inWorld, 1.0);
  inView = view.xyz;
  inValue = value;
  int corner = gl_VertexID % 3;
  inCorner = vec3(corner == 0, corner == 1, corner == 2);
  // An edge that is none of an element's is nowhere near.
  if (inner > 0.5) inCorner[int(inner + 0.5) - 1] = 1.0;
  inTriangle = float(gl_VertexID / 3);
  gl_Position = projectionMatrix * view;
}`;

const SKIN_FRAGMENT = `
uniform vec3 base;
uniform float edges, colored, region, look;
uniform vec2 range;
uniform highp sampler2D scale;
in vec3 inCorner;
in float inValue;
flat in float inTriangle;
void main() {
  if (is_cut()) discard;
  if (picking == 1) { color = vec4(inWorld, region + 1.0); return; }
  if (picking == 2) { color = vec4(inValue, inTriangle, 0.0, 1.0); return; }
  vec3 normal = normalize(cross(dFdx(inView), dFdy(inView)));
  if (normal.z < 0.0) normal = -normal;
  vec3 own = base;
  if (colored > 0.5) {
    float share = range.y > range.x ? clamp((inValue - range.x) / (range.y - range.x), 0.0, 1.0) : 0.5;
    own = isnan(inValue) ? vec3(0.6) : texture(scale, vec2(share, 0.5)).rgb;
  }
  if (look < 0.4) own = mix(own, vec3(1.0, 0.86, 0.35), 0.4);
  else if (look < 0.8) own = mix(own, vec3(1.0), 0.25);
  vec3 result = as_srgb(shaded(own, normal) * (gl_FrontFacing ? 1.0 : 0.55));
  vec3 width = fwidth(inCorner);
  vec3 near = clamp(inCorner / max(1.2 * width, vec3(1e-4)), 0.0, 1.0);
  // Edges fade where triangles are smaller than a few pixels.
  float thin = clamp(1.6 - 4.0 * max(width.x, max(width.y, width.z)), 0.0, 1.0);
  float line = (1.0 - min(near.x, min(near.y, near.z))) * edges * thin;
  color = vec4(mix(result, result * 0.35, 0.75 * line), 1.0);
}`;

class SkinModel {
  constructor(data) {
    this.data = data;
    this.count = data.regions.length;
    this.names = data.regions.map((region) => region.name);
    this.visible = new Uint8Array(this.count).fill(1);
    this.points = numbers(Float32Array, data.points, 3 * data.point_count);
    this.corners = numbers(Uint32Array, data.triangles, 3 * data.triangle_count);
    this.regionOf = numbers(Uint32Array, data.region_of, data.triangle_count);
    this.fields = data.fields.map((field) => ({...field,
      values: numbers(Float32Array, field.values, field.components * (field.of_points ? data.point_count : data.triangle_count))}));
    this.group = new THREE.Group();
    this.uniforms = {stretch: {value: 0}, edges: {value: 1}, colored: {value: 0}, range: {value: new THREE.Vector2(0, 1)},
      scale: {value: this.makeScale()}};
    this.makeMeshes();
  }

  makeScale() {
    const bytes = new Uint8Array(4 * 256);
    for (let k = 0; k < 256; ++k) bytes.set([...scaleColor(k / 255).map(Math.round), 255], 4 * k);
    const texture = new THREE.DataTexture(bytes, 256, 1);
    texture.magFilter = texture.minFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
  }

  // One buffer of unshared corners, of which each region draws its range: triangles stand by region.
  makeMeshes() {
    const corners = this.corners, count = corners.length, positions = new Float32Array(3 * count);
    for (let k = 0; k < count; ++k)
      for (let axis = 0; axis < 3; ++axis) positions[3 * k + axis] = this.points[3 * corners[k] + axis];
    this.valueAttribute = new THREE.BufferAttribute(new Float32Array(count), 1);
    this.movedAttribute = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
    const position = new THREE.BufferAttribute(positions, 3), inner = new THREE.BufferAttribute(new Uint8Array(count), 1);
    numbers(Uint8Array, this.data.inner, count / 3).forEach((corner, k) => inner.array.fill(corner, 3 * k, 3 * k + 3));
    this.boxes = this.names.map(() => new THREE.Box3());
    this.ranges = this.names.map(() => [Infinity, -Infinity]);
    for (let triangle = 0; triangle < this.regionOf.length; ++triangle) {
      const range = this.ranges[this.regionOf[triangle]];
      range[0] = Math.min(range[0], triangle);
      range[1] = Math.max(range[1], triangle + 1);
    }
    this.meshes = this.names.map((_, region) => {
      const [first, last] = this.ranges[region];
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', position);
      geometry.setAttribute('inner', inner);
      geometry.setAttribute('value', this.valueAttribute);
      geometry.setAttribute('moved', this.movedAttribute);
      if (last > first) geometry.setDrawRange(3 * first, 3 * (last - first));
      else geometry.setDrawRange(0, 0);
      for (let k = 3 * first; k < 3 * last; ++k) this.boxes[region].expandByPoint(new THREE.Vector3().fromArray(positions, 3 * k));
      const mesh = new THREE.Mesh(geometry, material(SKIN_VERTEX, SKIN_FRAGMENT, {...this.uniforms,
        base: {value: new THREE.Color().setRGB(...this.colorOf(region).map((part) => part / 255))},
        region: {value: region}, look: {value: 1}}));
      mesh.frustumCulled = false;
      this.group.add(mesh);
      return mesh;
    });
  }

  colorOf(region) { return this.data.regions[region].color; }
  boxOf(region) { return this.boxes[region].clone(); }
  role(region) { return this.data.regions[region].matrix ? 'matrix' : 'region'; }
  groups() {
    const found = new Map();
    this.names.forEach((_, region) => {
      const role = this.role(region);
      found.set(role, [...(found.get(role) ?? []), region]);
    });
    return [...found.entries()];
  }
  describe(region) { return `${this.names[region]}: ${countText(this.data.regions[region].elements, 'element')}`; }

  mark(which, region) {
    if (this[which] === region) return false;
    this[which] = region;
    this.meshes.forEach((mesh, k) => {
      mesh.material.uniforms.look.value = k === this.selected ? 0.2 : k === this.pointed ? 0.6 : 1;
    });
    return true;
  }

  choose() {
    this.meshes.forEach((mesh, region) => { mesh.visible = Boolean(this.visible[region]); });
    this.triangles = this.regionOf.length;
  }

  // `component`: a number, or 'size' of a vector. Returns the range.
  showField(field, component) {
    this.field = field;
    this.uniforms.colored.value = field ? 1 : 0;
    if (!field) return undefined;
    const n = field.components, values = field.values;
    // Of six numbers of a symmetric tensor (xx yy zz xy yz zx) the size is von Mises's.
    const of = (k) => {
      const v = values.subarray(n * k, n * k + n);
      if (component !== 'size' || n === 1) return v[component === 'size' ? 0 : component];
      if (n === 6) return Math.sqrt(0.5 * ((v[0] - v[1]) ** 2 + (v[1] - v[2]) ** 2 + (v[2] - v[0]) ** 2) + 3 * (v[3] ** 2 + v[4] ** 2 + v[5] ** 2));
      return Math.hypot(...v);
    };
    const to = this.valueAttribute.array;
    let low = Infinity, high = -Infinity;
    for (let k = 0; k < to.length; ++k) {
      const value = to[k] = of(field.of_points ? this.corners[k] : Math.floor(k / 3));
      if (value < low) low = value;
      if (value > high) high = value;
    }
    this.valueAttribute.needsUpdate = true;
    this.uniforms.range.value.set(low, high);
    return [low, high];
  }

  // Moves the points by a field of vectors times a factor.
  deform(field, factor) {
    if (field && this.movedBy !== field) {
      this.movedBy = field;
      const to = this.movedAttribute.array;
      for (let k = 0; k < this.corners.length; ++k) to.set(field.values.subarray(3 * this.corners[k], 3 * this.corners[k] + 3), 3 * k);
      this.movedAttribute.needsUpdate = true;
    }
    this.uniforms.stretch.value = field ? factor : 0;
  }
}
