// What is under the pointer, and how far two points are from each other.
class Measure {
  constructor(scene, model) {
    this.scene = scene;
    this.model = model;
    this.readout = document.getElementById('readout');
    this.overlay = document.getElementById('overlay');
    this.points = [];
    this.on = false;
    const {canvas, eye} = scene;
    canvas.addEventListener('pointermove', (event) => {
      this.pointer = event.buttons ? undefined : [event.offsetX, event.offsetY];
      if (this.pointer && event.pointerType !== 'touch') this.ask();
    });
    canvas.addEventListener('pointerleave', () => this.leave());
    eye.addEventListener('pick', ({detail}) => this.take(...this.inCanvas(detail)));
    canvas.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' || event.key === ' ') {
        this.take(scene.width / 2, scene.height / 2);
        event.preventDefault();
      } else if (event.key === 'Escape') {
        this.clear();
      }
    });
    canvas.addEventListener('focus', () => this.draw());
    canvas.addEventListener('blur', () => this.draw());
    scene.watchers.push(() => this.draw());
  }

  inCanvas(event) {
    const box = this.scene.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  switchOn(on) {
    this.on = on;
    this.scene.canvas.classList.toggle('measuring', on);
    this.clear();
    if (on) tell('Measuring: click two points, or press Enter for the point in the middle of the picture.');
  }
  clear() {
    this.points = [];
    this.show(undefined);
    this.draw();
  }

  // A look takes a quarter of the time at most: of a large cloth the pointer has to rest for a moment.
  ask() {
    if (this.asked || this.scene.eye.moving) return;
    this.asked = setTimeout(() => {
      this.asked = 0;
      if (!this.pointer || this.scene.eye.moving) return;
      const begin = performance.now();
      this.hover(this.scene.pick(...this.pointer, 2));
      this.pause = Math.min(1000, 3 * (performance.now() - begin));
    }, this.pause ?? 0);
  }
  hover(hit) {
    this.show(hit);
    if (this.model.mark('pointed', hit?.index)) this.scene.invalidate();
    this.under = hit;
    if (this.on && this.points.length === 1) this.draw();
  }
  leave() {
    this.pointer = undefined;
    this.hover(undefined);
  }

  show(hit) {
    const parts = [];
    if (hit) {
      parts.push(this.model.names[hit.index], `${placeText(hit.point)} ${UNIT}`);
      if (this.model.field && Number.isFinite(hit.value)) parts.push(`${this.model.field.name} ${shown(hit.value)}`);
    }
    if (this.points.length === 2) parts.push(`distance ${lengthText(this.points[0].distanceTo(this.points[1]))}`);
    this.readout.textContent = parts.join('  ·  ');
  }

  // A click, or Enter in the middle: a point to measure from, or a yarn that is chosen.
  take(x, y) {
    const hit = this.scene.pick(x, y, 2);
    if (this.on) {
      if (!hit) return tell('There is nothing at this point.');
      if (this.points.length === 2) this.points = [];
      this.points.push(hit.point);
      if (this.points.length === 2) {
        const [a, b] = this.points, way = b.clone().sub(a).toArray().map(shown).join(', ');
        tell(`Distance ${lengthText(a.distanceTo(b))}; along x, y and z ${way}.`);
      } else {
        tell(`First point on ${this.model.names[hit.index]}, ${placeText(hit.point)}.`);
      }
      this.show(hit);
      return this.draw();
    }
    this.show(hit);
    this.onChoose?.(hit?.index);
    if (hit) tell(`${this.model.describe(hit.index)}; at ${placeText(hit.point)}.`);
  }

  // The contact that was gone to.
  ring(point) {
    this.ringed = point;
    this.draw();
  }

  draw() {
    const {overlay, scene} = this, parts = [];
    const places = this.points.map((point) => scene.project(point));
    const next = this.on && places.length === 1 && this.under ? scene.project(this.under.point) : undefined;
    const [a, b] = [places[0], places[1] ?? next];
    if (a && b && a.front && b.front) {
      parts.push(makeSvg('line', {x1: a.x, y1: a.y, x2: b.x, y2: b.y}));
      const to = this.points[1] ?? this.under.point;
      parts.push(makeSvg('text', {x: (a.x + b.x) / 2 + 8, y: (a.y + b.y) / 2 - 8}, lengthText(this.points[0].distanceTo(to))));
    }
    for (const {x, y, front} of places) if (front) parts.push(makeSvg('circle', {cx: x, cy: y, r: 4}));
    if (this.ringed) {
      const {x, y, front} = scene.project(this.ringed);
      if (front) parts.push(makeSvg('circle', {cx: x, cy: y, r: 15, class: 'ring'}));
    }
    if (scene.canvas.matches(':focus-visible')) {
      const x = scene.width / 2, y = scene.height / 2;
      parts.push(makeSvg('line', {x1: x - 9, x2: x + 9, y1: y, y2: y, class: 'aim'}),
        makeSvg('line', {x1: x, x2: x, y1: y - 9, y2: y + 9, class: 'aim'}));
    }
    overlay.replaceChildren(...parts);
  }
}

// A bar of a round length, in the plane of the target.
function drawScale(eye) {
  const bar = document.getElementById('scale'), most = 150 / eye.pixelsPerUnit(), power = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].find((digit) => digit * power <= most) * power;
  bar.lastElementChild.style.width = `${length * eye.pixelsPerUnit()}px`;
  bar.firstElementChild.textContent = lengthText(length);
}
