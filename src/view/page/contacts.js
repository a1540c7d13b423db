// Overlaps and near contacts: marks in the picture, as large at every distance.
const CONTACT_KINDS = {
  overlaps: {noun: 'overlap', color: [0.86, 0.1, 0.55], word: 'deep', style: 'overlap'},
  near: {noun: 'near contact', color: [0.95, 0.66, 0.1], word: 'apart', style: 'near'},
};

const MARK_VERTEX = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform float size;
in vec3 position;
out vec3 inWorld, inView;
void main() {
  inWorld = position;
  inView = (viewMatrix * vec4(position, 1.0)).xyz;
  gl_Position = projectionMatrix * vec4(inView, 1.0);
  gl_PointSize = size;
}`;
const MARK_FRAGMENT = `
uniform vec3 tint;
uniform float size, strength;
void main() {
  if (picking != 0 || is_cut()) discard;
  float radius = length(gl_PointCoord - 0.5) * size;
  float whole = smoothstep(0.5 * size, 0.5 * size - 1.2, radius);
  float rim = smoothstep(0.5 * size - 3.0, 0.5 * size - 1.8, radius);
  if (whole <= 0.0) discard;
  float alpha = whole * strength;
  color = vec4(mix(tint, vec3(1.0), 0.85 * rim) * alpha, alpha);
}`;

class Marks {
  constructor(kind, rows) {
    this.group = new THREE.Group();
    const points = new Float32Array(3 * rows.length);
    rows.forEach((row, k) => points.set(Marks.place(row).toArray(), 3 * k));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    // Through what is before them they are seen faintly.
    for (const [depthFunc, strength] of [[THREE.AlwaysDepth, 0.7], [THREE.LessEqualDepth, 1]]) {
      const marks = new THREE.Points(geometry, material(MARK_VERTEX, MARK_FRAGMENT, {
        tint: {value: new THREE.Vector3(...CONTACT_KINDS[kind].color)}, strength: {value: strength},
        size: {value: 11 * Math.min(2, window.devicePixelRatio || 1)}},
        {transparent: true, premultipliedAlpha: true, depthWrite: false, depthFunc,
          blending: THREE.CustomBlending, blendSrc: THREE.OneFactor, blendDst: THREE.OneMinusSrcAlphaFactor}));
      marks.frustumCulled = false;
      this.group.add(marks);
    }
  }
  static place(row) { return new THREE.Vector3(row[3], row[4], row[5]).sub(CENTRE); }
}
