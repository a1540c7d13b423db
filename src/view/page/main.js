// Puts it together, or says why it cannot be shown.
function heading() {
  document.getElementById('title').textContent = DATA.title || DATA.name;
  const sizes = DATA.box[1].map((high, k) => shown(high - DATA.box[0][k])).join(' × ');
  const what = DATA.skin ? `${countText(DATA.skin.elements, 'element')}, ${countText(DATA.skin.nodes, 'node')}` : countText(DATA.yarns.count, 'yarn');
  document.getElementById('facts').textContent = `${DATA.title ? `${DATA.name}  ·  ` : ''}${what}  ·  ${sizes} ${UNIT}  ·  Selvage ${DATA.selvage}`;
}

// Without WebGL: the picture that is there for browsers without scripts, too.
function showPicture(reason) {
  const source = document.querySelector('noscript').textContent.match(/src="(data:[^"]+)"/)?.[1];
  const parts = [make('p', {class: 'fallback', role: 'alert'}, `${reason} ${source ? 'This is a picture of it.' :
    'The page has no picture instead; selvage view writes one with -o picture.png.'}`)];
  if (source) parts.push(make('img', {class: 'fallback', src: source, alt: DATA.title || DATA.name}));
  document.getElementById('stage').replaceChildren(...parts);
  for (const unused of ['.tools', '#panel', '.skip']) document.querySelector(unused).hidden = true;
  document.querySelector('main').classList.add('alone');
}

function start() {
  heading();
  const canvas = document.getElementById('canvas');
  if (!document.createElement('canvas').getContext('webgl2'))
    return showPicture('This browser has no WebGL 2, which the turning view needs.');
  const model = DATA.skin ? new SkinModel(DATA.skin) : new Yarns(DATA.yarns);
  const scene = new Scene(canvas, model), {eye} = scene;
  canvas.setAttribute('aria-label', `Picture of ${DATA.title || DATA.name} from any side`);
  const measure = new Measure(scene, model);
  const panel = new Panel(scene, model, measure);
  measure.onChoose = (index) => panel.choose(index);
  scene.watchers.push(drawScale);

  const press = (id, run) => {
    const button = document.getElementById(id);
    button.addEventListener('click', () => {
      const on = button.getAttribute('aria-pressed') !== 'true';
      button.setAttribute('aria-pressed', on);
      run(on);
    });
    return button;
  };
  const buttons = Object.fromEntries([...document.querySelectorAll('[data-view]')].map((button) => {
    button.addEventListener('click', () => eye.look(button.dataset.view, BOX));
    return [button.getAttribute('aria-keyshortcuts'), button];
  }));
  const fit = document.getElementById('fit');
  fit.addEventListener('click', () => eye.fit(BOX));
  Object.assign(buttons, {f: fit, p: press('parallel', (on) => {
    eye.parallel = on;
    scene.invalidate();
  }), m: press('measure', (on) => measure.switchOn(on))});
  // Single keys, where no text is being written.
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches('input, select')) return;
    buttons[event.key.toLowerCase()]?.click();
  });
  canvas.addEventListener('webglcontextlost', (event) => {
    event.preventDefault();
    tell('The browser has taken the picture away; load the page again to see it.');
  });
  const size = BOX.getSize(new THREE.Vector3()), isFlat = size.z < 0.35 * Math.max(size.x, size.y);
  eye.fit(BOX, {turn: isFlat ? 0.5 : 0.7, tilt: isFlat ? 0.95 : 0.6}, true);
  scene.draw(performance.now());
  window.selvage = {scene, model, panel, measure, data: DATA};
}

start();
