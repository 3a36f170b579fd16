// The film of a plan on the stage of a page: positions, arrows and small pictures of its steps.

import { overhang } from "./fall.js";
import { id } from "./dom.js";
import { forceArrows, motionArrows } from "./overlay.js";
import { turn } from "./pose.js";
import { pictureTime, sceneAt, stepAt } from "./steps.js";

const REACH = 1.9; // a part starts at most this far from its seat [radius of the picture]

export class Film {
  /** `look`: the page with the stage; `plan`: the steps. */
  constructor(look, plan) {
    Object.assign(this, { look, plan, now: null });
    this.count = plan.steps.length;
    this.reach = REACH * look.page.radius;
  }

  /** How much farther the incoming parts of all pictures reach out of the view's box, per axis. */
  overhang() {
    const { parts, extent } = this.look.page;
    const each = this.plan.steps.map((step, k) => {
      const { place } = sceneAt(this.plan, this.pictureAt(k), this.reach).on;
      return overhang(step.parts, parts, extent, step.parts.map(() => place));
    });
    return [0, 1, 2].map((i) => Math.max(0, ...each.map((beyond) => beyond[i])));
  }

  /** Time of the picture of step k, in which its part is close to its seat. */
  pictureAt(k) {
    const { parts } = this.look.page;
    const radius = Math.max(...this.plan.steps[k].parts.map((part) => parts.radius[part]));
    return pictureTime(this.plan, k, radius, this.reach);
  }

  /** The step at a time, and the share of it that is done. */
  stepAt(time) {
    return stepAt(this.plan.steps, time);
  }

  /** Time after one step back (-1) or forward (1), from picture to picture. */
  jumped(time, step) {
    const [k] = this.stepAt(time);
    const here = this.pictureAt(k);
    if (step > 0 && time < here - 1e-6) return here;
    if (step > 0 && k + 1 === this.count) return this.count;
    if (step < 0 && time > here + 1e-6) return here;
    return this.pictureAt(Math.max(0, k + step));
  }

  /** Place the parts and set their states for a time of the film; `apart`: share of the explosion. */
  place(time, apart = 0) {
    const { parts } = this.look.stage;
    const { plan } = this;
    const shifts = this.spread(apart);
    const turns = [];
    parts.moving.fill(0);
    parts.gripped.fill(0);
    parts.present.fill(1);
    for (const { part } of plan.falls) parts.moving[part] = 1;
    if (this.count) {
      const now = sceneAt(plan, time, this.reach);
      const { direction } = plan.steps[now.step];
      for (let k = 0; k < parts.count; k += 1) parts.present[k] = now.present.has(k) ? 1 : 0;
      for (const part of now.gripped) parts.gripped[part] = 1;
      for (const part of now.moving) parts.moving[part] = 1;
      if (now.on) {
        for (const part of plan.steps[now.step].parts) {
          shifts[part] = now.on.place.map((c, i) => c + shifts[part][i]);
          if (now.turn) turns[part] = turn(...direction.map((c) => c * now.turn));
        }
      }
      this.now = now;
    }
    parts.carry(shifts, turns);
    parts.states();
  }

  /** Displacement of each part when the parts are pulled apart: back along its path. */
  spread(apart) {
    const { explode } = this.plan;
    return Array.from({ length: this.look.page.parts.radius.length }, (_, k) =>
      [0, 1, 2].map((i) => apart * explode[3 * k + i]),
    );
  }

  /** Draw the arrows at a time; returns the label of the forces. `small`: without forces. */
  arrows(time, small = false) {
    const { stage, page } = this.look;
    const [k, done] = this.count ? this.stepAt(time) : [0, 1];
    const step = this.plan.steps[k];
    const under = this.count && done < 1;
    stage.motion.set(this.motions(under && step, small));
    const long = 0.5 * page.radius * Number(id("force-size").value);
    const forces = !small && under && id("show-forces").checked && step.support;
    if (!small) id("size-row").hidden = !forces;
    let most = 0;
    if (forces && forces.points.length) {
      const drawn = forceArrows(stage, forces, long);
      most = drawn.most;
      stage.forces.set({ straight: drawn.straight });
    } else stage.forces.set({});
    stage.hands.set(forces ? this.handArrows(step, long, most) : {});
    return most;
  }

  /** Arrows of the part that is being inserted, or of the parts that would fall. */
  motions(step, small) {
    const { stage, page, long } = this.look;
    const falls = step ? step.hands.filter((hand) => hand.motion).slice(0, 1) : this.plan.falls;
    if (!small && id("show-motion").checked && falls.length) {
      const lists = falls.map((fall) => motionArrows(stage, fall.motion, fall.moves, 0.6 * long));
      return {
        straight: lists.flatMap((list) => list.straight),
        round: lists.flatMap((list) => list.round),
      };
    }
    const { on } = this.now || {};
    if (!step || !on || !(on.ahead > 0)) return {};
    const straight = step.parts.map((part) => {
      const wide = Math.max(1.3 * page.parts.radius[part], 0.3 * long);
      const size = Math.min(on.ahead, 2.6 * wide);
      return { at: stage.parts.centre(part), along: on.heading, size, wide: Math.min(wide, 2.5 * size) };
    });
    return { straight };
  }

  /** Arrows of the hand forces, to the scale of the contact forces, at most twice the longest. */
  handArrows(step, long, most) {
    const straight = step.hands
      .filter((hand) => hand.force && Math.hypot(...hand.force) > 0)
      .map((hand) => {
        const share = most ? Math.hypot(...hand.force) / most : 1;
        const size = long * Math.max(0.12, Math.min(2, share));
        return { at: this.look.stage.parts.centre(hand.part), along: hand.force, size, wide: Math.max(0.8 * size, 0.3 * long) };
      });
    return { straight };
  }

  /** Paint the small picture of step k; the caller restores the large picture afterwards. */
  paint(k, canvas) {
    const { stage } = this.look;
    const time = this.pictureAt(k);
    const were = [stage.parts.patches, stage.parts.edges].map((object) => object.visible);
    const { selected } = stage.parts;
    stage.parts.selected = new Set();
    stage.parts.patches.visible = false;
    stage.parts.edges.visible = true;
    this.place(time);
    this.arrows(time, true);
    stage.drawLines([]);
    stage.loads.set({});
    stage.open.set({});
    stage.snap(canvas);
    stage.parts.selected = selected;
    [stage.parts.patches.visible, stage.parts.edges.visible] = were;
  }
}
