// The eye: it looks at a target from a distance, turned about the vertical and tilted. Pointer, wheel, touch and keys move it.
class Eye extends EventTarget {
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.perspective = new THREE.PerspectiveCamera(28, 1, 0.1, 10);
    this.flat = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
    for (const camera of [this.perspective, this.flat]) camera.matrixAutoUpdate = false;
    this.parallel = false;
    this.target = new THREE.Vector3();
    this.distance = 1;
    this.turn = 0;  // radians about z; 0: the eye is in front, at -y
    this.tilt = 0;  // radians above the horizontal
    this.moving = false;
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', (event) => this.press(event));
    canvas.addEventListener('pointermove', (event) => this.drag(event));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => this.release(event));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  get camera() { return this.parallel ? this.flat : this.perspective; }

  static views = {
    top: [0, Math.PI / 2], bottom: [Math.PI, -Math.PI / 2], front: [0, 0], back: [Math.PI, 0], side: [Math.PI / 2, 0],
    iso: [0.7, 0.75],
  };

  // Right, up and toward the eye.
  axes() {
    const [ct, st, cf, sf] = [Math.cos(this.turn), Math.sin(this.turn), Math.cos(this.tilt), Math.sin(this.tilt)];
    const toward = new THREE.Vector3(cf * st, -cf * ct, sf);
    const right = new THREE.Vector3(ct, st, 0);
    return {right, up: toward.clone().cross(right), toward};
  }

  // Brings the cameras where the eye is; `box` is what has to lie between near and far.
  place(width, height, box) {
    const {right, up, toward} = this.axes();
    const position = this.target.clone().addScaledVector(toward, this.distance);
    const middle = box.getCenter(new THREE.Vector3()), radius = box.getSize(new THREE.Vector3()).length() / 2 || 1;
    const depth = position.clone().sub(middle).dot(toward);
    const far = Math.max(depth + 1.4 * radius, this.distance * 1e-2);
    const aspect = width / height;
    Object.assign(this.perspective, {aspect, far, near: Math.max(depth - 1.4 * radius, far * 1e-4)});
    const half = this.distance * Math.tan(THREE.MathUtils.degToRad(this.perspective.fov / 2));
    Object.assign(this.flat, {top: half, bottom: -half, left: -half * aspect, right: half * aspect, near: depth - 1.4 * radius, far});
    for (const camera of [this.perspective, this.flat]) {
      camera.matrix.makeBasis(right, up, toward).setPosition(position);
      camera.matrixWorldNeedsUpdate = true;
      camera.updateMatrixWorld(true);
      camera.updateProjectionMatrix();
    }
    this.width = width;
    this.height = height;
  }

  // Pixels (of CSS) of a unit length at a distance from the eye.
  pixelsPerUnit(distance = this.distance) {
    return this.height / (2 * Math.tan(THREE.MathUtils.degToRad(this.perspective.fov / 2)) * (this.parallel ? this.distance : distance));
  }

  changed() { this.dispatchEvent(new Event('change')); }
  // The same for a step of many, such as of a wheel: it moves until nothing has come for a while.
  stepped() {
    this.moving = true;
    document.getElementById('keys').classList.add('unseen');  // who moves it knows how
    clearTimeout(this.resting);
    this.resting = setTimeout(() => {
      this.moving = this.pointers.size > 0;
      this.changed();
    }, 160);
    this.changed();
  }

  // Goes there, in a quarter of a second, or at once where that is preferred.
  go({target = this.target, distance = this.distance, turn = this.turn, tilt = this.tilt}, still = PREFERS_STILL.matches) {
    cancelAnimationFrame(this.frame);
    // The shorter way round.
    const from = {target: this.target.clone(), distance: this.distance, turn: this.turn, tilt: this.tilt};
    from.turn += 2 * Math.PI * Math.round((turn - from.turn) / (2 * Math.PI));
    const begin = performance.now();
    const step = (now) => {
      const share = still ? 1 : Math.min(1, (now - begin) / 260), s = share * share * (3 - 2 * share);
      this.target.lerpVectors(from.target, target, s);
      this.distance = from.distance * (distance / from.distance) ** s;
      this.turn = from.turn + s * (turn - from.turn);
      this.tilt = from.tilt + s * (tilt - from.tilt);
      this.moving = share < 1;
      if (share < 1) this.frame = requestAnimationFrame(step);
      this.changed();
    };
    step(begin);
  }

  // So that the box fills the picture.
  fit(box, angles = {}, still = undefined) {
    const seen = Object.assign(Object.create(Eye.prototype), {turn: angles.turn ?? this.turn, tilt: angles.tilt ?? this.tilt});
    const {right, up, toward} = seen.axes();
    const half = box.getSize(new THREE.Vector3()).multiplyScalar(0.5);
    const tan = Math.tan(THREE.MathUtils.degToRad(this.perspective.fov / 2)) / 1.1, aspect = this.width / this.height || 1;
    let distance = 1e-9;
    for (let corner = 0; corner < 8; ++corner) {
      const place = half.clone().multiply(new THREE.Vector3(...[1, 2, 4].map((bit) => corner & bit ? 1 : -1)));
      distance = Math.max(distance, place.dot(toward) + Math.max(Math.abs(place.dot(up)), Math.abs(place.dot(right)) / aspect) / tan);
    }
    this.go({target: box.getCenter(new THREE.Vector3()), distance, ...angles}, still);
  }

  look(view, box) {
    const [turn, tilt] = Eye.views[view];
    this.fit(box, {turn, tilt});
  }

  rotate(dx, dy) {
    this.turn -= dx * 0.008;
    this.tilt = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.tilt + dy * 0.008));
    this.stepped();
  }
  pan(dx, dy) {
    const {right, up} = this.axes(), unit = 1 / this.pixelsPerUnit();
    this.target.addScaledVector(right, -dx * unit).addScaledVector(up, dy * unit);
    this.stepped();
  }
  // What is under (x, y), pixels from the middle, stays there.
  zoom(factor, x = 0, y = 0) {
    const {right, up} = this.axes(), unit = (1 - factor) / this.pixelsPerUnit();
    this.target.addScaledVector(right, x * unit).addScaledVector(up, -y * unit);
    this.distance *= factor;
    this.stepped();
  }

  fromMiddle(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.travelled = 0;
  }
  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before[0], dy = event.clientY - before[1];
    this.travelled += Math.hypot(dx, dy);
    if (this.travelled < 3) return;
    this.moving = true;
    this.canvas.classList.add('turning');
    if (this.pointers.size === 2) {
      const other = [...this.pointers.entries()].find(([id]) => id !== event.pointerId)[1];
      const distance = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      this.zoom(distance(before) / (distance([event.clientX, event.clientY]) || 1), ...this.fromMiddle(event));
      this.pan(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons & 6) {
      this.pan(dx, dy);
    } else {
      this.rotate(dx, dy);
    }
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
  }
  release(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (event.type === 'pointerup' && this.travelled < 3 && event.button === 0)
      this.dispatchEvent(new CustomEvent('pick', {detail: event}));
    if (this.pointers.size > 0) return;
    this.moving = false;
    this.canvas.classList.remove('turning');
    this.changed();
  }
  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    this.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY * lines * 0.0015))), ...this.fromMiddle(event));
  }
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    if (step && event.shiftKey) this.pan(-40 * step[0], -40 * step[1]);
    else if (step) this.rotate(16 * step[0], 16 * step[1]);
    else if (event.key === '+' || event.key === '=') this.zoom(0.85);
    else if (event.key === '-' || event.key === '−') this.zoom(1 / 0.85);
    else return;
    event.preventDefault();
  }
}
