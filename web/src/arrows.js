// Arrows: forces and motions as instances of one shape each, drawn over the parts.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  Group,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  Quaternion,
  Vector3,
} from "three";

const SIDES = 8;
const UP = new Vector3(0, 1, 0);

/** Triangles of a body of revolution about y, from radii and heights, along `path`. */
function lathe(profile) {
  const [positions, index] = [[], []];
  for (const [r, y] of profile) {
    for (let k = 0; k < SIDES; k += 1) {
      const a = (2 * Math.PI * k) / SIDES;
      positions.push(r * Math.cos(a), y, r * Math.sin(a));
    }
  }
  for (let row = 0; row + 1 < profile.length; row += 1) {
    for (let k = 0; k < SIDES; k += 1) {
      const [a, b] = [row * SIDES + k, row * SIDES + ((k + 1) % SIDES)];
      index.push(a, a + SIDES, b, b, a + SIDES, b + SIDES);
    }
  }
  return made(positions, index);
}

function made(positions, index) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(index);
  return geometry;
}

/** An arrow of length 1 along y. */
const straight = () =>
  lathe([
    [0, 0],
    [0.035, 0],
    [0.035, 0.7],
    [0.1, 0.7],
    [0, 1],
  ]);

/** Three quarters of a turn about y, at radius 1, with a head. */
function round() {
  const [positions, index] = [[], []];
  const steps = 28;
  const rings = Array.from({ length: steps + 1 }, (_, k) => [(1.5 * Math.PI * k) / steps, 0.045]);
  const end = 1.5 * Math.PI;
  rings.push([end, 0.13], [end + 0.36, 0]);
  for (const [a, r] of rings) {
    for (let k = 0; k < 6; k += 1) {
      const b = (Math.PI * k) / 3;
      const out = 1 + r * Math.cos(b);
      // a rises from z towards x: a right-handed turn about y
      positions.push(out * Math.sin(a), r * Math.sin(b), out * Math.cos(a));
    }
  }
  for (let row = 0; row + 1 < rings.length; row += 1) {
    for (let k = 0; k < 6; k += 1) {
      const [a, b] = [row * 6 + k, row * 6 + ((k + 1) % 6)];
      index.push(a, b, a + 6, b, b + 6, a + 6);
    }
  }
  return made(positions, index);
}

/** Arrows of one colour, of which `set` shows a list. */
export class Arrows {
  constructor() {
    this.material = new MeshBasicMaterial({
      color: new Color(),
      depthTest: false,
      transparent: true,
      side: 2,
    });
    this.halo = new MeshBasicMaterial({ ...quiet, color: new Color() });
    this.group = new Group();
    this.shapes = { straight: straight(), round: round() };
  }

  /**
   * Show arrows: `straight` and `round` are lists of {at, along, size, wide}; `along` need not
   * be of length 1; `wide` is the size that gives its thickness.
   */
  set(lists) {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      child.dispose();
    }
    for (const [name, list] of Object.entries(lists)) {
      if (!list.length) continue;
      for (const [material, grow, order] of [
        [this.halo, 1.5, 9],
        [this.material, 1, 10],
      ]) {
        if (material === this.halo && (name === "round" || list.length > 400)) continue;
        const mesh = new InstancedMesh(this.shapes[name], material, list.length);
        mesh.frustumCulled = false;
        mesh.renderOrder = order;
        list.forEach((arrow, k) => mesh.setMatrixAt(k, matrix(arrow, name, grow)));
        this.group.add(mesh);
      }
    }
  }

  theme(colour, halo) {
    this.material.color.set(colour);
    this.halo.color.set(halo);
  }
}

const quiet = { depthTest: false, depthWrite: false, transparent: true, opacity: 0.9, side: 2 };

function matrix({ at, along, size, wide }, name, grow) {
  const direction = new Vector3(...along).normalize();
  const turn = new Quaternion().setFromUnitVectors(UP, direction);
  const thick = (wide || size) * grow;
  const scale = name === "round" ? [size, size, size] : [thick, size, thick];
  return new Matrix4().compose(new Vector3(...at), turn, new Vector3(...scale));
}
