// Results of the tabs on the stage: the film of a plan, the motion at a limit, supports, changes.

import { Film } from "../film.js";
import { movers } from "../map.js";
import { Strip } from "../strip.js";
import { degrees, force, number } from "../words.js";
import { button } from "./entries.js";

const PACE = 1250; // duration of a step of a film [ms]
const CASES = 300; // entries of the list of limits
const NONE = ""; // the entry of the list that shows the answer itself

export class OnStage {
  constructor(bench) {
    Object.assign(this, { bench, shown: null, strip: null, cases: [], changed: null });
  }

  /** Draw the result of the open tab; null: the answer itself. */
  tell(name, result) {
    const { report } = this.bench;
    if (!report?.stage || this.shown === result) return;
    this.clear();
    this.shown = result;
    if (!result || result.error) return;
    if (name === "plan" && result.film?.steps.length) this.begin(result.film);
    if (name === "margin") this.cases = marginCases(result.data, this.bench);
    if (name === "transport") this.cases = transportCases(result.data);
    if (name === "supports" && result.movement) report.showMovement(result.movement, 1);
    if (name === "hold") this.support(result.data.supports ?? []);
    if (name === "helps" && result.changes.length === 1) this.change(0, result.changes);
  }

  clear() {
    const { report } = this.bench;
    this.pause();
    this.strip = null;
    this.cases = [];
    this.changed = null;
    report.stage.parts.gripped.fill(0);
    if (report.film) {
      report.showFilm(null);
      report.stage.home();
    }
    if (report.movement) report.showMovement(null);
    if (report.limit) report.showLimit(null);
    else if (this.shown) report.turn(report.down);
  }

  /** Controls beside the result: of the film, or the list of limits. */
  controls() {
    if (this.strip) {
      this.playButton = button(this.playing ? "Pause" : "Play", () => (this.playing ? this.pause() : this.play()));
      return [button("Back", () => this.jump(-1), "previous step"), this.playButton, button("Forward", () => this.jump(1), "next step")];
    }
    if (!this.cases.length) return [];
    const select = document.createElement("select");
    select.id = "limit-case";
    select.setAttribute("aria-label", "limit that the picture shows");
    select.add(new Option("show in the picture\u2026", NONE));
    this.cases.slice(0, CASES).forEach(({ label }, k) => select.add(new Option(label, String(k))));
    select.value = this.chosen ?? NONE;
    select.addEventListener("change", () => this.choose(select.value));
    return [select];
  }

  /** The strip of small pictures, above the words of the plan. */
  get content() {
    return this.strip ? [this.list] : [];
  }

  // limits ----------------------------------------------------------------------------

  choose(value) {
    const { report } = this.bench;
    this.chosen = value;
    const one = this.cases[Number(value)];
    if (value === NONE || !one) {
      report.showLimit(null);
      return;
    }
    const { full_names: names, radius, grounded } = report.page.parts;
    const motion = new Float32Array(6 * names.length);
    names.forEach((name, k) => one.mechanism?.[name] && motion.set(one.mechanism[name], 6 * k));
    const moving = movers(motion, radius);
    // the carrier moves its held parts, a push acts on its part
    const at = one.part === undefined ? grounded.findIndex(Boolean) : names.indexOf(one.part);
    const pushes = one.along && at >= 0 ? [{ part: at, along: one.along }] : [];
    report.showLimit({ motion: moving.length ? motion : null, moving, down: one.down, pushes });
  }

  // supports --------------------------------------------------------------------------

  support(supports) {
    const { full_names: names } = this.bench.report.page.parts;
    const { center } = this.bench.report.page;
    const grips = supports.filter(({ kind }) => kind === "grip").map(({ part }) => names.indexOf(part));
    const pushes = supports
      .filter(({ direction, part }) => direction && names.includes(part))
      .map(({ part, point, direction }) => ({ part: names.indexOf(part), point: point && point.map((c, i) => c - center[i]), along: direction }));
    this.mark(grips, { pushes });
  }

  /** Mark parts in the colour of held parts, and show arrows, and bodies beside the parts. */
  mark(grips, limit) {
    const { report } = this.bench;
    const { gripped } = report.stage.parts;
    gripped.fill(0);
    for (const k of grips) gripped[k] = 1;
    report.showLimit({ motion: null, moving: [], ...limit });
  }

  /** Show a change that helps: its parts, movements, and bodies after it; again: the answer itself. */
  change(k, changes) {
    if (!this.bench.report?.stage) return;
    const again = this.changed === k;
    this.clear();
    if (again) return;
    this.changed = k;
    const { parts, pushes, ghost } = changes[k];
    this.mark(parts, { pushes, ghost, changes: true });
  }

  // film ------------------------------------------------------------------------------

  begin(plan) {
    const { report } = this.bench;
    const film = new Film(report, plan);
    report.showFilm(film);
    const beyond = film.overhang();
    report.stage.spread(report.page.extent.map((e, i) => e + beyond[i]));
    this.list = document.createElement("ol");
    this.list.id = "film-strip";
    this.list.className = "strip";
    const paint = (k, canvas) => {
      film.paint(k, canvas);
      report.repose();
    };
    this.strip = new Strip(this.list, { plan, parts: report.page.parts }, (k) => this.go(film.pictureAt(k)), paint);
    this.go(film.pictureAt(0));
  }

  /** Show a time of the film [steps]. */
  go(time, stop = true) {
    const { report } = this.bench;
    const { film } = report;
    if (stop) this.pause();
    report.filmTime = Math.max(0, Math.min(film.count, time));
    const [k] = film.stepAt(report.filmTime);
    this.strip.mark(k);
    report.stage.turnTo(film.plan.steps[k].down);
    report.repose();
  }

  jump(step) {
    const { report } = this.bench;
    this.go(report.film.jumped(report.filmTime, step));
  }

  play() {
    const { report } = this.bench;
    const [began, from] = [performance.now(), report.filmTime >= report.film.count ? 0 : report.filmTime];
    this.playing = began;
    this.playButton.textContent = "Pause";
    const step = (now) => {
      if (this.playing !== began || !report.film) return;
      const time = from + Math.max(0, now - began) / PACE;
      this.go(time, false);
      if (time < report.film.count) requestAnimationFrame(step);
      else this.pause();
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.playing = null;
    if (this.playButton) this.playButton.textContent = "Play";
  }
}

/** The limits of a margin that have a motion: the tilt, and the pushes from the weakest on. */
function marginCases(data, bench) {
  const cases = [];
  if (data.tilt_limit?.mechanism) cases.push({ label: `tilt by ${degrees((data.tilt_deg * Math.PI) / 180)}`, down: data.tilt_down, mechanism: data.tilt_limit.mechanism });
  const pushes = (data.pushes ?? []).filter(({ limit }) => limit?.mechanism).sort((a, b) => a.force - b.force);
  for (const { part, direction, force: newtons, limit } of pushes) {
    cases.push({ label: `push on ${bench.shortName(part)}: ${force(newtons)}`, part, along: direction, mechanism: limit.mechanism });
  }
  return cases;
}

/** The limits of a carrier by axis. */
const transportCases = (data) =>
  (data.limits ?? [])
    .filter(({ limit }) => limit?.mechanism)
    .map(({ name, g, direction, limit }) => ({ label: `carrier towards ${name}: ${number(g, 3)} g`, along: direction, mechanism: limit.mechanism }));
