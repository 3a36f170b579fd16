// The page of a report whose data are replaced while the user changes the assembly.

import { id } from "../dom.js";
import { tailsOf } from "../tails.js";
import { Report } from "../report.js";
import { angleBetween } from "../vector.js";

/** An answer that is still being computed, for `count` parts; `before`: the answer until now. */
export const pending = (count, down, before) => ({
  down,
  verdict: "unknown",
  sentence: "",
  level: null,
  moves: new Uint8Array(count),
  motion: null,
  words: {},
  forces: null,
  force_words: "",
  fall: null,
  assumption: before?.moves.length === count ? before.assumption : null,
});

/** Words of the legend while a change that helps is shown. */
const CHANGED = { grip: " part that is changed", hand: " movement of a part", added: " part after the change" };

export class LiveReport extends Report {
  /** Show an answer for gravity as given; the picture of the parts stays. */
  answered(given) {
    const follows = angleBetween(this.down, this.page.given.down) < 1e-9;
    const complete = Boolean(given.assumption);
    given.assumption ??= this.page.given.assumption; // until the complete answer
    this.page.given = given;
    this.page.probed = null;
    this.found = null;
    this.painted = undefined;
    this.offer();
    this.turn(follows ? given.down : this.down);
    if (complete) this.ladder.tell(given.assumption);
  }

  /** Show the parts of another file, in the first view, with nothing selected or hidden. */
  restart(page) {
    this.select(-1);
    this.ladder.tell(null);
    if (this.stage) {
      this.stage.parts.visible.fill(1);
      for (const name of ["explode", "see-through", "motion"]) id(name).value = "0";
      [this.apart, this.amount] = [0, 0];
    }
    this.down = this.page.given.down;
    this.replace(page);
    if (this.stage) this.stage.home();
  }

  /** Colour the gravity ball by the answers for other directions; null: they are not known. */
  showDirections(directions) {
    const none = { recommended: null, region: null, rays: null, map: null, coincide: false };
    Object.assign(this.page, none, directions ?? {}, { probed: null });
    this.ball.replace(this.page);
    this.found = null;
    this.offer();
    this.turn(this.down);
  }

  /** Take the answer for a single further direction of gravity. */
  showProbe(given) {
    this.page.probed = given;
    if (angleBetween(given.down, this.down) > 1e-7) return;
    this.down = given.down;
    this.turn(given.down);
  }

  pull(wanted, how, step) {
    super.pull(wanted, how, step);
    if (this.found.from === "none") this.unknown?.(this.down);
  }

  /** Set the direction of gravity; a limit case that is shown keeps its motion and its tilt. */
  turn(u, how) {
    super.turn(u, how);
    const { stage, limit } = this;
    if (!stage || !limit) return;
    this.found = { ...this.found, motion: limit.motion, moving: limit.moving, forces: null, fall: null, words: null, farthest: undefined };
    if (limit.down) stage.turnTo(limit.down);
    stage.parts.moving.fill(0);
    for (const k of limit.moving) stage.parts.moving[k] = 1;
    stage.parts.states();
    this.seeThrough();
    this.tellMotion();
    this.repose();
  }

  /** Show a limit case on the stage in place of the answer; null: the answer again. */
  showLimit(limit) {
    this.limit = limit;
    this.added = Boolean(limit?.ghost);
    if (this.added) this.stage.ghost.set(limit.ghost, [0, 0, 0], true);
    this.found = null;
    this.turn(this.down);
    for (const name of ["motion", "play"]) id(name).hidden = !this.found.motion;
    id("motion").disabled = !this.found.motion;
  }

  /** Show the film of a plan on the stage; null: the answer again. */
  showFilm(film) {
    this.film = film;
    this.filmTime = 0;
    if (film || !this.stage) return;
    this.stage.parts.present.fill(1);
    this.stage.parts.gripped.fill(0);
    this.found = null;
    this.turn(this.down);
    this.stage.parts.states();
  }

  repose() {
    const { film, stage } = this;
    if (!film || !stage) {
      super.repose();
      return;
    }
    film.place(this.filmTime);
    film.arrows(this.filmTime);
    this.marks();
    this.names.place();
    stage.draw();
  }

  arrows() {
    super.arrows();
    const { stage, limit } = this;
    const arrow = ({ part, point, along }) => ({ at: point ? stage.parts.placeOf(part, point) : stage.parts.centre(part), along, size: 1.3 * this.long, wide: 1.3 * this.long });
    stage.hands.set({ straight: (limit?.pushes ?? []).map(arrow) });
    this.legend();
  }

  /** List the marks that are drawn; those of a change that helps have other words. */
  legend() {
    super.legend();
    if (!this.stage) return;
    this.keys ??= Object.fromEntries(Object.keys(CHANGED).map((name) => [name, id(`${name}-key`).lastChild.data]));
    const words = this.limit?.changes ? CHANGED : this.keys;
    for (const name of Object.keys(CHANGED)) id(`${name}-key`).lastChild.data = words[name];
  }

  tell() {
    super.tell();
    const turned = angleBetween(this.down, this.page.given.down) > 1e-9;
    const known = this.found.from !== "none";
    if (this.found.from === "probed") id("level").textContent = "equilibrium";
    id("use-gravity").hidden = !turned;
    if (!known) {
      id("verdict").textContent = "Not analysed";
      id("sentence").textContent = "Use this direction of gravity to analyse it, or return to the given direction.";
      id("moving").textContent = "";
    }
    if (this.told) this.told();
  }

  showSelection() {
    super.showSelection();
    if (this.selected_) this.selected_();
  }
}

/** The names that the server uses, and the short names; for data of a scene. */
export function prepareParts(parts) {
  parts.tails = tailsOf(parts.names);
  parts.full_names ??= parts.names;
  return parts;
}
