// SPDX-License-Identifier: BSD-3-Clause
//
// Draws the data of _pages.py in the 3D view of viewer.js. Lengths are halves of the view of
// the picture, from its centre.
'use strict';

const kMain = '#e63946', kOther = '#7a1029'; // contacts

const byId = (id) => document.getElementById(id);
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const shortNumber = (x) => String(Number(x.toPrecision(6)));
const point = (p) => '(' + p.map(shortNumber).join(', ') + ')';

// Triangles, segments or points, each with its corners.
class Group {
  constructor({ positions, touched, of_first }) {
    this.positions = new Float32Array(bytes(positions).buffer);
    this.touched = bytes(touched);
    this.ofFirst = of_first;
  }
  colours() {
    const { a, b, touched } = window.FclCcdViewer.colours;
    return Array.from(this.touched, (is, i) => (is ? touched : i < this.ofFirst ? a : b));
  }
}

// What the viewer asks of its data.
class PictureData {
  constructor(picture) {
    Object.assign(this, picture);
    [this.surface, this.segments, this.points] =
      [picture.triangles, picture.segments, picture.points].map((group) => new Group(group));
    this.sides = bytes(picture.triangles.sides);
    const parts = [this.surface, this.segments, this.points].flatMap((group) => Array.from(group.positions));
    this.positions = new Float32Array(parts);
    this.triangles = Uint32Array.from({ length: this.surface.positions.length / 3 }, (_, i) => i);
    this.edges = []; // the view draws segments in colours
    this.mesh = { triangles: this.surface.touched.length, triangles_of_a: this.surface.ofFirst };
  }
  placeOf(contact) { return contact.from_centre; }
  trianglesOf() { return []; } // the picture has the parts of all contacts
  colourOf(contact) { return contact.is_main ? kMain : kOther; }
  isEdge(t, k) { return Boolean((this.sides[t] >> k) & 1); }
}

class PictureView extends window.FclCcdViewer {
  makeScene() {
    super.makeScene();
    const { segments, points } = this.data;
    this.fill(this.addLines(true), segments.positions, segments.colours(), 2);
    this.fill(this.addPoints(5, true), points.positions, points.colours());
  }
  // All edges near the view, or none where they would hide the faces.
  edged() {
    const triangles = this.trianglesNear([0, 0, 0], 4);
    return triangles.length > 4000 ? [] : triangles;
  }
  reachOf() { return this.contacts.length < 10 ? 1 : 1 / 3; }

  // The view of the picture; without a contact to look at, the whole cube of it.
  showNear(contact) {
    const centre = this.centre.clone().set(0, 0, 0);
    if (contact) this.look(centre, this.directionTo(contact, 1), 1);
    else this.look(centre, this.above(), Math.sqrt(3));
  }
}

function makeLegend({ names, contacts }) {
  const { a, b, touched } = window.FclCcdViewer.colours;
  const rows = names.map((name, i) => [name, i === 0 ? a : b]).concat([['parts in contact', touched]]);
  if (contacts.some((contact) => contact.is_main)) rows.push(['contact, normal', kMain]);
  if (contacts.some((contact) => !contact.is_main)) rows.push(['other contacts', kOther]);
  for (const [name, colour] of rows) {
    const row = document.createElement('span');
    row.textContent = name;
    row.style.setProperty('--colour', colour);
    byId('legend').append(row);
  }
}

async function start() {
  const data = new PictureData(JSON.parse(byId('picture').textContent));
  byId('title').textContent = data.title;
  const mains = data.contacts.filter((contact) => contact.is_main);
  const chosen = mains.length === 1 ? mains[0] : null;
  let view = null;
  const select = (contact) => {
    const place = contact ? `at ${point(contact.position)}` : '';
    byId('selected').textContent = contact ? `${place}, normal ${point(contact.normal)}` :
      data.contacts.length > 0 ? 'Click on a contact to see its place.' : '';
    view.select(contact, place);
  };
  try {
    view = new PictureView(byId('view'), data, select);
  } catch (error) {
    byId('no-graphics').hidden = false;
    return;
  }
  makeLegend(data);
  byId('controls').hidden = false;
  byId('cut').addEventListener('change', () => view.cut(byId('cut').checked));
  byId('near').addEventListener('click', () => view.showNear(chosen));
  byId('whole').addEventListener('click', () => view.showWhole());
  view.show(data.positions, data.surface.touched, 0, data.contacts);
  select(chosen);
  view.showNear(chosen);
  await view.drawn();
  document.body.dataset.ready = 'yes';
}

start();
