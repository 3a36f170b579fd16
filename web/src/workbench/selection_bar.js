// The bar beside the selected part: the actions that users need most, also by a right click.

import { id } from "../dom.js";
import { button } from "./entries.js";

const STILL = 4; // a right button that moves less than this opens the bar [CSS px]
const MARGIN = 8; // distance of the bar from the edges of the picture [CSS px]
const ASIDE = 22; // least distance of the bar from the middle of the part [CSS px]

export class SelectionBar {
  constructor(bench) {
    Object.assign(this, { bench, joining: -1, pinned: null });
    const { report, parts } = bench;
    this.box = document.createElement("div");
    this.box.id = "selected-bar";
    this.box.setAttribute("role", "toolbar");
    this.box.setAttribute("aria-label", "selected parts");
    this.hold = button("Hold", () => parts.hold(), "hold or release (h)");
    this.join = button("Join with…", () => this.startJoin(), "join with a part that you click next (j)");
    this.leave = button("Leave out", () => parts.leaveOut(), "leave out (x)");
    this.material = button("Material…", () => id("do-material").focus(), "material, density, mass and load");
    this.box.append(this.hold, this.join, this.leave, this.material, button("Hide others", () => report.isolate(), "show the selected parts alone (i); a shows all"));
    id("picture").parentElement.append(this.box);
    this.listen(id("picture"));
    this.tell();
  }

  listen(canvas) {
    let from = null;
    canvas.addEventListener("pointerdown", (e) => {
      from = [e.clientX, e.clientY];
      this.pinned = null;
      this.place();
    });
    canvas.addEventListener("contextmenu", (e) => {
      e.preventDefault();
      if (!from || Math.hypot(e.clientX - from[0], e.clientY - from[1]) >= STILL) return;
      const { report } = this.bench;
      const box = canvas.getBoundingClientRect();
      const at = [e.clientX - box.left, e.clientY - box.top];
      const part = report.stage.pick(...at);
      if (part < 0) return;
      this.pinned = at;
      if (report.selection.has(part)) this.place();
      else report.select(part);
    });
  }

  /** Wait for the part to join with the selected part; with two selected parts, join them. */
  startJoin() {
    const { report, parts } = this.bench;
    if (report.selection.size > 1) {
      parts.join();
      return;
    }
    this.joining = report.selected;
    this.box.hidden = true; // so that it covers no part
    this.bench.note(`Click the part to join with ${report.page.parts.tails[this.joining]}; Escape ends this.`, false);
  }

  /** Join the part that was selected first with the part that is selected now. */
  takeSecond() {
    const { report } = this.bench;
    const first = this.joining;
    if (first < 0 || report.selected === first) return;
    this.joining = -1;
    this.bench.note("");
    if (report.selection.size === 1) {
      report.choose([first, report.selected]);
      this.bench.parts.join();
    }
  }

  /** Show the actions that apply to the selection. */
  tell() {
    const { report } = this.bench;
    this.takeSecond();
    this.box.hidden = !report.selection.size || this.joining >= 0;
    if (this.box.hidden) return;
    this.hold.textContent = id("do-hold").textContent;
    this.hold.hidden = id("do-hold").hidden;
    this.leave.hidden = id("do-leave-out").hidden;
    this.join.hidden = report.selection.size > 2;
    this.join.textContent = report.selection.size === 2 ? "Join" : "Join with…";
    this.place();
  }

  /** Keep the bar beside the part, inside the picture. */
  place() {
    if (this.box.hidden) return;
    const { stage, selected } = this.bench.report;
    const seen = this.pinned ?? (stage.parts.shown(selected) ? stage.onScreen(stage.parts.centre(selected)) : null);
    const { offsetWidth: wide, offsetHeight: high } = this.box;
    const [width, height] = stage.size;
    const [x, y] = seen ?? [MARGIN, height];
    const away = this.pinned ? ASIDE : Math.max(ASIDE, stage.sizeOnScreen(selected));
    const left = Math.max(MARGIN, Math.min(width - wide - MARGIN, x - wide / 2));
    const fits = y - away - high > MARGIN;
    const top = Math.max(MARGIN, Math.min(height - high - MARGIN, fits ? y - away - high : y + away));
    this.box.style.transform = `translate(${Math.round(left)}px, ${Math.round(top)}px)`;
  }
}
