// What the page shows: a JSON text, and numbers as bytes that it refers to.
const DATA = JSON.parse(document.getElementById('data').textContent);

const BYTES = (() => {
  const element = document.getElementById('binary');
  const letters = atob(element.textContent);
  element.remove();
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; ++k) bytes[k] = letters.charCodeAt(k);
  return bytes.buffer;
})();

// `count` numbers of a typed array's kind; a copy, so that no place has to be aligned.
function numbers(Kind, at, count) {
  return new Kind(BYTES.slice(at, at + count * Kind.BYTES_PER_ELEMENT));
}

const UNIT = DATA.units;
const CENTRE = new THREE.Vector3(...DATA.centre);
// Told from CENTRE, as all that is drawn.
const BOX = new THREE.Box3(new THREE.Vector3(...DATA.box[0]), new THREE.Vector3(...DATA.box[1])).translate(CENTRE.clone().negate());

// A number to look at: four digits that mean something, no more places than the size of all that is shown asks for.
function shown(value) {
  if (!Number.isFinite(value)) return '–';
  const text = Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-4) ? value.toExponential(3) : String(Number(value.toPrecision(4)));
  return text.replace('-', '−');
}
const lengthText = (value) => `${shown(value)} ${UNIT === 'um' ? 'µm' : UNIT}`;
const countText = (count, noun) => `${count.toLocaleString('en')} ${noun}${count === 1 ? '' : 's'}`;
// A place told from CENTRE, as the file tells it.
function placeText(point) {
  const step = BOX.getSize(new THREE.Vector3()).length() / 1e5;
  const digits = Math.min(8, Math.max(0, Math.ceil(-Math.log10(step))));
  return point.clone().add(CENTRE).toArray().map((x) => x.toFixed(digits).replace('-', '−')).join(', ');
}

// What assistive technology is told.
function tell(text) {
  document.getElementById('status').textContent = text;
}

// An element with attributes and children; texts are texts, whatever stands in them.
function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, '');
    else if (value !== false && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}
function makeSvg(name, attributes = {}, text = '') {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

const PREFERS_STILL = matchMedia('(prefers-reduced-motion: reduce)');
