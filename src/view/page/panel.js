// The panel beside the picture: lists, controls, tables. All texts come in as texts.
class Panel {
  constructor(scene, model, measure) {
    Object.assign(this, {scene, model, measure});
    this.element = document.getElementById('panel');
    this.isMesh = model instanceof SkinModel;
    this.noun = this.isMesh ? 'region' : 'yarn';
    this.addThings();
    if (this.isMesh) this.addFields();
    this.addSection();
    if (!this.isMesh) this.addContacts();
    if (this.isMesh) this.addQuality();
    if (DATA.sheets) for (const [kind, sheet] of Object.entries(DATA.sheets)) this.addSheet(kind, sheet);
  }

  section(title, ...children) {
    const id = `heading-${this.element.childElementCount}`;
    const section = make('section', {'aria-labelledby': id}, make('h2', {id}, title), ...children);
    this.element.append(section);
    return section;
  }

  // Yarns or regions: by role, then one by one.

  addThings() {
    const {model} = this;
    this.most = 300;  // rows that are shown; a search finds the others
    this.groupRows = make('div', {role: 'group', 'aria-label': this.isMesh ? 'Kinds' : 'Roles'});
    this.search = make('input', {type: 'search', placeholder: `Find a ${this.noun}`, 'aria-label': `Find a ${this.noun} by its name`,
      style: 'flex: 1; min-width: 0', oninput: () => this.fillList()});
    this.list = make('ul', {class: 'list', 'aria-label': this.isMesh ? 'Regions' : 'Yarns'});
    this.rest = make('p', {class: 'note'});
    const tools = make('div', {class: 'row'}, this.search, make('button', {type: 'button', onclick: () => this.showAll()}, 'Show all'));
    const parts = [this.groupRows, tools, this.list, this.rest];
    if (!this.isMesh) {
      const colors = make('select', {id: 'colors', onchange: () => {
        model.paint(colors.value);
        this.fillGroups();
        this.fillList();
        this.scene.invalidate();
      }}, ...[['role', 'by role'], ['file', 'as in the file'], ['each', 'each its own']].map(([value, text]) => make('option', {value}, text)));
      parts.unshift(make('div', {class: 'row'}, make('label', {for: 'colors', class: 'grow'}, 'Colours'), colors));
    }
    this.section(countText(model.count, this.noun), ...parts);
    this.fillGroups();
    this.fillList();
  }

  fillGroups() {
    const {model} = this, groups = model.groups();
    this.groupRows.replaceChildren(...groups.map(([role, members]) => {
      const shownCount = members.filter((one) => model.visible[one]).length;
      const box = make('input', {type: 'checkbox', 'aria-label': `Show all ${role}`, onchange: () => this.setVisible(members, box.checked)});
      box.checked = shownCount > 0;
      box.indeterminate = shownCount > 0 && shownCount < members.length;
      return make('label', {class: 'row'}, box, make('span', {class: 'swatch', style: `background: ${cssColor(model.colorOf(members[0]))}`}),
        make('span', {class: 'grow'}, role), make('span', {class: 'number'}, members.length.toLocaleString('en')));
    }));
  }

  fillList() {
    const {model} = this, wanted = this.search.value.trim().toLowerCase(), found = [];
    let more = 0;
    for (let one = 0; one < model.count; ++one) {
      if (wanted && !model.names[one].toLowerCase().includes(wanted)) continue;
      if (found.length < this.most) found.push(one);
      else ++more;
    }
    if (model.selected !== undefined && !found.includes(model.selected)) found.unshift(model.selected);
    this.list.replaceChildren(...found.map((one) => this.rowOf(one)));
    this.rest.textContent = more ? `${countText(more, this.noun)} more: a search finds them.` : found.length ? '' : `No ${this.noun} has this in its name.`;
  }

  rowOf(one) {
    const {model} = this, name = model.names[one];
    const box = make('input', {type: 'checkbox', 'aria-label': `Show ${name}`, onchange: () => this.setVisible([one], box.checked)});
    box.checked = Boolean(model.visible[one]);
    const go = make('button', {type: 'button', class: 'plain grow', title: model.describe(one), 'aria-pressed': undefined,
      onclick: () => this.choose(one, true)}, name);
    const only = make('button', {type: 'button', class: 'small', 'aria-label': `Only ${name}`, onclick: () => this.isolate(one)}, 'only');
    return make('li', {class: model.selected === one ? 'chosen' : undefined, 'data-index': one}, box,
      make('span', {class: 'swatch', style: `background: ${cssColor(model.colorOf(one))}`}), go, only);
  }

  setVisible(members, visible) {
    for (const one of members) this.model.visible[one] = visible ? 1 : 0;
    this.fillGroups();
    for (const row of this.list.children) row.firstElementChild.checked = Boolean(this.model.visible[row.dataset.index]);
    this.scene.invalidate();
  }
  showAll() {
    this.model.visible.fill(1);
    this.setVisible([], true);
    tell(`All ${this.noun}s are shown.`);
  }
  isolate(one) {
    this.model.visible.fill(0);
    this.setVisible([one], true);
    tell(`Only ${this.model.names[one]} is shown.`);
  }

  // Marks it in picture and list; `go`: brings it before the eye.
  choose(one, go = false) {
    if (!this.model.mark('selected', one)) this.model.mark('selected', one = undefined);
    for (const row of this.list.children) row.classList.toggle('chosen', Number(row.dataset.index) === one);
    if (one !== undefined && !go) {
      if (![...this.list.children].some((row) => Number(row.dataset.index) === one)) this.fillList();
      this.list.querySelector('.chosen')?.scrollIntoView({block: 'nearest'});
    }
    if (one !== undefined && go) {
      this.scene.eye.fit(this.model.boxOf(one));
      tell(this.model.describe(one));
    }
    this.scene.invalidate();
  }

  // A plane across x, y or z.

  addSection() {
    const axis = make('select', {id: 'axis', onchange: () => change(true)},
      ...['none', 'x', 'y', 'z'].map((text) => make('option', {value: text}, text === 'none' ? 'none' : `across ${text}`)));
    const place = make('input', {type: 'range', min: 0, max: 1000, value: 500, 'aria-label': 'Where the section is', oninput: () => change()});
    const number = make('input', {type: 'number', step: 'any', style: 'width: 7rem', 'aria-label': `Where the section is, in ${UNIT}`, onchange: () => {
      const [low, high] = range();
      place.value = 1000 * (Number(number.value) - low) / (high - low);
      change();
    }});
    const turned = make('input', {type: 'checkbox', id: 'turned', onchange: () => change()});
    const more = make('div', {hidden: true}, place, make('div', {class: 'row'}, number, make('span', {class: 'note grow'}, UNIT),
      turned, make('label', {for: 'turned'}, 'other side')));
    const range = () => {
      const k = 'xyz'.indexOf(axis.value), margin = 1e-3 * (DATA.box[1][k] - DATA.box[0][k] || 1);
      return [DATA.box[0][k] - margin, DATA.box[1][k] + margin];
    };
    const change = (anew = false) => {
      const k = 'xyz'.indexOf(axis.value);
      more.hidden = k < 0 || axis.value === 'none';
      if (more.hidden) return this.scene.cut();
      if (anew) {
        place.value = 500;
        turned.checked = this.scene.eye.axes().toward.getComponent(k) < 0;  // so that the eye sees what was cut
      }
      const [low, high] = range(), at = low + place.value / 1000 * (high - low);
      number.value = Number(at.toPrecision(6));
      place.setAttribute('aria-valuetext', `${axis.value} = ${lengthText(at)}`);
      this.scene.cut(k, at - DATA.centre[k], turned.checked);
    };
    this.section('Section', make('div', {class: 'row'}, make('label', {for: 'axis', class: 'grow'}, 'Cut away'), axis), more);
  }

  // Overlaps, then near contacts: each list goes to the place.

  addContacts() {
    const {contacts} = DATA;
    if (!contacts) {
      this.section('Contacts', make('p', {class: 'note'}, DATA.contacts_note || 'Nobody has looked for contacts.'));
      return;
    }
    const parts = [];
    for (const [kind, {noun, word, style}] of Object.entries(CONTACT_KINDS)) {
      const rows = contacts[kind], count = contacts[`${kind === 'overlaps' ? 'overlap' : 'near'}_count`];
      const marks = new Marks(kind, rows), id = `mark-${kind}`;
      marks.group.visible = kind === 'overlaps';
      this.scene.scene.add(marks.group);
      const box = make('input', {type: 'checkbox', id, onchange: () => {
        marks.group.visible = box.checked;
        this.scene.invalidate();
      }});
      box.checked = marks.group.visible;
      const title = count === 0 ? (kind === 'overlaps' ? 'No two yarns overlap.' : 'No near contacts') : countText(count, noun);
      const within = kind === 'near' ? ` within ${lengthText(contacts.reach)}` : '';
      if (count === 0) {
        parts.push(make('p', {class: 'note', 'data-count': 0}, title + within));
        continue;
      }
      parts.push(make('div', {class: 'row', 'data-count': count}, make('h3', {class: style, style: 'margin: 0'}, title + within), box, make('label', {for: id}, 'mark')));
      const list = make('ul', {class: 'list', 'aria-label': title, style: 'max-height: 13rem'}), more = make('p', {class: 'note'});
      let filled = 0;
      const fill = () => {
        for (const end = Math.min(rows.length, filled + 40); filled < end; ++filled) list.append(this.contactRow(rows[filled], word, style));
        more.replaceChildren(...filled < rows.length ? [make('button', {type: 'button', class: 'small', onclick: fill}, 'more')] :
          count > rows.length ? [`The page holds the first ${rows.length.toLocaleString('en')}.`] : []);
      };
      fill();
      parts.push(list, more);
    }
    this.section('Contacts', ...parts);
  }

  contactRow(row, word, style) {
    const {model} = this, [a, b, gap] = row;
    const text = a === b ? `${model.names[a]}, itself` : `${model.names[a]}, ${model.names[b]}`;
    return make('li', {}, make('button', {type: 'button', class: 'plain grow', onclick: () => {
      const place = Marks.place(row), size = 3 * Math.max(...[a, b].map((yarn) => model.shapes[model.shapeOf[yarn]].thickness));
      this.measure.ring(place);
      this.scene.eye.fit(new THREE.Box3().setFromCenterAndSize(place, new THREE.Vector3(size, size, size)));
      tell(`${text}: ${lengthText(Math.abs(gap))} ${word}, at ${placeText(place)}.`);
    }}, text), make('span', {class: `number ${style}`}, `${lengthText(Math.abs(gap))} ${word}`));
  }

  // The numbers of the trade (src/construction/sheet.h).

  addSheet(kind, sheet) {
    const LABELS = [['mass', 'Mass', 'g/m²'], ['linear_mass', 'Mass', 'g/m'], ['thickness', 'Thickness', 'mm'], ['cover', 'Cover', '%'],
      ['yarn_fraction', 'Yarns fill', '%'], ['fibre_fraction', 'Fibres fill', '%'], ['porosity', 'Porosity', '%'],
      ['courses_per_cm', 'Courses', 'per cm'], ['wales_per_cm', 'Wales', 'per cm'], ['braid_angle', 'Braid angle', '°'],
      ['repeat_x', 'Repeat along x', 'mm'], ['repeat_y', 'Repeat along y', 'mm']];
    const on = kind.startsWith('braid') ? 'm' : 'm²';
    const SYSTEM = [['per_cm', 'per cm'], ['yarns', 'yarns'], ['crimp', sheet.courses_per_cm ? 'run-in %' : 'crimp %', 100], ['length', `m/${on}`], ['mass', `g/${on}`],
      ['cover_factor', 'cover factor'], ['loop_length', 'loop mm'], ['tightness_factor', 'tightness'], ['run_in', 'mm a rack']];
    const THREAD = [['tex', 'tex'], ['fibre_fraction', 'fibres %', 100], ['length', `m/${on}`], ['mass', `g/${on}`],
      ['twist_factor', 'twist factor']];
    const facts = LABELS.filter(([key]) => sheet[key] !== undefined).map(([key, label, unit]) =>
      make('tr', {}, make('th', {scope: 'row'}, label), make('td', {}, `${shown(sheet[key] * (unit === '%' ? 100 : 1))} ${unit}`)));
    this.section(`Data sheet: ${kind.replace('_', ' ')}`, make('table', {class: 'pairs'}, make('tbody', {}, ...facts)),
      ...this.sheetTable('System', sheet.systems, SYSTEM), ...this.sheetTable('Thread', sheet.threads, THREAD));
  }
  sheetTable(title, rows, columns) {
    if (!rows) return [];
    const used = columns.filter(([key]) => Object.values(rows).some((row) => row[key] !== undefined));
    const head = make('tr', {}, make('th', {scope: 'col'}, title), ...used.map(([, label]) => make('th', {scope: 'col'}, label)));
    const body = Object.entries(rows).map(([name, row]) => make('tr', {}, make('th', {scope: 'row'}, name),
      ...used.map(([key, , times = 1]) => make('td', {}, row[key] === undefined ? '–' : shown(times * row[key])))));
    return [make('h3', {}, `${title}s`), make('div', {class: 'wide', tabindex: 0, role: 'region', 'aria-label': `${title}s`},
      make('table', {}, make('thead', {}, head), make('tbody', {}, ...body)))];
  }

  // Of meshes: fields, and how good the elements are.

  addFields() {
    const {model, scene} = this, {fields} = model;
    const edges = make('input', {type: 'checkbox', id: 'edges', checked: true, onchange: () => {
      model.uniforms.edges.value = edges.checked ? 1 : 0;
      scene.invalidate();
    }});
    const titles = [...new Set(fields.map((one) => one.name))];
    const field = make('select', {id: 'field', onchange: () => pick()}, make('option', {value: ''}, 'regions'),
      ...titles.map((title) => make('option', {value: title}, title)));
    const {steps} = model.data;
    const step = make('select', {id: 'step', onchange: () => pick()}, ...steps.map((text, k) => make('option', {value: k + 1}, text)));
    this.ofStep = (list) => list.filter((one) => !one.step || one.step === Number(step.value));
    const part = make('select', {'aria-label': 'Which part of it', hidden: true, onchange: () => paint()});
    const legend = make('div', {class: 'legend', role: 'img', hidden: true,
      style: `background: linear-gradient(to right, ${SCALE.map(cssColor).join(', ')})`});
    const ends = make('div', {class: 'ends'});
    const chosen = () => this.ofStep(fields).find((one) => one.name === field.value);
    const paint = () => {
      const one = chosen();
      const range = model.showField(one, part.value === 'size' || !one ? 'size' : Number(part.value));
      legend.hidden = !range;
      ends.replaceChildren(...range ? range.map((value) => make('span', {}, shown(value))) : []);
      legend.setAttribute('aria-label', range ? `From ${shown(range[0])} to ${shown(range[1])}` : '');
      scene.invalidate();
    };
    const pick = () => {
      const one = chosen(), n = one?.components ?? 1, before = part.value;
      const names = n === 3 ? ['x', 'y', 'z'] : n === 6 ? ['xx', 'yy', 'zz', 'xy', 'yz', 'zx'] : [...Array(n).keys()].map(String);
      part.hidden = n === 1;
      part.replaceChildren(make('option', {value: 'size'}, n === 6 ? 'von Mises' : 'size'),
        ...names.map((text, k) => make('option', {value: k}, text)));
      if ([...part.options].some((option) => option.value === before)) part.value = before;
      paint();
      this.move?.();
    };
    const parts = steps.length ? [make('div', {class: 'row'}, make('label', {for: 'step', class: 'grow'}, 'Results of'), step)] : [];
    parts.push(make('div', {class: 'row'}, make('label', {for: 'field', class: 'grow'}, 'Colours'), field, part), legend, ends,
      make('div', {class: 'row'}, edges, make('label', {for: 'edges'}, 'Edges of the elements')));
    const vectors = fields.filter((one) => one.of_points && one.components === 3 && one.name !== 'along');
    if (vectors.length) parts.push(...this.deformation(vectors));
    this.section('Fields', ...parts);
  }

  deformation(vectors) {
    const {model, scene} = this, size = BOX.getSize(new THREE.Vector3()).length();
    const which = make('select', {id: 'moved', onchange: () => change()}, make('option', {value: ''}, 'as it is'),
      ...[...new Set(vectors.map((one) => one.name))].map((name) => make('option', {value: name}, `moved by ${name}`)));
    const slider = make('input', {type: 'range', min: 0, max: 100, value: 50, hidden: true, 'aria-label': 'How far', oninput: () => change()});
    const said = make('p', {class: 'note'});
    const change = () => {
      const one = this.ofStep(vectors).find((some) => some.name === which.value);
      slider.hidden = !one;
      let factor = 0;
      if (one) {
        // Half of the way the largest displacement is a twentieth of the mesh.
        const largest = one.values.reduce((most, value) => Math.max(most, Math.abs(value)), 1e-300);
        factor = Number((slider.value / 50 * size / 20 / largest).toPrecision(2));
      }
      said.textContent = one ? `${shown(factor)} times` : '';
      slider.setAttribute('aria-valuetext', said.textContent);
      model.deform(one, factor);
      scene.invalidate();
    };
    this.move = change;
    return [make('div', {class: 'row'}, make('label', {for: 'moved', class: 'grow'}, 'Shape'), which), slider, said];
  }

  addQuality() {
    const {data} = this.model;
    if (!data.histograms.length) return;
    this.section('Quality of the elements', ...data.histograms.flatMap((histogram) => {
      const {counts, low, high} = histogram, most = Math.max(...counts, 1), width = 300 / counts.length;
      const bars = makeSvg('svg', {class: 'bars', viewBox: '0 0 300 84', preserveAspectRatio: 'none', role: 'img',
        'aria-label': `${histogram.name}: least ${shown(histogram.least)}, mean ${shown(histogram.mean)}`});
      counts.forEach((count, k) => {
        // Few bad elements are what one looks for: a root's scale shows them beside many good ones.
        const height = count ? Math.max(2, 82 * Math.sqrt(count / most)) : 0;
        const bar = makeSvg('rect', {x: k * width + 0.75, y: 84 - height, width: width - 1.5, height});
        bar.append(makeSvg('title', {}, `${shown(low + k * (high - low) / counts.length)} to ${shown(low + (k + 1) * (high - low) / counts.length)}: ${countText(count, 'element')}`));
        bars.append(bar);
      });
      return [make('h3', {}, histogram.name), bars, make('div', {class: 'ends'}, make('span', {}, shown(low)),
        make('span', {}, `least ${shown(histogram.least)}, mean ${shown(histogram.mean)}`), make('span', {}, shown(high)))];
    }), make('p', {class: 'note'}, 'Heights are as the root of the number of elements.'));
  }
}
