// The canvas: what is drawn, when, and how fine.
class Scene {
  constructor(canvas, model) {
    this.canvas = canvas;
    this.model = model;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, powerPreference: 'high-performance'});
    this.renderer.setClearColor(0x000000, 0);
    this.scene = new THREE.Scene();
    this.scene.matrixWorldAutoUpdate = false;
    this.scene.add(model.group);
    this.eye = new Eye(canvas);
    this.eye.addEventListener('change', () => this.invalidate());
    this.patience = 1;  // how much coarser what moves is, so that it moves smoothly
    this.watchers = [];
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.width = width;
    this.height = height;
    this.eye.width = width;
    this.eye.height = height;
    this.invalidate();
  }

  // Draws at the next frame, once, however many ask.
  invalidate() {
    if (this.asked) return;
    this.asked = requestAnimationFrame((now) => {
      this.asked = 0;
      this.draw(now);
    });
  }

  draw(now) {
    const {eye} = this;
    eye.place(this.width, this.height, BOX);
    const still = !eye.moving;
    // Frames that follow each other tell how much may be drawn.
    if (!still && this.last && now - this.last < 1000) {
      const took = now - this.last;
      if (took > 45) this.patience = Math.min(16, this.patience * 1.35);
      else if (took < 22) this.patience = Math.max(1, this.patience / 1.1);
    }
    this.last = still ? 0 : now;
    const {toward} = eye.axes(), position = new THREE.Vector3().setFromMatrixPosition(eye.camera.matrixWorld);
    const half = BOX.getSize(new THREE.Vector3()).multiplyScalar(0.5);
    const reach = Math.abs(toward.x) * half.x + Math.abs(toward.y) * half.y + Math.abs(toward.z) * half.z;
    const depth = position.sub(BOX.getCenter(new THREE.Vector3())).dot(toward);
    SHARED.depths.value.set(depth - reach, depth + reach);
    SHARED.pixel.value = (eye.parallel ? eye.distance : 1) * 2 * Math.tan(THREE.MathUtils.degToRad(eye.perspective.fov / 2)) / this.height;
    SHARED.parallel.value = eye.parallel ? 1 : 0;
    // However much there is, no more is drawn than a usual machine can.
    for (let patience = still ? 1 : this.patience; ; patience *= 2) {
      this.model.choose(eye, patience);
      if (this.model.triangles < 1e7 || patience > 8) break;
    }
    this.renderer.render(this.scene, eye.camera);
    for (const watcher of this.watchers) watcher(eye);
  }

  // Pixels (of CSS) of a point; `front`: it is before the eye.
  project(point) {
    const at = point.clone().project(this.eye.camera);
    return {x: (at.x + 1) * this.width / 2, y: (1 - at.y) * this.height / 2, front: at.z > -1 && at.z < 1};
  }

  // What is at a pixel: the number of the yarn or region, and the point; nothing where nothing is.
  pick(x, y, again = 0) {
    const {renderer, eye: {camera}} = this;
    if (!renderer.extensions.has('EXT_color_buffer_float')) return undefined;
    this.target ??= new THREE.WebGLRenderTarget(1, 1, {type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter});
    const read = (mode) => {
      SHARED.picking.value = mode;
      renderer.setRenderTarget(this.target);
      renderer.clear();
      renderer.render(this.model.group, camera);
      renderer.setRenderTarget(null);
      const values = new Float32Array(4);
      renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, values);
      return values;
    };
    camera.setViewOffset(this.width, this.height, x - 0.5, y - 0.5, 1, 1);
    const [px, py, pz, number] = read(1);
    const more = again && number > 0 ? read(again) : undefined;
    camera.clearViewOffset();
    SHARED.picking.value = 0;
    if (!(number > 0)) return undefined;
    return {index: Math.round(number) - 1, point: new THREE.Vector3(px, py, pz), value: more?.[0]};
  }

  // Cuts away what is beyond a place along an axis (or, turned, before it); nothing: all is whole.
  cut(axis, place, turned) {
    const normal = axis === undefined ? [0, 0, 0] : [0, 1, 2].map((k) => k === axis ? turned ? -1 : 1 : 0);
    SHARED.plane.value.set(...normal, turned ? -place : place);
    this.invalidate();
  }
}
