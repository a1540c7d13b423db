// Colours, and how things are shaded.
// Of yarns one by one: hues a golden section of the circle apart.
function hueColor(index) {
  const color = new THREE.Color().setHSL((0.55 + index * 0.618034) % 1, 0.42, 0.48, THREE.SRGBColorSpace);
  return color.getHexString(THREE.SRGBColorSpace).match(/../g).map((pair) => parseInt(pair, 16));
}
const cssColor = (rgb) => `rgb(${rgb.map(Math.round).join(' ')})`;

// Of fields' values: colours that are mixed between (src/view/color_scale.h).
const SCALE = DATA.skin?.scale ?? [[0, 0, 0], [255, 255, 255]];
function scaleColor(share) {
  const at = Math.min(1, Math.max(0, share)) * (SCALE.length - 1), k = Math.min(SCALE.length - 2, Math.floor(at));
  return SCALE[k].map((from, part) => from + (at - k) * (SCALE[k + 1][part] - from));
}

// Of everything that is drawn; the values are shared.
const SHARED = {
  plane: {value: new THREE.Vector4(0, 0, 0, 0)},  // what has plane.xyz . point > plane.w is cut away; 0 0 0: nothing
  picking: {value: 0},
  depths: {value: new THREE.Vector2(0, 1)},  // of what is shown, from the eye: the farther, the darker
  pixel: {value: 1},                         // a CSS pixel on the target, in clip space at distance 1
  parallel: {value: 0},
};

const FRAGMENT_HEAD = `
precision highp float;
uniform highp mat4 viewMatrix;
uniform vec4 plane;
uniform int picking;
uniform vec2 depths;
uniform float parallel;
in vec3 inWorld, inView;
out highp vec4 color;

bool is_cut() { return dot(plane.xyz, inWorld) > plane.w; }

// Where the line of sight meets the plane of the section: what is seen through a cut is filled there.
vec3 on_section(vec3 eye) {
  vec3 way = parallel > 0.5 ? eye : inWorld - eye;
  float along = dot(plane.xyz, way);
  return abs(along) < 1e-12 ? inWorld : inWorld + (plane.w - dot(plane.xyz, inWorld)) / along * way;
}

vec3 shaded(vec3 base, vec3 normal) {
  vec3 light = pow(base, vec3(2.2));
  vec3 eye = parallel > 0.5 ? vec3(0, 0, 1) : normalize(-inView);
  float sky = 0.5 + 0.5 * normal.y;
  float key = max(0.0, dot(normal, normalize(vec3(-0.45, 0.6, 0.75))));
  float rim = pow(1.0 - max(0.0, dot(normal, eye)), 3.0);
  float gloss = pow(max(0.0, dot(normal, normalize(normalize(vec3(-0.45, 0.6, 0.75)) + eye))), 28.0);
  float depth = clamp((-inView.z - depths.x) / max(1e-12, depths.y - depths.x), 0.0, 1.0);
  vec3 result = light * (0.26 + 0.22 * sky + 0.72 * key) * (1.0 - 0.3 * rim) + 0.05 * gloss;
  return result * mix(1.08, 0.62, depth);
}
vec3 as_srgb(vec3 light) { return pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2)); }
`;

function material(vertex, fragment, uniforms, more = {}) {
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: vertex, fragmentShader: FRAGMENT_HEAD + fragment,
    uniforms: {...SHARED, ...uniforms}, side: THREE.DoubleSide, ...more,
  });
}
