// SPDX-License-Identifier: BSD-3-Clause
//
// The page of a run: table, plots, list of contacts, and the controls of the view. The
// view itself is in viewer.js; where it is missing or cannot start, there is a picture.
'use strict';

const kStages = { build: '#8d99ae', update: '#2a9d8f', traverse: '#e9c46a', test: '#e76f51' };
const kMostListed = 20;

const byId = (id) => document.getElementById(id);

function make(parent, name, attributes = {}, text = '') {
  const svg = parent.namespaceURI.includes('svg') || name === 'svg';
  const element = svg
    ? document.createElementNS('http://www.w3.org/2000/svg', name)
    : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  parent.append(element);
  return element;
}

const shortNumber = (x) => String(Number(x.toPrecision(6)));
const point = (p) => '(' + p.map(shortNumber).join(', ') + ')';

// "vertex 3 of triangle 1", "edge b0 b1 of free edge b7", by the ids of the files.
function features(contact) {
  const { kind, vertices, triangles } = contact;
  const numFirst = kind === 'ee' || kind === 'crossing' ? 2 : 1;
  const names = ['', 'vertex', 'edge', 'face'];
  const parts = { '': 'triangle', e: 'free edge', p: 'free point' };
  const name = (ids, part) => {
    const [, body, kind, number] = /^(b?)([ep]?)(\d+)$/.exec(part);
    return `${names[ids.length]} ${ids.join(' ')} of ${parts[kind]} ${body}${number}`;
  };
  return [name(vertices.slice(0, numFirst), triangles[0]), name(vertices.slice(numFirst), triangles[1])];
}

function describe(contact) {
  const [first, second] = features(contact);
  return `${kKinds[contact.kind].words}: ${first}, ${second}; t ${contact.toc_lo} to ${contact.toc_hi}; ` +
    `at ${point(contact.position)}, normal ${point(contact.normal)}`;
}

class Page {
  constructor() {
    this.data = new RunData();
    this.index = 0; // of the step in the view
    this.time = 0;
    this.selected = null;
    this.update = Promise.resolve();
  }

  async start() {
    const { summary, steps } = this.data;
    byId('answer').textContent = summary.sentence;
    byId('program').textContent = summary.program;
    if (this.data.mesh) byId('rounding').textContent = shortNumber(this.data.mesh.spacing / 2);
    if (!summary.complete) byId('incomplete').hidden = false;
    const picture = document.getElementsByClassName('picture')[0].textContent;
    if (picture) byId('picture').src = 'data:image/png;base64,' + picture;
    else byId('picture').hidden = true;
    this.makeTable();
    this.makePlots();
    if (steps.length === 0) return;
    await this.makeList();
    await this.makeView();
    if (this.viewer) await this.viewer.drawn();
    byId('page').dataset.ready = 'yes';
  }

  makeTable() {
    const { steps } = this.data;
    const kinds = Object.keys(steps.length ? steps[0].contacts : {});
    const head = make(make(byId('table'), 'thead'), 'tr');
    for (const text of ['step', 'frames', ...kinds, 'first time', 'ms', 'began crossing']) make(head, 'th', {}, text);
    const body = make(byId('table'), 'tbody');
    steps.forEach((step, i) => {
      const row = make(body, 'tr');
      const found = step.first && step.first !== 'undecided' ? step.first : step.any;
      const crossing = { true: 'yes', false: 'no' }[step.initially_crossing] || 'not decided';
      const cells = [step.step, step.files.slice(0, 2).join(' to '), ...kinds.map((k) => step.contacts[k]),
        found ? shortNumber(found.toc_lo) : '-', step.ms.total.toFixed(3), crossing];
      for (const cell of cells) make(row, 'td', {}, cell);
      row.addEventListener('click', () => this.show(i, found ? found.toc_lo : 0));
    });
  }

  makePlots() {
    const { steps } = this.data;
    const series = (names, colours, value) =>
      names.map((name, i) => ({ name, colour: colours[i], values: steps.map((s) => value(s, name)) }));
    const kinds = Object.keys(steps.length ? steps[0].contacts : {});
    const firstOf = (s) => (s.first && s.first !== 'undecided' ? s.first : s.any);
    this.plot('Contacts', series(kinds, kinds.map((k) => kKinds[k].colour), (s, k) => s.contacts[k]));
    this.plot('First time of contact, in fractions of the step',
      series(['first time'], ['#e63946'], (s) => (firstOf(s) ? firstOf(s).toc_lo : null)));
    this.plot('Milliseconds', series(Object.keys(kStages), Object.values(kStages), (s, k) => s.ms[k]));
    this.plot('Memory of the program, MB', series(['memory'], ['#457b9d'], (s) => s.memory_mb));
  }

  // A plot over the steps. A click on it shows the step.
  plot(title, series) {
    const width = 440, height = 170, left = 52, right = 8, top = 8, bottom = 22;
    const { steps } = this.data;
    const figure = make(byId('plots'), 'figure');
    make(figure, 'figcaption', {}, title);
    const svg = make(figure, 'svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title });
    const highest = Math.max(...series.flatMap((s) => s.values.map((v) => v || 0)), 0) || 1;
    const last = Math.max(steps.length - 1, 1);
    const x = (i) => left + (i / last) * (width - left - right);
    const y = (v) => top + (1 - v / highest) * (height - top - bottom);
    for (const share of [0, 0.5, 1]) {
      const at = y(share * highest);
      make(svg, 'line', { x1: left, x2: width - right, y1: at, y2: at, class: 'grid' });
      make(svg, 'text', { x: left - 6, y: at + 4, 'text-anchor': 'end' }, Number((share * highest).toPrecision(3)));
    }
    for (const i of new Set([0, steps.length - 1]))
      if (steps[i]) make(svg, 'text', { x: x(i), y: height - 6, 'text-anchor': 'middle' }, steps[i].step);
    for (const { colour, values } of series) {
      let path = '';
      values.forEach((v, i) => {
        if (v === null) return;
        const begins = i === 0 || values[i - 1] === null;
        path += `${begins ? 'M' : 'L'}${x(i).toFixed(1)} ${y(v).toFixed(1)}`;
        const isAlone = begins && (i + 1 === values.length || values[i + 1] === null);
        if (isAlone) make(svg, 'circle', { cx: x(i), cy: y(v), r: 2.5, fill: colour });
      });
      make(svg, 'path', { d: path, stroke: colour });
    }
    const marker = make(svg, 'line', { y1: top, y2: height - bottom, class: 'marker' });
    this.markers = (this.markers || []).concat({ marker, x });
    svg.addEventListener('click', (event) => {
      const box = svg.getBoundingClientRect();
      const share = ((event.clientX - box.left) / box.width * width - left) / (width - left - right);
      this.show(Math.round(Math.min(1, Math.max(0, share)) * last), this.time);
    });
    if (series.length === 1) return;
    const legend = make(figure, 'p', { class: 'legend' });
    for (const { name, colour } of series) make(legend, 'span', { style: `color: ${colour}` }, name);
  }

  async makeList() {
    this.listed = await this.data.earliest(kMostListed);
    byId('no-contacts').hidden = this.listed.length > 0;
    this.listed.forEach((contact) => {
      const item = make(byId('contacts'), 'li');
      const button = make(item, 'button', { type: 'button' });
      make(button, 'b', { style: `color: ${kKinds[contact.kind].colour}` },
        `step ${this.data.steps[contact.index].step} at ${shortNumber(contact.toc_lo)}`);
      make(button, 'span', {}, features(contact).join(', '));
      button.addEventListener('click', () => this.showContact(contact));
    });
  }

  async makeView() {
    if (window.FclCcdViewer === undefined) {
      byId('no-view').hidden = false;
      return;
    }
    await this.data.loadMesh();
    try {
      this.viewer = new window.FclCcdViewer(byId('view'), this.data, (contact) => this.select(contact));
    } catch (error) {
      byId('no-graphics').hidden = false;
      return;
    }
    byId('picture').hidden = true;
    byId('controls').hidden = false;
    const step = byId('step'), time = byId('time');
    step.max = this.data.steps.length - 1;
    step.addEventListener('input', () => this.show(Number(step.value), this.time));
    time.addEventListener('input', () => this.show(this.index, Number(time.value)));
    byId('cut').addEventListener('change', () => this.viewer.cut(byId('cut').checked));
    byId('whole').addEventListener('click', () => this.viewer.showWhole());
    byId('first').addEventListener('click', () => this.showContact(this.listed[0]));
    byId('first').disabled = this.listed.length === 0;
    if (this.listed.length > 0) await this.showContact(this.listed[0]);
    else {
      await this.show(0, 0);
      this.viewer.showWhole();
    }
  }

  // Shows a time of the i-th step, after what is being shown.
  show(i, time) {
    this.index = i;
    this.time = time;
    this.update = this.update.then(() => this.draw(i, time));
    return this.update;
  }

  async draw(i, time) {
    if (i !== this.index || time !== this.time) return; // a later one waits
    const step = this.data.steps[i];
    for (const { marker, x } of this.markers)
      for (const end of ['x1', 'x2']) marker.setAttribute(end, x(i));
    Array.from(byId('table').tBodies[0].rows).forEach((row, k) => row.classList.toggle('shown', k === i));
    if (!this.viewer) return;
    byId('step').value = i;
    byId('time').value = time;
    byId('step-text').textContent = `${step.step} (${step.files.slice(0, 2).join(' to ')})`;
    byId('time-text').textContent = shortNumber(time);
    const positions = await this.data.positions(i, time);
    const { contacts, times } = await this.data.block(i);
    const all = Object.values(step.contacts).reduce((a, b) => a + b, 0);
    byId('drawn').textContent = all > contacts.length ? `the ${contacts.length} earliest of ${all} contacts` :
      `${all} contact${all === 1 ? '' : 's'}`;
    this.viewer.show(positions, times, time, contacts);
    if (this.selected && this.selected.index !== i) this.select(null);
  }

  async showContact(contact) {
    this.selected = contact;
    await this.show(contact.index, contact.toc_lo);
    this.select(contact);
    this.viewer && this.viewer.lookAt(contact);
  }

  // Names a contact, or none.
  select(contact) {
    this.selected = contact && { ...contact, index: this.index };
    byId('selected').textContent = contact ? describe(contact) : 'Click on a contact to name it.';
    this.viewer && this.viewer.select(contact, contact ? features(contact).join(', ') : '');
    this.listed.forEach((listed, i) => byId('contacts').children[i].classList.toggle('shown',
      contact !== null && listed.index === this.index && String(listed.vertices) === String(contact.vertices)));
  }
}

window.addEventListener('DOMContentLoaded', () => new Page().start());
