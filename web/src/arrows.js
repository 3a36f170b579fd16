// Arrows of forces and motions, drawn over the parts as instances of a few shapes.

import {
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Color,
  FrontSide,
  GLSL3,
  Group,
  InstancedBufferAttribute,
  InstancedMesh,
  Matrix4,
  Quaternion,
  ShaderMaterial,
  Vector3,
} from "three";
import { arrow as arrowVertex, arrowFace } from "./shaders.js";

const SIDES = 8;
const UP = new Vector3(0, 1, 0);

/** Geometry of a body of revolution about y; `profile` lists pairs of radius and height. */
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
  return toGeometry(positions, index);
}

/** A geometry from flat lists of coordinates and of triangle corners. */
function toGeometry(positions, index) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(index);
  return geometry;
}

/** An arrow of length 1 along y. */
export const straight = () =>
  lathe([
    [0, 0],
    [0.035, 0],
    [0.035, 0.7],
    [0.1, 0.7],
    [0, 1],
  ]);

/** A rod of length 1 along y. */
export const rod = () =>
  lathe([
    [0, 0],
    [0.05, 0],
    [0.05, 1],
    [0, 1],
  ]);

/** A ball of radius 1, with its poles along y. */
export const ball = () =>
  lathe(Array.from({ length: 9 }, (_, k) => [Math.sin((Math.PI * k) / 8), -Math.cos((Math.PI * k) / 8)]));

/** An arrow along three quarters of a turn about y, at radius 1. */
export function round() {
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
      index.push(a, a + 6, b, b, a + 6, b + 6);
    }
  }
  return toGeometry(positions, index);
}

/** Arrows, rods or balls of one colour; `set` replaces the list that is shown. */
export class Arrows {
  constructor() {
    this.material = painted(false);
    this.halo = painted(true);
    this.group = new Group();
    this.shapes = { straight: straight(), round: round(), ball: ball(), rod: rod() };
  }

  /**
   * Replace the arrows. `lists` maps the name of a shape to a list of {at, along, size, wide}.
   * `along` need not be of length 1. `size` is the length of a straight arrow and the radius of
   * a ball; `wide` is the length of the arrow that would have this thickness. `tint` blends from
   * the first colour, 0, to the second colour, 1.
   */
  set(lists) {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      child.geometry.dispose();
      child.dispose();
    }
    for (const [name, list] of Object.entries(lists)) {
      if (!list.length) continue;
      for (const [material, grow] of [
        [this.halo, 1.3],
        [this.material, 1],
      ]) {
        if (material === this.halo && list.length > 150) continue;
        const mesh = new InstancedMesh(tinted(this.shapes[name], list), material, list.length);
        mesh.frustumCulled = false;
        list.forEach((arrow, k) => mesh.setMatrixAt(k, matrix(arrow, name, grow)));
        this.group.add(mesh);
      }
    }
  }

  theme(colour, halo, full = colour) {
    this.material.uniforms.ink.value.set(colour);
    this.material.uniforms.full.value.set(full);
    this.halo.uniforms.ink.value.set(halo);
  }
}

/** A shape with a tint for each of its instances. */
function tinted(shape, list) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", shape.getAttribute("position"));
  geometry.setIndex(shape.getIndex());
  const tints = new Float32Array(list.map((arrow) => Math.min(1, arrow.tint || 0)));
  geometry.setAttribute("tint", new InstancedBufferAttribute(tints, 1));
  return geometry;
}

/** Material of an arrow, slightly shaded; `plain`: of its halo, the back faces of a thicker arrow. */
const painted = (plain) =>
  new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: arrowVertex,
    fragmentShader: arrowFace,
    uniforms: { ink: { value: new Color() }, full: { value: new Color() }, plain: { value: plain } },
    side: plain ? BackSide : FrontSide,
  });

function matrix({ at, along, size, wide }, name, grow) {
  const direction = new Vector3(...along).normalize();
  const turn = new Quaternion().setFromUnitVectors(UP, direction);
  const thick = (wide || size) * grow;
  const far = grow > 1 ? size + 0.02 * thick : size;
  const scales = {
    straight: [thick, far, thick],
    rod: [thick, far, thick],
    round: [size, size * grow, size],
    ball: [size * grow, size * grow, size * grow],
  };
  return new Matrix4().compose(new Vector3(...at), turn, new Vector3(...scales[name]));
}
