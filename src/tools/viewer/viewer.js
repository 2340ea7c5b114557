// SPDX-License-Identifier: BSD-3-Clause
//
// The 3D view of the page of a run, and of a picture of the Python package, drawn by three.js.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, LineSegments, Mesh, MeshBasicMaterial,
  PerspectiveCamera, Points, PointsMaterial, Scene, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const kColours = { a: '#7fc8be', b: '#c9ced4', touched: '#f28482' };
const kColourOfA = new Color(kColours.a), kColourOfB = new Color(kColours.b), kTouched = new Color(kColours.touched);
const kLight = [0.37, -0.28, 0.88]; // the direction to it
const kPickDistance = 14; // pixels
// The same for all materials, so that the browser translates two programs for the graphics
// card: one for points, and one for all else, lines too. Nothing is transparent, which would
// need more of them.
const kMaterial = { vertexColors: true, side: DoubleSide };

// Whether a ray meets a triangle.
function meets(origin, direction, a, b, c) {
  const edge1 = b.clone().sub(a), edge2 = c.clone().sub(a);
  const across = direction.clone().cross(edge2);
  const determinant = edge1.dot(across);
  if (determinant === 0) return false;
  const from = origin.clone().sub(a);
  const u = from.dot(across) / determinant;
  const along = from.clone().cross(edge1);
  const v = direction.dot(along) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && edge2.dot(along) / determinant > 0;
}

class Viewer {
  // host: the element of the view. pick: is called with the contact that was clicked on.
  // data: of the meshes and their contacts, as the class RunData of report pages:
  //   triangles, edges  ids of vertices, three and two for each; mesh: how many triangles
  //   isEdge(t, k)      whether a side of a triangle is an edge of its surface
  //   placeOf(contact), trianglesOf(contact), colourOf(contact)
  constructor(host, data, pick) {
    this.host = host;
    this.data = data;
    this.pick = pick;
    this.contacts = [];
    this.selected = null;
    this.isCut = true;
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    this.label = document.createElement('div');
    this.label.id = 'label';
    host.append(this.label);
    this.makeScene();
    this.makeCamera();
    new ResizeObserver(() => this.resize()).observe(host);
  }

  makeScene() {
    const { data } = this;
    this.scene = new Scene();
    this.scene.background = new Color('#f4f5f7');
    this.surface = new BufferGeometry();
    const numCorners = data.triangles.length;
    this.surface.setAttribute('position', new BufferAttribute(new Float32Array(3 * numCorners), 3));
    this.surface.setAttribute('color', new BufferAttribute(new Float32Array(3 * numCorners), 3));
    // A little behind the edges.
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    this.add(new Mesh(this.surface, new MeshBasicMaterial({ ...kMaterial, ...behind })));
    this.edges = this.addLines(true);
    this.cables = new BufferGeometry();
    this.cables.setAttribute('position', new BufferAttribute(new Float32Array(3 * data.edges.length), 3));
    this.cables.setAttribute('color', new BufferAttribute(new Float32Array(3 * data.edges.length).fill(0.1), 3));
    this.add(new LineSegments(this.cables, new MeshBasicMaterial(kMaterial)));
    this.points = this.addPoints(7, true);
    this.normals = this.addLines(true);
    this.outlines = this.addLines(false);
    this.chosenPoint = this.addPoints(13, false);
  }

  // What is added later is drawn later.
  add(object) {
    object.frustumCulled = false;
    object.renderOrder = this.scene.children.length;
    this.scene.add(object);
    return object;
  }
  addPoints(size, hidden) {
    return this.add(new Points(new BufferGeometry(),
      new PointsMaterial({ ...kMaterial, size, sizeAttenuation: false, depthTest: hidden })));
  }
  addLines(hidden) {
    return this.add(new LineSegments(new BufferGeometry(),
      new MeshBasicMaterial({ ...kMaterial, depthTest: hidden })));
  }

  makeCamera() {
    this.camera = new PerspectiveCamera(30, 1, 0.1, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.render());
    const canvas = this.renderer.domElement;
    let down = null;
    canvas.addEventListener('pointerdown', (event) => { down = new Vector2(event.clientX, event.clientY); });
    canvas.addEventListener('pointerup', (event) => {
      const up = new Vector2(event.clientX, event.clientY);
      if (down && down.distanceTo(up) < 5) this.pickAt(event.clientX, event.clientY);
    });
  }

  resize() {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === this.width && clientHeight === this.height) return;
    [this.width, this.height] = [clientWidth, clientHeight];
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.render();
  }

  // Shows the meshes at a time. positions: of all vertices. times: of triangles.
  show(positions, times, time, contacts) {
    this.positions = positions;
    this.times = times;
    this.contacts = contacts;
    this.copy(this.data.triangles, this.surface);
    this.copy(this.data.edges, this.cables);
    this.colour(times, time);
    const places = contacts.flatMap((c) => this.data.placeOf(c));
    const colours = contacts.map((c) => (c.toc_lo <= time ? this.data.colourOf(c) : '#9aa0a6'));
    this.fill(this.points, places, colours);
    this.resize();
    this.measure();
    this.drawNormals(colours);
    this.drawSelected();
    this.drawEdges();
    this.render();
  }

  copy(ids, geometry) {
    const to = geometry.attributes.position;
    const { positions } = this;
    for (let i = 0; i < ids.length; ++i)
      for (let k = 0; k < 3; ++k) to.array[3 * i + k] = positions[3 * ids[i] + k];
    to.needsUpdate = true;
  }

  // Triangles that have touched have their colour from then on. Both sides are lit alike.
  colour(times, time) {
    const to = this.surface.attributes.color;
    const now = 1 + Math.floor(254 * time);
    const p = this.surface.attributes.position.array;
    for (let f = 0; f < times.length; ++f) {
      const touched = times[f] > 0 && times[f] <= now;
      const colour = touched ? kTouched : f < this.data.mesh.triangles_of_a ? kColourOfA : kColourOfB;
      const i = 9 * f;
      const ax = p[i + 3] - p[i], ay = p[i + 4] - p[i + 1], az = p[i + 5] - p[i + 2];
      const bx = p[i + 6] - p[i], by = p[i + 7] - p[i + 1], bz = p[i + 8] - p[i + 2];
      const nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
      const towards = Math.abs(nx * kLight[0] + ny * kLight[1] + nz * kLight[2]) / (Math.hypot(nx, ny, nz) || 1);
      const light = 0.4 + 0.6 * towards;
      for (let k = 0; k < 9; k += 3) {
        to.array[i + k] = light * colour.r;
        to.array[i + k + 1] = light * colour.g;
        to.array[i + k + 2] = light * colour.b;
      }
    }
    to.needsUpdate = true;
  }

  // Gives points or lines their places and colours. A colour is for so many places.
  fill(object, places, colours, each = 1) {
    object.geometry.dispose();
    object.geometry = new BufferGeometry();
    const known = new Map();
    const rgbOf = (c) => known.get(c) || known.set(c, new Color(c).toArray()).get(c);
    const rgb = colours.flatMap((c) => Array(each).fill(rgbOf(c)).flat());
    object.geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3));
    object.geometry.setAttribute('color', new BufferAttribute(new Float32Array(rgb), 3));
  }

  // The ball around everything.
  measure() {
    const lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.positions.length; ++i) {
      lo[i % 3] = Math.min(lo[i % 3], this.positions[i]);
      hi[i % 3] = Math.max(hi[i % 3], this.positions[i]);
    }
    const low = new Vector3(...lo), high = new Vector3(...hi);
    this.centre = low.clone().add(high).multiplyScalar(0.5);
    this.radius = high.distanceTo(low) / 2 || 1;
  }

  place(contact) { return new Vector3().fromArray(this.data.placeOf(contact)); }
  corners(triangle) {
    return [0, 1, 2].map((k) => new Vector3().fromArray(this.positions, 3 * this.data.triangles[3 * triangle + k]));
  }

  // The surroundings of a contact: some triangles of the size of the smaller one of both.
  reachOf(contact) {
    const place = this.place(contact);
    const reaches = this.data.trianglesOf(contact).map(
      (t) => Math.max(...this.corners(t).map((corner) => corner.distanceTo(place)))).filter((x) => x > 0);
    return Math.min(this.radius, 2.5 * Math.min(...reaches, Infinity));
  }

  // The ends of the normal that is drawn.
  normalOf(contact) {
    const place = this.place(contact);
    const tip = place.clone().addScaledVector(new Vector3().fromArray(contact.normal), 0.3 * this.reachOf(contact));
    return [...place, ...tip];
  }
  drawNormals(colours) {
    this.fill(this.normals, this.contacts.flatMap((contact) => this.normalOf(contact)), colours, 2);
  }

  select(contact, name) {
    this.selected = contact;
    // The edges around the last one stay.
    if (contact) this.around = contact;
    this.drawEdges();
    this.label.textContent = contact ? name : '';
    this.drawSelected();
    this.render();
  }

  // The ends of the edges of triangles.
  outlinesOf(triangles) {
    return triangles.flatMap((t) => {
      const corners = this.corners(t);
      return [0, 1, 2].filter((k) => this.data.isEdge(t, k))
        .flatMap((k) => [...corners[k], ...corners[(k + 1) % 3]]);
    });
  }

  // The triangles whose edges are drawn: those around a contact. All would take most of the
  // time of a frame where there is no graphics card.
  edged() {
    const { around } = this;
    const reaches = 4, most = 4000;
    const near = around ? this.trianglesNear(this.data.placeOf(around), reaches * this.reachOf(around)) : [];
    return near.slice(0, most);
  }

  drawEdges() {
    const ends = this.outlinesOf(this.edged());
    this.fill(this.edges, ends, Array(ends.length / 3).fill('#5c6770'));
  }

  // The contact that was chosen, with its triangles and its normal, before everything else.
  drawSelected() {
    const { selected } = this;
    const ends = selected ? [...this.outlinesOf(this.data.trianglesOf(selected)), ...this.normalOf(selected)] : [];
    const colour = selected ? this.data.colourOf(selected) : '#000000';
    this.fill(this.outlines, ends, Array(ends.length / 3).fill(colour));
    this.fill(this.chosenPoint, selected ? this.data.placeOf(selected) : [], selected ? [colour] : []);
  }

  // The triangles whose boxes come within a distance of a place.
  trianglesNear(place, distance) {
    const p = this.surface.attributes.position.array;
    const near = [];
    for (let t = 0; t < this.data.mesh.triangles; ++t) {
      let squared = 0;
      for (let k = 0; k < 3; ++k) {
        const i = 9 * t + k;
        const gap = Math.max(Math.min(p[i], p[i + 3], p[i + 6]) - place[k],
          place[k] - Math.max(p[i], p[i + 3], p[i + 6]), 0);
        squared += gap * gap;
      }
      if (squared <= distance * distance) near.push(t);
    }
    return near;
  }

  // The direction from which a contact is seen best: nothing near is before it, and both
  // surfaces are seen from the side, from above.
  directionTo(contact, reach) {
    const place = this.place(contact), normal = new Vector3().fromArray(contact.normal);
    const near = this.trianglesNear([...place], reach).map((t) => this.corners(t));
    const numDirections = 96, goldenAngle = Math.PI * (3 - Math.sqrt(5));
    let best = this.above(), bestScore = -Infinity;
    for (let i = 0; i < numDirections; ++i) {
      const z = 1 - (2 * i + 1) / numDirections, r = Math.sqrt(1 - z * z);
      const direction = new Vector3(r * Math.cos(i * goldenAngle), r * Math.sin(i * goldenAngle), z);
      const start = place.clone().addScaledVector(direction, 0.02 * reach);
      const blocked = near.filter((t) => meets(start, direction, ...t)).length;
      const score = -2 * blocked - Math.abs(Math.abs(normal.dot(direction)) - 0.35) - Math.abs(z - 0.4);
      if (score > bestScore) [best, bestScore] = [direction, score];
    }
    return best;
  }

  lookAt(contact) {
    const reach = this.reachOf(contact);
    this.look(this.place(contact), this.directionTo(contact, reach), reach);
  }
  showWhole() {
    this.look(this.centre, this.above(), this.radius);
  }
  above() { return new Vector3(0.6, -0.65, 0.45).normalize(); }

  // Shows a ball from a direction.
  look(target, direction, radius) {
    this.shown = radius;
    const distance = 1.05 * radius / Math.sin(Math.PI / 12) / Math.min(1, this.camera.aspect);
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.update();
    this.render();
  }

  // Whether surfaces between the viewer and what is looked at are cut away.
  cut(isCut) {
    this.isCut = isCut;
    this.render();
  }

  render() {
    if (!this.positions || !this.shown) return;
    const { camera } = this;
    const distance = camera.position.distanceTo(this.controls.target);
    const depth = this.centre.distanceTo(camera.position) + this.radius;
    camera.near = this.isCut ? Math.max(distance - 1.2 * this.shown, 0.01 * distance) : 0.01 * distance;
    camera.far = Math.max(1.1 * depth, 2 * distance);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.placeLabel();
    // Several changes are drawn once.
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.renderer.render(this.scene, camera);
    });
  }

  // Resolves when what was asked for is drawn.
  drawn() {
    return new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  }

  // Where a contact is in the view, in pixels from its top left corner.
  onScreen(contact) {
    const p = this.place(contact).project(this.camera);
    return new Vector2((p.x + 1) / 2 * this.host.clientWidth, (1 - p.y) / 2 * this.host.clientHeight);
  }

  placeLabel() {
    this.label.hidden = !this.selected;
    if (!this.selected) return;
    const at = this.onScreen(this.selected);
    this.label.dataset.x = at.x;
    this.label.dataset.y = at.y;
    this.label.style.transform = `translate(${at.x + 12}px, ${at.y + 8}px)`;
  }

  pickAt(clientX, clientY) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const click = new Vector2(clientX - box.left, clientY - box.top);
    let nearest = null, least = kPickDistance;
    for (const contact of this.contacts) {
      const distance = this.onScreen(contact).distanceTo(click);
      if (distance < least) [nearest, least] = [contact, distance];
    }
    this.pick(nearest);
  }
}

Viewer.colours = kColours;
window.FclCcdViewer = Viewer;
