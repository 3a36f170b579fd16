// The gravity ball: the sphere of directions of gravity with the stable region and an arrow.
// The ball is in the frame of the assembly; the arrow points in the direction of gravity.

import { innerOf, outerOf } from "./answer.js";
import { along, arcs, contains, isThin, outline } from "./cone.js";
import { ramp, rampOf, rgb, themeOf } from "./colours.js";
import { deepest, farthest } from "./map.js";
import { paintRests, restAt } from "./rests.js";
import { eyeFor, inPlane, onDisc, sphereView, underPoint } from "./sphere.js";
import { angleBetween, cross, dot, norm, scaled, turnedAbout, unit, without } from "./vector.js";

const EDGE = 30; // margin around the disc [CSS px]
const KNOB = 23; // names of axes keep this distance from the knob of gravity [CSS px]
const REACH = 24; // a pointer within this distance takes hold of the knob [CSS px]
const SEEN_DEG = 0.5; // a narrower gap between inner and outer cone is drawn as one line [deg]
const STEP = Math.PI / 90; // turn per arrow key [rad]; a tenth of it with Shift

export class Ball {
  /** `turned(direction, how, step)` is called when the user moves the arrow; `how`: pointer or key. */
  constructor(canvas, page, turned) {
    Object.assign(this, { canvas, turned });
    this.marked = () => {}; // called with the words for the letters that are drawn
    this.eye = page.planar ? [0, 0] : [0.55, -0.42];
    this.down = page.given.down;
    this.replace(page);
    this.layer = document.createElement("canvas");
    canvas.addEventListener("pointerdown", (e) => this.press(e));
    canvas.addEventListener("pointermove", (e) => this.move(e));
    canvas.addEventListener("pointerup", (e) => this.release(e));
    canvas.addEventListener("pointercancel", () => (this.drag = null));
    canvas.addEventListener("keydown", (e) => this.key(e));
  }

  /** Show the region and the map of other data; the side that is seen stays. */
  replace(page) {
    this.page = page;
    this.above = scaled(unit(page.given.down), -1);
    this.most = page.map ? deepest(page.map) || 1 : 1;
    this.stale = true;
  }

  get view() {
    return sphereView(this.above, ...this.eye);
  }

  /** Set the arrow to a direction; with `follow`, the ball turns so that the arrow is visible. */
  set(direction, follow = false) {
    this.down = direction;
    if (follow && !this.page.planar && dot(direction, this.view.front) < 0.12) {
      this.eye = eyeFor(this.above, direction);
      this.stale = true;
    }
    this.draw();
  }

  /** Position of a direction on the canvas [CSS px], and whether it is on the near side. */
  place(direction) {
    const [x, y, z] = onDisc(this.view, direction);
    const { middle, radius } = this.frame();
    return { x: middle + radius * x, y: middle - radius * y, front: z >= 0 };
  }

  frame() {
    const side = this.canvas.clientWidth || 260;
    return { side, middle: side / 2, radius: side / 2 - EDGE };
  }

  under(event) {
    const box = this.canvas.getBoundingClientRect();
    const { middle, radius } = this.frame();
    const x = (event.clientX - box.left - middle) / radius;
    const y = -(event.clientY - box.top - middle) / radius;
    const direction = underPoint(this.view, x, y);
    return { x, y, direction: this.page.planar ? inPlane(direction) : direction };
  }

  press(event) {
    if (event.button) return;
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const box = this.canvas.getBoundingClientRect();
    const knob = this.place(this.down);
    const away = Math.hypot(event.clientX - box.left - knob.x, event.clientY - box.top - knob.y);
    const holds = away < REACH && knob.front;
    this.drag = { holds, at: [event.clientX, event.clientY], far: 0, eye: [...this.eye] };
    event.preventDefault();
  }

  move(event) {
    if (!this.drag) return this.point(event);
    const [x, y] = [event.clientX - this.drag.at[0], event.clientY - this.drag.at[1]];
    this.drag.far = Math.max(this.drag.far, Math.hypot(x, y));
    if (this.drag.holds) {
      this.turned(this.under(event).direction, "pointer");
    } else if (!this.page.planar && this.drag.far > 3) {
      const { radius } = this.frame();
      const lift = this.drag.eye[1] + y / radius;
      this.eye = [this.drag.eye[0] - x / radius, Math.max(-1.5, Math.min(1.5, lift))];
      this.stale = true;
      this.draw();
    }
  }

  /** Show the description of a place of rest under the pointer as the title of the canvas. */
  point(event) {
    const { x, y, direction } = this.under(event);
    const rest = Math.hypot(x, y) <= 1.05 ? restAt(this.rests, direction) : null;
    this.canvas.title = rest ? rest.words : "";
  }

  get rests() {
    return this.page.region?.rests ?? [];
  }

  release(event) {
    if (!this.drag) return;
    const clicked = !this.drag.holds && this.drag.far <= 3;
    const held = this.drag.holds;
    this.drag = null;
    const { x, y, direction } = this.under(event);
    if (clicked && Math.hypot(x, y) <= 1.05) this.turned(direction, "pointer");
    else if (held) this.set(this.down, true);
  }

  key(event) {
    const { up, right, front } = this.view;
    const step = event.shiftKey ? STEP / 10 : STEP;
    const ways = {
      ArrowLeft: scaled(right, -1),
      ArrowRight: right,
      ArrowUp: up,
      ArrowDown: scaled(up, -1),
    };
    const way = ways[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    // along the great circle that starts in this direction; at the edge, on to the far side
    let ahead = without(way, this.down);
    if (this.page.planar) ahead = without(ahead, [0, 1, 0]);
    if (norm(ahead) < 1e-3) ahead = without(scaled(front, -1), this.down);
    if (this.page.planar && norm(without(ahead, [0, 1, 0])) < 1e-3) {
      ahead = cross([0, 1, 0], this.down);
    }
    this.turned(turnedAbout(this.down, unit(cross(this.down, ahead)), step), "key", step);
  }

  draw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = 0;
      this.paint();
    });
  }

  paint() {
    const { side } = this.frame();
    const dense = Math.min(window.devicePixelRatio || 1, 2);
    const pixels = Math.round(side * dense);
    if (this.canvas.width !== pixels || this.canvas.height !== pixels) {
      this.canvas.width = pixels;
      this.canvas.height = pixels;
      this.stale = true;
    }
    const style = themeOf(this.canvas);
    const key = style("surface") + style("stable");
    if (this.key_ !== key) {
      this.key_ = key;
      this.stale = true;
    }
    if (this.stale && !this.page.planar) this.paintLayer(dense, style);
    this.stale = false;
    const c = this.canvas.getContext("2d");
    c.setTransform(dense, 0, 0, dense, 0, 0);
    c.clearRect(0, 0, side, side);
    this.paintArrow(c, style, false);
    if (this.page.planar) this.paintRing(c, style);
    else c.drawImage(this.layer, 0, 0, side, side);
    this.paintAxes(c, style);
    this.paintRegion(c, style);
    paintRests(c, this.rests, (u) => this.onCanvas(u), style);
    this.paintMarks(c, style);
    this.paintArrow(c, style, true);
  }

  /** Paint the disc pixel by pixel: the stable region, or a colour for the instability. */
  paintLayer(dense, style) {
    const { side, middle, radius } = this.frame();
    // half the resolution while the ball is dragged or if the map has many vertices; the arcs
    // of the boundary are drawn over it, exactly at any resolution
    const many = this.page.map && this.page.map.vertices.length > 180;
    const fine = ((this.drag && !this.drag.holds) || many ? 0.5 : 1) * dense;
    const pixels = Math.round(side * fine);
    this.layer.width = pixels;
    this.layer.height = pixels;
    const c = this.layer.getContext("2d");
    const image = c.createImageData(pixels, pixels);
    const { right, up, front } = this.view;
    const paint = this.painter(style, 1 / (radius * fine));
    const n = [0, 0, 0];
    for (let j = 0; j < pixels; j += 1) {
      const y = -((j + 0.5) / fine - middle) / radius;
      for (let i = 0; i < pixels; i += 1) {
        const x = ((i + 0.5) / fine - middle) / radius;
        const r = x * x + y * y;
        if (r > 1.03) continue;
        const z = Math.sqrt(Math.max(0, 1 - r));
        for (let k = 0; k < 3; k += 1) n[k] = x * right[k] + y * up[k] + z * front[k];
        const colour = paint(n);
        const light = 0.8 + 0.2 * Math.min(1, 0.55 * z + 0.35 * y - 0.25 * x + 0.45);
        const edge = Math.max(0, Math.min(1, (1 - Math.sqrt(r)) * radius * fine + 0.5));
        const at = 4 * (j * pixels + i);
        for (let k = 0; k < 3; k += 1) image.data[at + k] = colour[k] * light;
        image.data[at + 3] = 244 * edge;
      }
    }
    c.putImageData(image, 0, 0);
  }

  /** A function from direction to colour; `pixel`: angle of a pixel [rad], for smooth edges. */
  painter(style, pixel) {
    const { region, map, planar } = this.page;
    const [stable, table] = [rgb(style("stable-fill")), rampOf(style)];
    // without a map the degree of instability is unknown: one plain colour
    const plain = region && region.outside === "unstable" ? "unstable-fill" : "blank";
    const blank = rgb(style(plain));
    const solid = region && region.dimension === 3 && !isThin(region, planar);
    const facets = solid ? innerOf(region).facets : [];
    const outer = region && region.inner ? outerOf(region).facets : null;
    const between = rgb(style("undecided-fill"));
    const out = [0, 0, 0];
    const cover = (qs, n) => {
      let least = Infinity;
      for (const q of qs) least = Math.min(least, q[0] * n[0] + q[1] * n[1] + q[2] * n[2]);
      return Math.max(0, Math.min(1, least / pixel + 0.5));
    };
    return (n) => {
      let base = blank;
      if (planar && region && contains(innerOf(region), n)) base = stable;
      else if (map) base = ramp(farthest(map.vertices, n)[1] / map.mass / this.most, table);
      const middle = outer ? cover(outer, n) : 0;
      const inner = solid ? cover(facets, n) : 0;
      for (let k = 0; k < 3; k += 1) {
        const under = base[k] + middle * (between[k] - base[k]);
        out[k] = under + inner * (stable[k] - under);
      }
      return out;
    };
  }

  /** Paint the directions of a planar assembly: a circle, coloured along its edge. */
  paintRing(c, style) {
    const { middle, radius } = this.frame();
    const paint = this.painter(style, 1e-6);
    c.lineWidth = 12;
    for (let k = 0; k < 180; k += 1) {
      const [a, b] = [(k * Math.PI) / 90, ((k + 1.1) * Math.PI) / 90];
      const colour = paint([Math.cos(a), 0, Math.sin(a)]);
      c.strokeStyle = `rgb(${colour.map(Math.round).join()})`;
      c.beginPath();
      c.arc(middle, middle, radius, -a, -b, true);
      c.stroke();
    }
  }

  /** Position for the name of an axis: as wanted, or beside the knob of gravity if it would cover the name. */
  beside(wanted, point) {
    const { side } = this.frame();
    const [x, y, z] = this.onCanvas(this.down);
    const clear = ([u, v]) =>
      (z < 0 || Math.hypot(u - x, v - y) > KNOB) && Math.min(u, v, side - u, side - v) > 8;
    const near = Array.from({ length: 16 }, (_, k) => {
      const angle = (Math.PI * k) / 8;
      return [x + 1.05 * KNOB * Math.cos(angle), y + 1.05 * KNOB * Math.sin(angle)];
    });
    near.sort((a, b) => Math.hypot(a[0] - wanted[0], a[1] - wanted[1]) - Math.hypot(b[0] - wanted[0], b[1] - wanted[1]));
    return [wanted, ...near].find(clear) || point;
  }

  paintAxes(c, style) {
    const { middle, radius } = this.frame();
    c.font = "600 12px system-ui, sans-serif";
    c.textAlign = "center";
    c.textBaseline = "middle";
    "xyz".split("").forEach((name, k) => {
      for (const sign of [1, -1]) {
        const axis = [0, 0, 0];
        axis[k] = sign;
        const [x, y, z] = onDisc(this.view, axis);
        if (z < -0.02 || (this.page.planar && k === 1)) continue;
        const [px, py] = [middle + radius * x, middle - radius * y];
        c.fillStyle = style("ink");
        c.beginPath();
        c.arc(px, py, 2, 0, 2 * Math.PI);
        c.fill();
        const out = 13 / Math.max(Math.hypot(x, y), 0.25);
        const text = `${sign > 0 ? "+" : "−"}${name}`;
        halo(c, text, ...this.beside([px + out * x, py - out * y], [px, py]), style);
      }
    });
  }

  /** Paint the boundary of the stable region as exact arcs, dashed on the far side. */
  paintRegion(c, style) {
    if (!this.page.region) return;
    const { region } = this.page;
    if (region.inner && region.gap_deg > SEEN_DEG) {
      this.paintArcs(c, outline(region.facets), [[style("undecided"), 1.5, true]]);
    }
    const all = arcs(region);
    this.paintArcs(c, all, [
      [style("stable"), 1.5, false],
      [style("stable-edge"), 5.5, true],
      [style("stable"), 3, true],
    ]);
    for (const arc of all) if (!arc.angle) this.dot(c, arc.u, style);
  }

  /** Paint arcs in several strokes, each [colour, width, on the near side]; the far side is dashed. */
  paintArcs(c, all, strokes) {
    const lines = all.filter((arc) => arc.angle).map((arc) => {
      const count = Math.max(2, Math.ceil(arc.angle / 0.02));
      return Array.from({ length: count + 1 }, (_, k) =>
        this.onCanvas(along(arc, (k * arc.angle) / count)),
      );
    });
    c.lineCap = "round";
    c.lineJoin = "round";
    for (const [colour, width, front] of strokes) {
      c.strokeStyle = colour;
      c.lineWidth = width;
      c.setLineDash(front ? [] : [3, 5]);
      c.beginPath();
      for (const points of lines) {
        let drawing = false;
        for (const [x, y, z] of points) {
          const seen = front ? z >= -0.01 : z < 0.01;
          if (seen && drawing) c.lineTo(x, y);
          else if (seen) c.moveTo(x, y);
          drawing = seen;
        }
      }
      c.stroke();
    }
    c.setLineDash([]);
  }

  onCanvas(u) {
    const { middle, radius } = this.frame();
    const [x, y, z] = onDisc(this.view, u);
    return [middle + radius * x, middle - radius * y, z];
  }

  dot(c, u, style) {
    const [x, y, z] = this.onCanvas(u);
    c.fillStyle = z >= 0 ? style("stable") : "transparent";
    c.strokeStyle = z >= 0 ? style("stable-edge") : style("stable");
    c.lineWidth = 2;
    c.setLineDash(z >= 0 ? [] : [2, 3]);
    c.beginPath();
    c.arc(x, y, 7, 0, 2 * Math.PI);
    c.fill();
    c.stroke();
    c.setLineDash([]);
  }

  /** Mark the given and the recommended direction with the letters G and R. */
  paintMarks(c, style) {
    const drawn = [];
    for (const [name, letter] of [
      ["given", "G"],
      ["recommended", "R"],
    ]) {
      const known = this.page[name];
      const same = name === "recommended" && known && angleBetween(known.down, this.page.given.down);
      if (!known || (name === "recommended" && same < 0.12)) continue;
      const [x, y, z] = this.onCanvas(known.down);
      if (z < 0 || angleBetween(known.down, this.down) < 0.14) continue;
      c.font = "700 12px system-ui, sans-serif";
      halo(c, letter, x + 13, y - 11, style);
      c.strokeStyle = style("ink");
      c.lineWidth = 1.5;
      c.strokeRect(x - 4, y - 4, 8, 8);
      drawn.push(`${letter} ${name}`);
    }
    this.marked(drawn);
  }

  /** Paint the arrow of gravity; `above`: whether this pass paints over the ball or under it. */
  paintArrow(c, style, above) {
    const { middle } = this.frame();
    const [x, y, z] = this.onCanvas(this.down);
    if (z >= -0.001 !== above) {
      if (!above) return;
      // behind the ball: an outline shows through
      c.strokeStyle = style("ink");
      c.lineWidth = 1.5;
      c.setLineDash([3, 3]);
      c.beginPath();
      c.arc(x, y, 9, 0, 2 * Math.PI);
      c.stroke();
      c.setLineDash([]);
      return;
    }
    c.lineCap = "round";
    for (const [colour, width, size] of [
      [style("surface"), 7, 12],
      [style("ink"), 3.5, 10.5],
    ]) {
      c.strokeStyle = colour;
      c.fillStyle = colour;
      c.lineWidth = width;
      c.beginPath();
      c.moveTo(middle, middle);
      c.lineTo(x, y);
      c.stroke();
      c.beginPath();
      c.arc(x, y, size, 0, 2 * Math.PI);
      c.fill();
    }
    c.font = "700 12px system-ui, sans-serif";
    c.textAlign = "center";
    c.textBaseline = "middle";
    c.fillStyle = style(this.tone || "soft");
    c.beginPath();
    c.arc(x, y, 8.5, 0, 2 * Math.PI);
    c.fill();
    c.fillStyle = style("surface");
    c.fillText("g", x, y - 0.5);
  }
}

/** Text with a light outline, readable on any background. */
function halo(c, text, x, y, style) {
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.lineJoin = "round";
  c.lineWidth = 3;
  c.strokeStyle = style("surface");
  c.strokeText(text, x, y);
  c.fillStyle = style("ink");
  c.fillText(text, x, y);
}
