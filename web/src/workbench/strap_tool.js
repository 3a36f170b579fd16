// Placing a strap by clicks on the parts: ends and corners in order.

import { add } from "../vector.js";
import { button, entered, numbersOf } from "./entries.js";

export class StrapTool {
  constructor(bench) {
    Object.assign(this, { bench, points: null, tension: "" });
  }

  /** Controls of the tab: a button that begins, or the field and the buttons that end. */
  controls() {
    const { bench } = this;
    if (!bench.report?.stage) return [];
    if (!this.points) return [button("Place a strap", () => this.begin(), "click its ends and corners in the picture")];
    const field = document.createElement("input");
    field.id = "strap-tension";
    field.placeholder = "2000";
    field.value = this.tension;
    field.setAttribute("aria-label", "tension of the strap [N]");
    field.addEventListener("input", () => (this.tension = field.value));
    return [field, button("Add the strap", () => this.finish(field)), button("Cancel", () => this.end())];
  }

  begin() {
    this.points = [];
    this.bench.report.tool = this;
    this.bench.note("Click the first end, the corners and the last end of the strap.", false);
    this.bench.tabs.draw();
  }

  /** Take the point of a part under a click. */
  click(x, y) {
    const { report } = this.bench;
    const hit = report.stage.hit(x, y);
    if (!hit) return;
    this.points.push({ part: hit.part, at: report.stage.parts.rest(hit.part, hit.local) });
    this.draw();
  }

  /** Draw the strap as far as it is placed. */
  draw() {
    const { page } = this.bench.report;
    page.straps = [...(this.given ??= page.straps ?? []), this.points.map(({ at }) => at)];
    this.bench.report.repose();
  }

  async finish(field) {
    const { bench } = this;
    const { page } = bench.report;
    const tension = numbersOf(entered(field), 1);
    if (!tension || this.points.length < 2) {
      bench.complain("Click two or more points in the picture, and give the tension in N.");
      return;
    }
    const floor = ({ part }) => ["floor", "assumed"].includes(page.parts.held_by[part]);
    const path = this.points.map((point) => [floor(point) ? "ground" : page.parts.full_names[point.part], add(point.at, page.center)]);
    const reply = await bench.act({ do: "strap", path, tension: tension[0] });
    if (reply.ok) this.end();
  }

  end() {
    const { report } = this.bench;
    if (this.given) report.page.straps = this.given;
    Object.assign(this, { points: null, given: undefined });
    report.tool = null;
    this.bench.note("");
    report.repose();
    this.bench.tabs.draw();
  }
}
