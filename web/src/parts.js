// All parts as one mesh with edges, their contact patches, and the texture of their states.

import {
  AlwaysStencilFunc,
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DecrementWrapStencilOp,
  DoubleSide,
  FloatType,
  FrontSide,
  GLSL3,
  Group,
  IncrementWrapStencilOp,
  KeepStencilOp,
  LineSegments,
  Mesh,
  NearestFilter,
  NotEqualStencilFunc,
  Points,
  RGBAFormat,
  ShaderMaterial,
  Vector3,
  Vector4,
} from "three";
import { carried, local, posed, turned } from "./pose.js";
import {
  TEXELS,
  cap,
  edge,
  face,
  flatColour,
  nothing,
  number,
  spot,
  spotFace,
  vertex,
} from "./shaders.js";

const ACROSS = 1024; // texels in a row of the texture
const FEW = 8; // up to this many patches are visible through the parts

export class Parts {
  constructor(page) {
    this.page = page;
    this.count = page.parts.names.length;
    const rows = Math.ceil((this.count * TEXELS) / ACROSS);
    this.data = new Float32Array(4 * ACROSS * rows);
    this.texture = new DataTexture(this.data, ACROSS, rows, RGBAFormat, FloatType);
    this.texture.minFilter = NearestFilter;
    this.texture.magFilter = NearestFilter;
    this.shared = {
      parts: { value: this.texture },
      across: { value: ACROSS },
      planes: { value: [0, 1, 2].map(() => new Vector4(0, 0, 0, 1)) },
      cutting: { value: false },
      dense: { value: 1 },
      accent: { value: new Color() },
      grip: { value: new Color() },
    };
    this.visible = new Uint8Array(this.count).fill(1);
    this.present = new Uint8Array(this.count).fill(1);
    this.gripped = new Uint8Array(this.count);
    this.moving = new Uint8Array(this.count);
    this.selected = new Set();
    this.hovered = -1;
    this.group = new Group();
    this.makeMaterials();
    const [faces, edges] = merged(page);
    this.faces = new Mesh(faces, this.material.face);
    this.veil = new Mesh(faces, this.material.veil);
    this.veil.visible = false;
    this.edges = new LineSegments(edges, this.material.edge);
    this.patches = patches(page, this.material);
    this.cut = new Group();
    ["back", "front", "cap"].forEach((name, k) => {
      const mesh = new Mesh(faces, this.material[name]);
      mesh.renderOrder = k - 3; // first, so that the face of the section hides the faces behind it
      this.cut.add(mesh);
    });
    this.cut.visible = false;
    this.veil.renderOrder = 1;
    this.edges.renderOrder = 2;
    this.group.add(this.faces, this.veil, this.edges, this.patches, this.cut);
    for (const child of [this.faces, this.veil, this.edges, ...this.patches.children, ...this.cut.children]) {
      child.frustumCulled = false; // bounds do not include the motion from the texture
    }
    this.paint(page.parts.colour);
    for (let k = 0; k < this.count; k += 1) {
      this.put(k, 2, 3, k);
      this.put(k, 3, 1, page.parts.table?.[k] ? 2 : page.parts.grounded[k]);
    }
    this.pose(null, 0, 0);
    this.states();
  }

  makeMaterials() {
    const make = (vertexShader, fragmentShader, uniforms, more = {}) =>
      new ShaderMaterial({
        glslVersion: GLSL3,
        vertexShader,
        fragmentShader,
        uniforms: { ...this.shared, ...uniforms },
        ...more,
      });
    const colour = () => ({ value: new Color() });
    const over = { transparent: true, depthWrite: false, depthTest: false };
    const painted = { hatch: colour(), table: colour(), picked: colour(), opacity: { value: 1 } };
    const eye = { eye: { value: new Vector3() } };
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    this.material = {
      face: make(vertex, face, { ...painted, veil: { value: false } }, behind),
      veil: make(vertex, face, { ...painted, veil: { value: true } }, {
        ...behind,
        transparent: true,
        depthWrite: false,
      }),
      edge: make(
        vertex,
        edge,
        { ink: colour(), strength: { value: 0.75 } },
        { transparent: true, depthWrite: false },
      ),
      patch: make(vertex, flatColour, { ink: colour(), strength: { value: 0.4 } }, {
        ...over,
        depthTest: true,
        side: DoubleSide,
      }),
      through: make(vertex, flatColour, { ink: colour(), strength: { value: 0.16 } }, {
        ...over,
        side: DoubleSide,
      }),
      rim: make(vertex, flatColour, { ink: colour(), strength: { value: 0.85 } }, over),
      spot: make(spot, spotFace, { ink: colour(), strength: { value: 0.95 } }, over),
      number: make(vertex, number, {}),
      back: make(vertex, nothing, eye, counting(BackSide, IncrementWrapStencilOp)),
      front: make(vertex, nothing, eye, counting(FrontSide, DecrementWrapStencilOp)),
      cap: make(vertex, cap, eye, {
        side: BackSide,
        stencilWrite: true,
        stencilFunc: NotEqualStencilFunc,
        stencilRef: 0,
        stencilZPass: KeepStencilOp,
      }),
    };
  }

  put(part, row, channel, value) {
    this.data[4 * (TEXELS * part + row) + channel] = value;
  }

  /** Set the colours of the parts: red, green and blue from 0 to 255 for each part. */
  paint(colour) {
    for (let k = 0; k < this.count; k += 1) {
      for (let i = 0; i < 3; i += 1) this.put(k, 2, i, colour[3 * k + i] / 255);
    }
    this.texture.needsUpdate = true;
  }

  /** Place the parts: moved along a motion, and pulled apart. */
  pose(motion, amount, apart) {
    for (let k = 0; k < this.count; k += 1) {
      const [q, p] = posed(this.page.parts, k, motion, amount, apart);
      const at = 4 * TEXELS * k;
      this.data.set(q, at);
      this.data.set(p, at + 4);
    }
    this.texture.needsUpdate = true;
  }

  /** Place the parts by a shift and a rotation about the centre of mass; an entry may be null. */
  carry(shifts, turns) {
    for (let k = 0; k < this.count; k += 1) {
      const [q, p] = carried(this.page.parts, k, shifts[k], turns[k]);
      const at = 4 * TEXELS * k;
      this.data.set(q, at);
      this.data.set(p, at + 4);
    }
    this.texture.needsUpdate = true;
  }

  /** Whether a part is present and not hidden. */
  shown(k) {
    return Boolean(this.visible[k] && this.present[k]);
  }

  /** Whether a part is shown and a point of it, in the frame of the assembly, is not cut away. */
  seen(k, point) {
    const { cutting, planes } = this.shared;
    const beyond = ({ x, y, z, w }) => x * point[0] + y * point[1] + z * point[2] > w;
    return this.shown(k) && !(cutting.value && planes.value.some(beyond));
  }

  /** Write the states of the parts to the texture: hidden, moving, gripped, selected, transparent. */
  states() {
    for (let k = 0; k < this.count; k += 1) {
      this.put(k, 3, 0, this.shown(k) ? 1 : 0);
      const moves = this.moving[k] ? 2 : this.gripped[k] ? 4 : 0;
      this.put(k, 3, 2, (this.selected.has(k) ? 1 : 0) + moves + (k === this.hovered ? 8 : 0));
      const spared = this.sparing && (this.moving[k] || this.selected.has(k));
      this.put(k, 3, 3, this.veil.visible && !spared ? 1 : 0);
    }
    this.texture.needsUpdate = true;
  }

  /** Current centre of mass of part k in the frame of the assembly. */
  centre(k) {
    const rest = this.page.parts.center.subarray(3 * k, 3 * k + 3);
    return this.carried(k, local(this.page.parts, k, rest));
  }

  /** Current position of a point of part k given at rest; without a point, its centre of mass. */
  placeOf(k, rest) {
    return rest ? this.carried(k, local(this.page.parts, k, rest)) : this.centre(k);
  }

  /** A point of the assembly, or with `free` a direction, in the frame of part k as it is posed now. */
  inside(k, point, free = false) {
    const at = 4 * TEXELS * k;
    const [x, y, z, w] = this.data.subarray(at, at + 4);
    const p = free ? [0, 0, 0] : this.data.subarray(at + 4, at + 7);
    return turned([-x, -y, -z, w], [0, 1, 2].map((i) => point[i] - p[i]));
  }

  /** Current position, in the frame of the assembly, of a point in the frame of part k. */
  carried(k, point) {
    const at = 4 * TEXELS * k;
    const [x, y, z, w] = this.data.subarray(at, at + 4);
    const [px, py, pz] = this.data.subarray(at + 4, at + 7);
    const a = 2 * (y * point[2] - z * point[1]);
    const b = 2 * (z * point[0] - x * point[2]);
    const c = 2 * (x * point[1] - y * point[0]);
    return [
      point[0] + w * a + y * c - z * b + px,
      point[1] + w * b + z * a - x * c + py,
      point[2] + w * c + x * b - y * a + pz,
    ];
  }

  /** Whether any part is transparent. */
  get anyFaint() {
    return this.veil.visible;
  }

  /** Cut away half spaces n.x > offset, at most three: pairs of a normal and an offset. */
  section(cuts) {
    const some = cuts.length > 0;
    this.shared.cutting.value = some;
    this.cut.visible = some;
    this.material.number.side = some ? DoubleSide : FrontSide;
    // filled patches would be mistaken for the face of the section
    this.material.patch.visible = !some;
    this.material.through.visible = !some;
    this.shared.planes.value.forEach((plane, k) => (k < cuts.length ? plane.set(...cuts[k][0], cuts[k][1]) : plane.set(0, 0, 0, 1)));
  }

  /** Make all parts transparent by a share; `sparing`: except the moving and the selected parts. */
  seeThrough(share, sparing = false) {
    this.material.face.uniforms.opacity.value = 1 - share;
    this.veil.visible = share > 0;
    this.sparing = sparing;
    this.states();
  }

  /** Position at rest, in the frame of the assembly, of a point in the frame of part k. */
  rest(k, point) {
    const { rotation, position } = this.page.parts;
    const [w, x, y, z] = rotation.subarray(4 * k, 4 * k + 4);
    return turned([x, y, z, w], point).map((c, i) => c + position[3 * k + i]);
  }

  /** Free the memory of the graphics card. */
  dispose() {
    this.texture.dispose();
    for (const mesh of [this.faces, this.edges, ...this.patches.children]) mesh.geometry.dispose();
    for (const material of Object.values(this.material)) material.dispose();
  }

  theme(style) {
    const set = (uniform, name) => uniform.value.set(style(name));
    set(this.shared.accent, "unstable");
    set(this.shared.grip, "grip");
    for (const name of ["hatch", "picked"]) set(this.material.face.uniforms[name], name);
    set(this.material.face.uniforms.table, "stage-floor");
    set(this.material.edge.uniforms.ink, "edge");
    for (const name of ["patch", "through", "rim", "spot"]) set(this.material[name].uniforms.ink, "patch");
  }
}

/** A material that draws nothing and counts its faces in the stencil. */
const counting = (side, op) => ({
  side,
  colorWrite: false,
  depthTest: false,
  depthWrite: false,
  stencilWrite: true,
  stencilFunc: AlwaysStencilFunc,
  stencilZPass: op,
});

/** Merged faces and edges of all parts; a shape is repeated for each of its parts. */
function merged(page) {
  const { shape } = page.parts;
  const total = { vertex: 0, triangle: 0, edge: 0 };
  for (const k of shape) {
    total.vertex += page.shapes[k].positions.length;
    total.triangle += page.shapes[k].triangles.length;
    total.edge += page.shapes[k].edges.length;
  }
  const positions = new Float32Array(total.vertex);
  const part = new Float32Array(total.vertex / 3);
  const triangles = new Uint32Array(total.triangle);
  const edges = new Uint32Array(total.edge);
  let [v, t, e] = [0, 0, 0];
  shape.forEach((which, k) => {
    const form = page.shapes[which];
    positions.set(form.positions, v);
    part.fill(k, v / 3, (v + form.positions.length) / 3);
    for (let i = 0; i < form.triangles.length; i += 1) triangles[t + i] = form.triangles[i] + v / 3;
    for (let i = 0; i < form.edges.length; i += 1) edges[e + i] = form.edges[i] + v / 3;
    v += form.positions.length;
    t += form.triangles.length;
    e += form.edges.length;
  });
  const attributes = {
    position: new BufferAttribute(positions, 3),
    part: new BufferAttribute(part, 1),
  };
  return [triangles, edges].map((index) => geometry(attributes, index));
}

function geometry(attributes, index) {
  const result = new BufferGeometry();
  for (const [name, attribute] of Object.entries(attributes)) result.setAttribute(name, attribute);
  if (index) result.setIndex(new BufferAttribute(index, 1));
  return result;
}

/** Add the rings of round patches and the surfaces between them, on part `side` of each pair. */
function addRound(page, side, positions, owner, triangles, lines) {
  const { parts, round } = page.patches;
  const first = owner.length;
  round.patch.forEach((p, k) => {
    const part = parts[2 * p + side];
    positions.push(...local(page.parts, part, round.points.subarray(3 * k, 3 * k + 3)));
    owner.push(part);
  });
  for (const k of round.triangles) triangles.push(first + k);
  for (const k of round.lines) lines.push(first + k);
}

/** Contact patches on both of their parts: flat patches filled with an outline, lines, points. */
function patches(page, material) {
  const { start, points, parts, kinds, kind } = page.patches;
  const [positions, owner, triangles, lines, spots] = [[], [], [], [], []];
  const curved = new Set(page.patches.round.patch);
  for (const side of [0, 1]) addRound(page, side, positions, owner, triangles, lines);
  for (let p = 0; p + 1 < start.length; p += 1) {
    if (curved.has(p)) continue;
    const count = start[p + 1] - start[p];
    const flat = count > 2 && ["plane", "given"].includes(kinds[kind[p]]);
    for (const part of [parts[2 * p], parts[2 * p + 1]]) {
      const first = owner.length;
      for (let k = start[p]; k < start[p + 1]; k += 1) {
        positions.push(...local(page.parts, part, points.subarray(3 * k, 3 * k + 3)));
        owner.push(part);
      }
      for (let k = 0; k < count; k += 1) {
        if (flat || (count === 2 && k === 0)) lines.push(first + k, first + ((k + 1) % count));
        if (!flat && count !== 2) spots.push(first + k);
        if (flat && k > 1) triangles.push(first, first + k - 1, first + k);
      }
    }
  }
  const attributes = {
    position: new BufferAttribute(new Float32Array(positions), 3),
    part: new BufferAttribute(new Float32Array(owner), 1),
  };
  const group = new Group();
  const filled = geometry(attributes, new Uint32Array(triangles));
  // many patches visible through the parts would hide the picture
  const few = start.length - 1 <= FEW;
  if (few) group.add(new Mesh(filled, material.through));
  material.rim.depthTest = !few;
  group.add(
    new Mesh(filled, material.patch),
    new LineSegments(geometry(attributes, new Uint32Array(lines)), material.rim),
    new Points(geometry(attributes, new Uint32Array(spots)), material.spot),
  );
  group.children.forEach((child, k) => (child.renderOrder = 5 + k));
  return group;
}
