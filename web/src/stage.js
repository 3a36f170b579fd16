// The picture: camera, light, and the assembly turned so that gravity points down.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  ColorManagement,
  Group,
  LineBasicMaterial,
  LineSegments,
  LinearSRGBColorSpace,
  Matrix4,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderTarget,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Arrows } from "./arrows.js";
import { Ghost } from "./ghost.js";
import { Ground } from "./ground.js";
import { Parts } from "./parts.js";
import { PlaceLayer } from "./place_layer.js";
import { sphereView } from "./sphere.js";
import { meet } from "./surface.js";
import { scaled, unit } from "./vector.js";

const WIDE = 30; // vertical angle of view with perspective [deg]
const NARROW = 0.8; // and without: from so far away that parallel lines stay parallel [deg]
const SLOW = 55; // slower pictures switch to plain drawing [ms]
const ROOM = 0.88; // share of the sphere around the parts that is in view [-]
const DOWN = new Vector3(0, -1, 0);

ColorManagement.enabled = false; // the colours of the style are used unchanged

export class Stage {
  constructor(canvas, page) {
    this.canvas = canvas;
    this.page = page;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, stencil: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setClearColor(new Color(0), 0);
    this.camera = new PerspectiveCamera(WIDE, 1, 1, 2);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.scene = new Scene();
    this.root = new Group();
    this.parts = new Parts(page);
    this.motion = new Arrows();
    this.forces = new Arrows();
    this.loads = new Arrows();
    this.open = new Arrows();
    this.hands = new Arrows();
    this.gauge = new Arrows();
    this.straps = new Arrows();
    this.hinges = new Arrows();
    this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.lines.frustumCulled = false;
    this.lines.visible = false;
    this.ghost = new Ghost();
    this.places = new PlaceLayer();
    this.ground = new Ground(page, this.parts);
    this.root.add(this.parts.group, this.ground.mesh, this.lines, this.ghost.group, this.places.group);
    this.scene.add(this.root);
    // arrows are drawn after the parts, with a separate depth buffer, so that they lie on top
    this.over = new Scene();
    this.overRoot = new Group();
    for (const arrows of [this.motion, this.forces, this.loads, this.open, this.hands, this.gauge, this.straps, this.hinges]) {
      this.overRoot.add(arrows.group);
    }
    this.over.add(this.overRoot);
    this.renderer.autoClear = false;
    this.target = new WebGLRenderTarget(1, 1);
    this.drawn = () => {};
    this.begun = () => {}; // called once, as soon as the picture has a size
    this.isPlain = false;
    this.last = -1e9;
    this.pace = 20;
    this.opening = page.planar ? [1.35, 0.25] : [1.22, 0.55]; // polar angle and azimuth of the first view [rad]
    this.extent = page.extent;
    this.upright = upright(page.given.down);
    this.root.quaternion.copy(this.upright);
    this.home();
    new ResizeObserver(() => this.fit()).observe(canvas.parentElement);
    this.fit();
  }

  /** Go to the default view: from the right, in front and above. */
  home() {
    this.controls.target.set(0, 0, 0);
    this.frame(this.camera);
    this.controls.update();
    this.draw();
  }

  /** Half of the vertical angle of view [rad]. */
  get halfAngle() {
    return (this.camera.fov * Math.PI) / 360;
  }

  /** Switch perspective off or on; the parts keep their size in the picture. */
  flatten(flat) {
    const before = Math.tan(this.halfAngle);
    this.camera.fov = flat ? NARROW : WIDE;
    const { target } = this.controls;
    const away = this.camera.position.clone().sub(target).multiplyScalar(before / Math.tan(this.halfAngle));
    this.camera.position.copy(target).add(away);
    this.controls.update();
    this.draw();
  }

  /** Set the nearest and the farthest distance that a camera shows. */
  clip(camera) {
    const { radius } = this.page;
    const away = camera.position.length();
    camera.near = Math.max(radius / 50, away - 30 * radius);
    camera.far = away + 60 * radius;
    camera.updateProjectionMatrix();
  }

  /** Put a camera at the default view, far enough to show the box around the parts. */
  frame(camera, room = ROOM) {
    this.aim(camera, new Spherical(1, ...this.opening), room);
  }

  aim(camera, place, room = ROOM) {
    camera.position.setFromSpherical(place);
    camera.lookAt(0, 0, 0);
    camera.position.setLength(this.reach(camera, room));
  }

  /** Show the assembly from a direction, in the axes of the file: from it towards the assembly. */
  view(direction) {
    const toEye = (v) => new Vector3(...v).applyQuaternion(this.root.quaternion);
    const place = new Spherical().setFromVector3(toEye(direction).normalize());
    const x = toEye([1, 0, 0]);
    // straight from above or below, the x axis of the file points to the right
    if (Math.sin(place.phi) < 1e-3) place.theta = Math.hypot(x.x, x.z) > 1e-3 ? Math.atan2(-x.z, x.x) : 0;
    place.phi = Math.max(1e-4, Math.min(Math.PI - 1e-4, place.phi));
    this.controls.target.set(0, 0, 0);
    this.aim(this.camera, place);
    this.controls.update();
    this.draw();
  }

  /**
   * Bring the parts into the middle of the view, near enough to fill about half of it; `least`:
   * radius of the sphere that is in view at least.
   */
  zoomTo(list, least = 0) {
    const { parts } = this;
    const radius = this.page.parts.radius;
    const at = list.map((k) => parts.centre(k));
    const middle = [0, 1, 2].map((i) => at.reduce((sum, p) => sum + p[i], 0) / at.length);
    const reach = list.reduce((most, k, n) => Math.max(most, radius[k] + Math.hypot(...at[n].map((c, i) => c - middle[i]))), least);
    const away = this.camera.position.clone().sub(this.controls.target);
    const target = new Vector3(...middle).applyQuaternion(this.root.quaternion);
    away.setLength((1.9 * reach) / Math.sin(this.halfAngle) / Math.min(1, this.camera.aspect));
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(away);
    this.controls.update();
    this.draw();
  }

  /** Axes of the file on the screen: each as right, up, and towards the eye. */
  axes() {
    const turn = this.camera.quaternion.clone().invert().multiply(this.root.quaternion);
    return [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => new Vector3(...axis).applyQuaternion(turn).toArray());
  }

  /**
   * Draw the parts of another page in place of the present ones. The view stays, also if the
   * coordinates of the new page have another middle.
   */
  replace(page) {
    const middle = this.page.center && page.center ? page.center.map((c, i) => this.page.center[i] - c) : [0, 0, 0];
    const old = this.parts;
    this.page = page;
    this.parts = new Parts(page);
    this.root.remove(old.group, this.ground.mesh);
    this.ground.dispose();
    this.ground = new Ground(page, this.parts);
    this.root.add(this.parts.group, this.ground.mesh);
    this.parts.edges.visible = !this.isPlain;
    this.parts.shared.dense.value = old.shared.dense.value;
    old.dispose();
    this.extent = page.extent;
    const shift = new Vector3(...middle).applyQuaternion(this.root.quaternion);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.upright = upright(page.given.down);
    this.controls.update();
  }

  /**
   * Distance at which a camera shows the whole box around the parts, in its current orientation;
   * `room`: share of the sphere around the box that stays in view when it turns.
   */
  reach(camera, room = ROOM) {
    const tangent = Math.tan(this.halfAngle);
    const back = camera.quaternion.clone().invert();
    let far = (room * Math.hypot(...this.extent)) / Math.sin(this.halfAngle); // room to turn
    for (let k = 0; k < 8; k += 1) {
      const corner = new Vector3(...this.extent.map((e, i) => ((k >> i) & 1 ? e : -e)));
      corner.applyQuaternion(this.root.quaternion).applyQuaternion(back);
      const wide = Math.abs(corner.x) / (tangent * (camera.aspect || 1));
      far = Math.max(far, corner.z + 1.1 * Math.max(wide, Math.abs(corner.y) / tangent));
    }
    return far;
  }

  /** Apply a change and adapt the distance of the camera; the direction of view stays. */
  refit(change) {
    const before = this.reach(this.camera);
    change();
    const { target } = this.controls;
    const apart = this.camera.position.clone().sub(target);
    this.camera.position.copy(apart.multiplyScalar(this.reach(this.camera) / before).add(target));
    this.controls.update();
    this.draw();
  }

  /** Set the half lengths of the box that the view must show. */
  spread(extent) {
    this.refit(() => (this.extent = extent));
  }

  fit() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    const first = !this.size;
    if (!first && this.size[0] === width && this.size[1] === height) return;
    const turned = !first && this.size[0] < this.size[1] !== width < height; // a phone was turned
    this.size = [width, height];
    this.sharpen();
    const shape = () => {
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    };
    if (turned) this.refit(shape);
    else shape();
    if (first) {
      this.home();
      this.begun();
    }
    this.draw();
  }

  /** Turn the assembly by the smallest rotation that makes a direction point down on the screen. */
  turnTo(direction, exactly = false) {
    this.refit(() => {
      if (exactly) this.root.quaternion.copy(this.upright);
      const now = new Vector3(...direction).applyQuaternion(this.root.quaternion).normalize();
      const turn = new Quaternion().setFromUnitVectors(now, DOWN);
      this.root.quaternion.premultiply(turn).normalize();
    });
  }

  orbit(azimuth, polar, nearer = 1) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const place = new Spherical().setFromVector3(offset);
    place.theta += azimuth;
    place.phi = Math.max(0.02, Math.min(Math.PI - 0.02, place.phi + polar));
    place.radius *= nearer;
    this.camera.position.setFromSpherical(place).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  /** The part under a point of the canvas [CSS px], or -1. */
  pick(x, y) {
    const { camera } = this;
    const [width, height] = this.size;
    const dense = this.renderer.getPixelRatio();
    camera.setViewOffset(width * dense, height * dense, x * dense, y * dense, 1, 1);
    const [number] = this.numbers(1, 1);
    camera.clearViewOffset();
    return number - 1;
  }

  shapeOf(part) {
    return this.page.shapes[this.page.parts.shape[part]];
  }

  /** Point of a part under a point of the canvas [CSS px]: {part, local, normal}, or null. */
  hit(x, y) {
    const part = this.pick(x, y);
    if (part < 0) return null;
    const [width, height] = this.size;
    const to = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(this.camera);
    this.root.updateMatrixWorld();
    const from = this.root.worldToLocal(this.camera.position.clone()).toArray();
    const end = this.root.worldToLocal(to).toArray();
    const along = end.map((c, i) => c - from[i]);
    const { parts } = this;
    const seen = (point) => parts.seen(part, parts.carried(part, point));
    const found = meet(this.shapeOf(part), parts.inside(part, from), parts.inside(part, along, true), seen);
    return found && { part, local: found.point, normal: found.normal };
  }

  /** Indices of the parts that are visible in a rectangle of the canvas [CSS px]. */
  within([left, top, right, bottom]) {
    const cell = 3;
    const { cells, width, height } = this.numbered(cell);
    const found = new Set();
    const [from, to] = [Math.max(0, Math.floor(left / cell)), Math.min(width - 1, Math.floor(right / cell))];
    for (let row = Math.max(0, Math.floor(top / cell)); row <= Math.min(height - 1, bottom / cell); row += 1) {
      for (let k = from; k <= to; k += 1) if (cells[row * width + k]) found.add(cells[row * width + k] - 1);
    }
    return [...found];
  }

  /** Number of cells in which each part is visible, for the parts that a test admits. */
  counted(admits, cell = 5) {
    const { parts } = this;
    const { present } = parts;
    parts.present = present.map((here, k) => (here && admits(k) ? 1 : 0));
    parts.states();
    const { cells } = this.numbered(cell);
    parts.present = present;
    parts.states();
    const counts = new Uint32Array(parts.count);
    for (const number of cells) if (number) counts[number - 1] += 1;
    return counts;
  }

  /** Part numbers, counted from 1, in cells of `cell` CSS pixels; the top row first. */
  numbered(cell) {
    const [width, height] = this.size.map((size) => Math.max(1, Math.floor(size / cell)));
    this.scene.updateMatrixWorld();
    const upward = this.numbers(width, height);
    const cells = new Uint32Array(width * height);
    for (let row = 0; row < height; row += 1) {
      const from = (height - 1 - row) * width;
      cells.set(upward.subarray(from, from + width), row * width);
    }
    return { cells, width, height };
  }

  /** Part numbers, counted from 1, in `width` x `height` pixels; the bottom row first. */
  numbers(width, height) {
    const { renderer, camera, parts } = this;
    const hidden = [this.ground.mesh, parts.veil, parts.edges, parts.patches, parts.cut, this.lines, this.ghost.group, this.places.group];
    const were = hidden.map((object) => object.visible);
    hidden.forEach((object) => (object.visible = false));
    this.clip(camera);
    parts.faces.material = parts.material.number;
    this.target.setSize(width, height);
    renderer.setRenderTarget(this.target);
    renderer.clear();
    renderer.render(this.scene, camera);
    const bytes = new Uint8Array(4 * width * height);
    renderer.readRenderTargetPixels(this.target, 0, 0, width, height, bytes);
    renderer.setRenderTarget(null);
    parts.faces.material = parts.material.face;
    hidden.forEach((object, k) => (object.visible = were[k]));
    return Uint32Array.from({ length: width * height }, (_, k) =>
      bytes[4 * k + 3] ? 1 + bytes[4 * k] + 256 * (bytes[4 * k + 1] + 256 * bytes[4 * k + 2]) : 0,
    );
  }

  /** Position of a point of the assembly on the canvas [CSS px]; null behind the camera. */
  onScreen(point) {
    const at = new Vector3(...point).applyMatrix4(this.root.matrixWorld).project(this.camera);
    if (at.z > 1) return null;
    return [((at.x + 1) / 2) * this.size[0], ((1 - at.y) / 2) * this.size[1]];
  }

  /** Radius of a part in the picture [CSS px]. */
  sizeOnScreen(k) {
    const away = new Vector3(...this.parts.centre(k)).applyMatrix4(this.root.matrixWorld).distanceTo(this.camera.position);
    return (this.page.parts.radius[k] / away / Math.tan(this.halfAngle)) * (this.size[1] / 2);
  }

  /**
   * The point under a point of the canvas [CSS px], in the plane through `through` that is parallel
   * to the screen; both points are in the frame of the assembly.
   */
  underPlane([x, y], through) {
    const [width, height] = this.size;
    const depth = new Vector3(...through).applyMatrix4(this.root.matrixWorld).project(this.camera).z;
    const at = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, depth).unproject(this.camera);
    return this.root.worldToLocal(at).toArray();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = 0;
      this.keepPace();
      if (this.isFlushed()) this.render();
      else this.draw();
    });
  }

  /** Draw plain pictures while the view moves if full pictures are slow, full ones at rest. */
  keepPace() {
    const now = performance.now();
    const since = now - this.last;
    this.last = now;
    if (since < 400) this.pace = 0.6 * this.pace + 0.4 * since;
    if (since < 400 && this.pace > SLOW && !this.isPlain) this.flush();
    clearTimeout(this.rest);
    if (this.isPlain) {
      this.rest = setTimeout(() => {
        this.plain(false);
        this.last = -1e9; // the picture at rest does not count for the pace
        this.draw();
      }, 250);
    }
  }

  /** Switch to plain pictures after the pictures that are being drawn: a canvas whose size changes waits for them. */
  flush() {
    const gl = this.renderer.getContext();
    this.fence ??= gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
  }

  /** Whether no picture has to be awaited before the next one. */
  isFlushed() {
    if (!this.fence) return true;
    const gl = this.renderer.getContext();
    if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(this.fence);
    this.fence = null;
    this.plain(true);
    return true;
  }

  /** Switch plain pictures on or off: half the resolution, without edges. */
  plain(on) {
    if (this.isPlain === on) return;
    this.isPlain = on;
    this.parts.edges.visible = !on;
    this.sharpen();
  }

  sharpen() {
    const dense = Math.min(window.devicePixelRatio || 1, 2) * (this.isPlain ? 0.5 : 1);
    this.renderer.setPixelRatio(dense);
    this.renderer.setSize(...this.size, false);
    this.parts.shared.dense.value = dense;
  }

  /** Draw immediately, instead of with the next animation frame. */
  render() {
    cancelAnimationFrame(this.waiting);
    this.waiting = 0;
    if (!this.size) return;
    this.shoot(this.camera);
    this.drawn();
  }

  shoot(camera) {
    this.clip(camera);
    this.scene.updateMatrixWorld();
    this.ground.shade(this.renderer, this.isPlain);
    this.overRoot.quaternion.copy(this.root.quaternion);
    const { material } = this.parts;
    for (const name of ["cap", "back", "front"]) this.root.worldToLocal(material[name].uniforms.eye.value.copy(camera.position));
    this.renderer.clear();
    this.renderer.render(this.scene, camera);
    this.renderer.clearDepth();
    this.renderer.render(this.over, camera);
  }

  /** Draw the current scene from the default view into a small canvas. */
  snap(canvas) {
    const { width, height } = canvas;
    const camera = new PerspectiveCamera(this.camera.fov, width / height, 1, 2);
    this.frame(camera, 0);
    this.shootInto(canvas, camera);
  }

  /** Draw the view of a camera into a canvas; `fine`: canvas pixels per CSS pixel. */
  shootInto(canvas, camera, fine = 1) {
    const { width, height } = canvas;
    camera.updateMatrixWorld();
    const target = new WebGLRenderTarget(width, height, { samples: 4, stencilBuffer: true });
    const { dense } = this.parts.shared;
    const was = dense.value;
    dense.value = fine;
    this.renderer.setRenderTarget(target);
    this.shoot(camera);
    const pixels = new Uint8Array(4 * width * height);
    this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
    this.renderer.setRenderTarget(null);
    target.dispose();
    dense.value = was;
    const picture = new ImageData(width, height);
    for (let row = 0; row < height; row += 1) {
      const from = 4 * width * (height - 1 - row);
      picture.data.set(pixels.subarray(from, from + 4 * width), 4 * width * row);
    }
    canvas.getContext("2d").putImageData(picture, 0, 0);
  }

  /** Draw lines between pairs of points, in the frame of the assembly. */
  drawLines(points) {
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
    this.lines.visible = points.length > 0;
  }

  /** Take over the colours of the page's style. */
  theme(style) {
    this.parts.theme(style);
    this.motion.theme(style("unstable"), style("surface"));
    this.forces.theme(style("force"), style("surface"), style("limit"));
    this.hands.theme(style("grip"), style("surface"));
    this.loads.theme(style("ink"), style("surface"));
    this.straps.theme(style("ink"), style("surface"));
    this.hinges.theme(style("ink"), style("surface"));
    this.gauge.theme(style("link"), style("surface"));
    this.open.theme(style("open"), style("ink"));
    this.lines.material.color.set(style("soft"));
    this.ghost.theme(style);
    this.ground.theme(style);
    this.places.theme(style);
    this.draw();
  }
}

/** The rotation that shows the assembly upright for a direction of gravity, x to the right. */
function upright(down) {
  const above = scaled(unit(down), -1);
  const { right, front } = sphereView(above, 0, 0);
  const axes = [right, above, front].map((v) => new Vector3(...v));
  return new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(...axes)).invert();
}
