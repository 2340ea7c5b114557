// SPDX-License-Identifier: BSD-3-Clause
//
// The data of the page, which page_step.cpp and page_block.cpp write: JSON, and blocks of
// whole numbers as bytes, compressed with zlib, in base64. A block is read when it is
// needed.
'use strict';

// The kinds of contacts.
const kKinds = {
  vf: { words: 'vertex-face', colour: '#e63946' },
  ee: { words: 'edge-edge', colour: '#1d3557' },
  ve: { words: 'vertex-edge', colour: '#f4a261' },
  vv: { words: 'vertex-vertex', colour: '#2a9d8f' },
  crossing: { words: 'crossing', colour: '#7b2cbf' },
};

// The numbers of appendNumbers(): seven bits a byte, the lowest first.
class Numbers {
  constructor(bytes, begin) {
    this.bytes = bytes;
    this.at = begin;
  }
  next() {
    let byte = this.bytes[this.at++];
    if (byte < 128) return (byte >>> 1) ^ -(byte & 1); // most are small
    let rest = 0;
    let weight = 1;
    for (; byte > 127; byte = this.bytes[this.at++], weight *= 128) rest += (byte & 127) * weight;
    rest += byte * weight;
    return rest % 2 ? -(rest + 1) / 2 : rest / 2;
  }
  // Ids, each as the difference to the one before.
  ids(count) {
    const ids = new Int32Array(count);
    let last = 0;
    for (let i = 0; i < count; ++i) ids[i] = last += this.next();
    return ids;
  }
  // The nodes of a frame: all x, then y, then z.
  frame(before, numVertices) {
    const nodes = new Int32Array(3 * numVertices);
    for (let axis = 0; axis < 3; ++axis) {
      let moved = 0;
      for (let v = 0; v < numVertices; ++v) {
        moved += this.next();
        nodes[3 * v + axis] = moved + (before ? before[3 * v + axis] : 0);
      }
    }
    return nodes;
  }
}

async function inflated(element) {
  const text = atob(element.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function jsonOf(className) {
  return Array.from(document.getElementsByClassName(className), (e) => JSON.parse(e.textContent));
}

class RunData {
  constructor() {
    this.summary = jsonOf('summary')[0];
    this.mesh = jsonOf('mesh')[0];
    this.steps = jsonOf('step');
    this.meshBlock = document.getElementsByClassName('mesh-block')[0];
    this.stepBlocks = document.getElementsByClassName('step-block');
    this.blocks = new Map();
    this.frames = new Map();
  }

  // Triangles, free edges, and the nodes of the first frame.
  async loadMesh() {
    const numbers = new Numbers(await inflated(this.meshBlock), 0);
    this.triangles = numbers.ids(3 * this.mesh.triangles);
    this.edges = numbers.ids(2 * this.mesh.edges);
    this.frames.set(0, numbers.frame(null, this.mesh.vertices));
  }

  // Of the i-th step: its first contacts, and for each triangle 0 or from 1 to 255 the
  // first time of its contacts.
  async block(i) {
    if (!this.blocks.has(i)) {
      const bytes = await inflated(this.stepBlocks[i]);
      const [text, times, key] = this.steps[i].sizes;
      this.blocks.set(i, {
        contacts: JSON.parse(new TextDecoder().decode(bytes.subarray(0, text))),
        times: bytes.subarray(text, text + times),
        key: bytes.subarray(text + times, text + times + key),
        motion: bytes.subarray(text + times + key),
      });
    }
    return this.blocks.get(i);
  }

  // The nodes of all vertices in a frame. Each frame is stored as its difference to the
  // one before, and some as they are.
  async frame(i) {
    const { frames, steps } = this;
    let f = i;
    while (!frames.has(f) && !(f < steps.length && steps[f].sizes[2] > 0)) --f;
    if (!frames.has(f)) frames.set(f, new Numbers((await this.block(f)).key, 0).frame(null, this.mesh.vertices));
    for (; f < i; ++f) {
      const { motion } = await this.block(f);
      frames.set(f + 1, new Numbers(motion, 0).frame(frames.get(f), this.mesh.vertices));
    }
    return frames.get(i);
  }

  // The positions at a time of the i-th step, from the origin of the grid.
  async positions(i, time) {
    const from = await this.frame(i);
    const to = await this.frame(i + 1);
    const { spacing } = this.mesh;
    const positions = new Float32Array(from.length);
    for (let i = 0; i < from.length; ++i) positions[i] = spacing * ((1 - time) * from[i] + time * to[i]);
    return positions;
  }

  // The first contacts of the run, each with its step.
  async earliest(count) {
    const found = [];
    for (let i = 0; i < this.steps.length && found.length < count; ++i) {
      if (Object.values(this.steps[i].contacts).every((n) => n === 0)) continue;
      for (const contact of (await this.block(i)).contacts) found.push({ ...contact, index: i });
    }
    return found.slice(0, count);
  }

  // The number of a vertex or a triangle among those of both meshes; -1 for a free edge
  // or a free point.
  idOf(name, numOfA) {
    if (typeof name === 'number') return name;
    return /^b\d+$/.test(name) ? Number(name.slice(1)) + numOfA : -1;
  }
  trianglesOf(contact) {
    return contact.triangles.map((t) => this.idOf(t, this.mesh.triangles_of_a)).filter((t) => t >= 0);
  }
  placeOf(contact) {
    return contact.position.map((x, k) => x - this.mesh.origin[k]);
  }
  colourOf(contact) { return kKinds[contact.kind].colour; }
  isEdge() { return true; } // all sides of triangles
}
