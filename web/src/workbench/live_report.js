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

export class LiveReport extends Report {
  /** Show an answer for gravity as given; the picture of the parts stays. */
  answered(given) {
    const follows = angleBetween(this.down, this.page.given.down) < 1e-9;
    const complete = Boolean(given.assumption);
    given.assumption ??= this.page.given.assumption; // until the complete answer
    this.page.given = given;
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

  /** Show a direction of gravity that was found by an analysis. */
  recommend(orientation) {
    this.page.recommended = orientation;
    this.page.coincide = false;
    this.offer();
    if (orientation) this.turn(orientation.down, { follow: true });
  }

  tell() {
    super.tell();
    const turned = angleBetween(this.down, this.page.given.down) > 1e-9;
    const known = this.found.from !== "none";
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
