// The page of a report: the user turns gravity, and verdict, motion and forces follow.
// Words from the data are set as text, never as HTML.

import { HELD, answer, nearestHeld } from "./answer.js";
import { Ball } from "./ball.js";
import { bodyColour, ramp, rampOf, rgb, themeOf } from "./colours.js";
import { distance, isThin } from "./cone.js";
import { Clip } from "./clip.js";
import { Graph, fallen, frictionWords, overhang, placeWords } from "./fall.js";
import { id, on } from "./dom.js";
import { Ladder } from "./ladder.js";
import { Look } from "./look.js";
import { deepest } from "./map.js";
import { bondUse, forceArrows, motionArrows, thrustRods } from "./overlay.js";
import { reachOf, turn } from "./pose.js";
import { clearAmount } from "./sweep.js";
import { angleBetween, unit } from "./vector.js";
import { Places } from "./workbench/places.js";
import { basis, gapWords, degrees, direction, force, marginWords, movingWords, number, plainly, pullWords, shortened } from "./words.js";

const SIGNS = {
  stable: "✓",
  settles: "✓",
  "potentially-stable": "≈",
  balanced: "△",
  unstable: "✕",
  undecided: "?",
  unknown: "?",
};
const TONES = {
  stable: "stable",
  settles: "stable",
  "potentially-stable": "stable",
  balanced: "stable",
  unstable: "unstable",
  undecided: "undecided",
};
const RESTS = { minimum: "◆ strict minimum", balanced: "✕ balanced", open: "◇ open" };
const SNAP = (3 * Math.PI) / 180; // a thin region attracts the arrow within this angle [rad]
const BLOCKED = 0.01; // a motion that stops before this share of its length is blocked
const ENTERING = "the parts would enter each other at a contact that the motion leaves out";
const VISIBLE = 0.2; // a moving part is visible if at least this share of it is not hidden [-]
const SIDES = [1, 2, 3].flatMap((k) => [(k * Math.PI) / 4, (-k * Math.PI) / 4]).concat(Math.PI); // further views [rad]
const MANY = 3000; // with more parts, no further views are tried
const THROUGH = 0.75; // transparency of the parts at rest that would hide moving parts [-]
const BLINK = 700; // duration of the blink of loose bodies [ms]
const QUIET = 1200; // with more contact points, forces are hidden at first

export class Report extends Look {
  constructor(page) {
    super(page);
    this.down = page.given.down;
    this.amount = 0;
    this.fell = 0;
    this.shifted = 0;
    this.fallClip = new Clip("fall", 2, (share) => this.fall(share));
    this.supportClip = new Clip("supports", 1, (share) => this.shift(share));
    this.ball = new Ball(id("ball"), page, (u, how, step) => this.pull(u, how, step));
    this.ball.marked = (words) => {
      id("marks-key").hidden = !words.length;
      id("marks-key").textContent = words.join(", ");
    };
    this.ladder = new Ladder(this);
    this.look();
    this.controls();
    this.turn(this.down);
    this.begin();
    if (page.given.assumption) this.ladder.tell(page.given.assumption);
    if (page.movement) this.showMovement(page.movement);
    if (page.places) new Places({ report: this }).tell({ data: page.places, place: page.places.part });
    if (this.stage) {
      this.stage.begun = () => this.reveal();
      if (this.stage.size) this.reveal();
    }
  }

  /** Show other data; gravity stays where the user turned it, else it follows the given direction. */
  replace(page) {
    if (angleBetween(this.down, this.page.given.down) < 1e-9) this.down = page.given.down;
    this.painted = undefined;
    this.changed = false;
    this.added = null;
    if (this.movement) this.showMovement(null);
    this.ball.replace(page);
    super.replace(page);
  }

  renewed() {
    this.turn(this.down);
  }

  /**
   * Make the moving parts visible in the first view: from another side if some are hidden by other
   * parts, else through transparent parts.
   */
  reveal() {
    const movers = this.movers();
    const { stage } = this;
    const { parts } = stage;
    if (!movers.length || movers.length === parts.count) return;
    const moves = new Set(movers);
    const share = () => {
      const [alone, among] = [stage.counted((k) => moves.has(k)), stage.counted(() => true)];
      return movers.reduce((least, k) => (alone[k] ? Math.min(least, among[k] / alone[k]) : least), 1);
    };
    if (share() >= VISIBLE) return;
    const [polar, azimuth] = stage.opening;
    const sides = parts.count > MANY || this.page.planar ? [] : SIDES;
    for (const side of sides) {
      stage.opening = [polar, azimuth + side];
      stage.home();
      stage.scene.updateMatrixWorld();
      if (share() >= VISIBLE) return;
    }
    stage.opening = [polar, azimuth];
    stage.home();
    id("see-through").value = String(THROUGH);
    id("see-through-of").value = "rest";
    this.veiled = true;
    this.seeThrough();
    this.legend();
  }

  /** Make the parts opaque again that `reveal` has made transparent, once no part moves. */
  unveil() {
    if (!this.veiled || this.movers().length) return;
    this.veiled = false;
    id("see-through").value = "0";
    this.seeThrough();
    this.legend();
    this.stage.draw();
  }

  // gravity ---------------------------------------------------------------------------

  /** Follow the ball's arrow. A thin region attracts it, because a hand could not hit the region. */
  pull(wanted, how, step = 0) {
    const { region, planar } = this.page;
    let u = unit(wanted);
    if (region && region.dimension && isThin(region, planar)) {
      const reach = how === "key" ? step / 2 : SNAP;
      if (distance(region, u) < reach) u = nearestHeld(region, u);
    }
    for (const known of [this.page.given, this.page.recommended]) {
      if (known && angleBetween(known.down, u) < 1e-7) u = known.down;
    }
    this.turn(u, { follow: how === "key" });
  }

  /** Set the direction of gravity and update the answer, the ball and the picture. */
  turn(u, { exactly = false, follow = false } = {}) {
    this.down = u;
    const before = this.found;
    this.found = answer(this.page, u);
    if (!before || before.fall !== this.found.fall) this.showFall();
    this.ball.tone = TONES[this.found.verdict];
    this.ball.set(u, follow);
    if (this.stage) {
      this.stage.turnTo(u, exactly);
      this.stage.places.group.visible = Boolean(this.stage.places.data) && angleBetween(u, this.page.given.down) < 1e-9;
      this.stage.parts.moving.fill(0);
      for (const k of this.movers()) this.stage.parts.moving[k] = 1;
      this.seeThrough();
    }
    this.repose();
    this.tell();
  }

  /** Place parts, arrows and names for the current values of the sliders. */
  repose() {
    if (!this.stage) return;
    const { parts } = this.stage;
    const { motion, fall } = this.found;
    if (this.shifted) this.displace(...this.moved(this.shifted));
    else if (fall && fall.places) this.fallTo(fall);
    else parts.pose(motion, motion && this.amount ? this.amount * this.farthest() : 0, this.apart);
    // the position of the brick to add is only right among parts at rest
    this.stage.ghost.group.visible = Boolean(this.added && !(motion && this.amount) && !this.apart);
    this.arrows();
    this.names.place();
    this.stage.draw();
  }

  /** Show or hide the recommended change: the brick to add, or the selection of the one to remove. */
  showChange() {
    const { part, shape, at } = this.page.change;
    this.changed = !this.changed;
    id("show-change").setAttribute("aria-pressed", String(this.changed));
    if (part !== null) {
      this.select(this.changed ? part : -1);
    } else if (this.stage) {
      this.added = this.changed;
      this.stage.ghost.set(shape, at);
      this.repose();
    }
  }

  /** Indices of the parts that move, or that fall from a balanced state. */
  movers() {
    if (!this.found) return [];
    const { moving, fall } = this.found;
    return fall ? fall.parts : moving || [];
  }

  /** Place the parts at the current point of their fall, pulled apart by the explode slider. */
  fallTo(fall) {
    const { shifts, turns } = fallen(fall, this.fell);
    this.displace(fall.parts, shifts, turns);
  }

  /** Shift and turn some parts about their centres of mass, and pull all parts apart. */
  displace(list, shifts, turns) {
    const { center } = this.page.parts;
    const apart = (k) => [0, 1, 2].map((i) => this.apart * center[3 * k + i]);
    const all = Array.from({ length: center.length / 3 }, (_, k) => apart(k));
    const turned = [];
    list.forEach((k, m) => {
      all[k] = all[k].map((c, i) => c + shifts[m][i]);
      turned[k] = turns[m];
    });
    this.stage.parts.carry(all, turned);
  }

  /** Show the card of a fall if the assembly is balanced and its path is known; else hide it. */
  showFall() {
    const { fall } = this.found;
    const shown = Boolean(fall && fall.places);
    this.fallClip.stop();
    if (this.fell) {
      this.fell = 0;
      this.stage.spread(this.spreading());
    }
    id("fall").hidden = !shown;
    id("motion-row").hidden = shown;
    if (!shown) return;
    this.graph = new Graph(id("fall-graph").querySelector("svg"), fall, this.page.units);
    const words = fall.words.charAt(0).toUpperCase() + fall.words.slice(1);
    id("fall-words").textContent = `${words}.`;
    id("fall-friction").textContent = frictionWords(fall);
    this.fall(0);
  }

  /** Set the progress of the fall, from 0 to 1 of its path. */
  fall(share) {
    this.fell = share;
    const place = fallen(this.found.fall, share);
    const words = placeWords(this.page.units, place);
    id("fall-at").value = String(share);
    id("fall-at").setAttribute("aria-valuetext", words);
    id("fall-place").textContent = words;
    this.graph.show(place);
    this.outside = overhang(this.found.fall.parts, this.page.parts, this.page.extent, place.shifts);
    if (this.stage) this.stage.spread(this.spreading());
    this.repose();
  }

  /** Half lengths of the box that the view must show, including the fallen parts. */
  spreading() {
    const box = super.spreading();
    return this.fell || this.movement ? box.map((e, i) => e + this.outside[i]) : box;
  }

  /** Show the magnified movement of parts with their supports, at a share of it; null: none. */
  showMovement(movement, share = 0) {
    this.supportClip.stop();
    this.movement = movement;
    id("supports").hidden = !movement;
    if (movement) id("supports-words").textContent = movement.words;
    this.shift(share);
  }

  /** Set the share of the movement of supports, from 0 to 1. */
  shift(share) {
    this.shifted = this.movement ? share : 0;
    id("supports-at").value = String(this.shifted);
    if (this.movement) {
      const [all, shifts] = this.moved(1);
      this.outside = overhang(all, this.page.parts, this.page.extent, shifts);
    }
    if (this.stage) this.stage.spread(this.spreading());
    this.repose();
  }

  /** Parts, shifts and turns after a share of the movement of supports; parts that meet stay near. */
  moved(share) {
    const { motion } = this.movement;
    const all = Array.from({ length: motion.length / 6 }, (_, k) => k);
    const three = (i) => [0, 1, 2].map((j) => share * motion[i + j]);
    return [all, all.map((k) => three(6 * k)), all.map((k) => turn(...three(6 * k + 3)))];
  }

  /** Amount of the motion at the end of its slider: the largest without overlap of parts. */
  farthest() {
    const { found, page } = this;
    if (found.farthest === undefined) {
      // at most 1.1 times the median radius of the moving parts: enough to show the direction
      const sizes = this.movers().map((k) => page.parts.radius[k]);
      sizes.sort((a, b) => a - b);
      const reach = reachOf(found.motion, page.parts.radius, 1.1 * (sizes[sizes.length >> 1] || 0));
      found.farthest = clearAmount(page, found.motion, reach);
      found.blocked = found.farthest < BLOCKED * reach;
      this.tellMotion();
    }
    return found.farthest;
  }

  /** Label the slider of the motion; a motion that only closes open pairs cannot be shown. */
  tellMotion() {
    const { motion, fall, blocked } = this.found;
    const named = fall ? "start of the fall" : `motion${blocked ? ": blocked" : ""}`;
    id("motion-label").textContent = motion ? named : "motion: none";
    id("motion-row").title = blocked ? ENTERING : "impending motion";
  }

  arrows() {
    const { stage, found } = this;
    const motion = found.fall ? found.fall.begins : found.motion;
    const rests = !this.fell && !this.shifted;
    const moving = motion && rests && id("show-motion").checked ? this.movers() : [];
    // many arrows are drawn shorter, so that they do not cover each other
    const long = this.long * (moving.length > 20 ? 0.5 : 1);
    stage.motion.set(moving.length ? motionArrows(stage, motion, moving, long) : {});
    let label = found.forces ? "contact forces" : "contact forces: none for this direction";
    // the forces balance the parts at rest, not at a later point of a movement
    const forces = found.forces && rests && id("show-forces").checked;
    id("show-forces").disabled = !found.forces;
    id("motion-check").hidden = !motion;
    for (const name of ["force-mode-row", "thrust-row", "size-row"]) id(name).hidden = !forces;
    id("thrust-key").hidden = !forces || !id("show-thrust").checked;
    stage.parts.patches.visible = rests && id("show-contacts").checked;
    if (forces) {
      const size = this.forceLength() * Number(id("force-size").value);
      const each = id("force-mode").value === "point";
      const { straight, most, shown, all } = forceArrows(stage, found.forces, size, each);
      const rod = id("show-thrust").checked ? thrustRods(stage, all, 0.5 * this.long) : [];
      stage.forces.set({ straight, rod });
      this.shown = shown;
      this.useKey(all);
      label = `contact forces ${found.forceWords || `up to ${force(most)} at a point`}`;
    } else {
      stage.forces.set({});
      this.shown = [];
      id("use-key").hidden = true;
    }
    id("force-label").textContent = label;
    const size = 0.018 * this.page.radius;
    const hinges = this.movement?.hinges ?? [];
    stage.hinges.set({ ball: hinges.map(({ part, at }) => ({ at: stage.parts.placeOf(part, at), along: [0, 1, 0], size })) });
    this.paint();
    this.marks();
  }

  /** Update the key of the force colours: friction used, bond used, or hidden. */
  useKey(all) {
    const [rubs, pulls] = ["use", "bond"].map((name) => all.some((one) => one[name] !== null));
    id("use-key").hidden = !rubs && !pulls;
    id("use-words").textContent = [...(rubs ? ["friction"] : []), ...(pulls ? ["bond"] : [])].join(" or ");
  }

  /** Redraw after parts were hidden or shown. */
  seen() {
    super.seen();
    this.tell();
  }

  /** Show parts in the colour of warnings for a moment, unless the user wants no motion. */
  blink(parts) {
    if (!this.stage || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const show = (list) => {
      this.blinking = list;
      this.painted = undefined;
      this.repose();
    };
    show(parts);
    setTimeout(() => show([]), BLINK);
  }

  /** Colour the parts as given, by their bodies, or by the largest bond use of each part. */
  paint() {
    const { stage, found, page } = this;
    if (found.bondUse === undefined) found.bondUse = bondUse(page, found.forces);
    const use = found.bondUse;
    const bodies = page.given.assumption?.bodies ?? [];
    const values = { own: null, bond: use, body: bodies.length ? bodies : null };
    const of = id("colour-of");
    for (const option of of.options) option.hidden = option.disabled = option.value !== "own" && !values[option.value];
    id("colour-row").hidden = !use && !bodies.length;
    const shown = values[of.value];
    id("bond-key").hidden = !shown || shown !== use;
    id("body-key").hidden = shown !== bodies;
    id("assumptions").dataset.coloured = String(shown === bodies);
    if (shown === this.painted) return;
    this.painted = shown;
    const colour = page.parts.colour.slice();
    const style = themeOf(document.body);
    const put = (rgb_) => (k) => colour.set(rgb_.map(Math.round), 3 * k);
    if (shown === bodies) bodies.forEach(({ parts }, number) => parts.forEach(put(bodyColour(style, number))));
    else if (shown) use.forEach((share, k) => page.parts.grounded[k] || put(ramp(share, rampOf(style)))(k));
    (this.blinking ?? []).forEach(put(rgb(style("unstable"))));
    stage.parts.paint(colour);
  }

  /** Length of the longest force arrow: about the size of a part, so that arrows stay apart. */
  forceLength() {
    const { radius, parts } = this.page;
    const largest = parts.radius.reduce((most, r, k) => (parts.grounded[k] ? most : Math.max(most, r)), 0);
    return Math.min(0.4 * radius, 1.8 * largest || radius);
  }

  /** Write verdict, margin, moving parts and labels for the current direction. */
  tell() {
    const { page, found } = this;
    const banner = id("banner");
    banner.dataset.verdict = found.verdict;
    id("sign").textContent = SIGNS[found.verdict] || "?";
    id("verdict").textContent = page.words[found.verdict] || found.verdict;
    id("sentence").textContent = found.sentence
      ? shortened(page, plainly(found.sentence, page.words[found.verdict]))
      : marginWords(page, found);
    const gone = this.stage ? this.movers().filter((k) => !this.stage.parts.visible[k]).length : 0;
    const lines = [movingWords(page, found, gone)];
    if (found.sentence) lines.unshift(marginWords(page, found));
    id("moving").textContent = lines.filter(Boolean).join("; ");
    id("basis").textContent = basis(page, found);
    id("down").textContent = direction(this.down);
    const away = angleBetween(this.down, page.given.down);
    id("turned").textContent = away ? `turned by ${degrees(away)} from the given direction` : "as given";
    const [sign, value] = (found.instability ?? null) === null ? ["z", found.z] : ["κ", found.instability];
    id("level").textContent = found.level ? `level: ${found.level}` : "";
    id("figure").title =
      found.verdict === "undecided" ? "for the modelled frictionless contacts alone" : "";
    const said = TONES[found.verdict] !== "stable" && (value ?? null) !== null;
    id("figure").textContent = said ? `${sign} ${number(value)}` : "";
    const at = (name) => page[name] && angleBetween(page[name].down, this.down) < 1e-9;
    id("go-given").setAttribute("aria-pressed", String(Boolean(at("given"))));
    id("go-recommended").setAttribute("aria-pressed", String(Boolean(at("recommended"))));
    const label = `gravity along ${direction(this.down, 2)}: ${page.words[found.verdict]}`;
    this.ball.canvas.setAttribute("aria-valuetext", label);
    this.ball.canvas.setAttribute("aria-valuenow", String(Math.round((away * 180) / Math.PI)));
    for (const name of ["motion", "play"]) id(name).hidden = !found.motion;
    id("motion").disabled = !found.motion;
    id("go-nearest").hidden = !page.region || !page.region.dimension || HELD.includes(found.verdict);
    this.tellMotion();
    if (this.selected >= 0) this.showPart(this.selected);
  }

  // controls --------------------------------------------------------------------------

  /** Connect the controls of a report; called once. */
  controls() {
    on("go-given", "click", () => this.turn(this.page.given.down, { exactly: true, follow: true }));
    on("go-recommended", "click", () => this.turn(this.page.recommended.down, { follow: true }));
    on("go-nearest", "click", () => {
      this.turn(nearestHeld(this.page.region, this.down), { follow: true });
      if (id("go-nearest").hidden) id("ball").focus({ preventScroll: true });
    });
    on("motion", "input", () => this.slide("amount", "motion"));
    on("play", "click", () => this.play());
    on("cards", "click", (e) => e.target.id === "show-change" && this.showChange());
    on("colour-of", "change", () => this.repose());
    const { forces } = this.page.given;
    if (this.stage) id("show-forces").checked = !forces || forces.points.length / 3 <= QUIET;
  }

  /** Show the controls and keys that apply to the data of the page. */
  offer() {
    super.offer();
    const { page } = this;
    const { region } = page;
    id("go-recommended").hidden = page.coincide || !page.recommended;
    id("go-given").textContent = page.coincide ? "Given and recommended" : "Given";
    const held = page.recommended && HELD.includes(page.recommended.verdict);
    id("go-recommended").textContent = page.recommended && !held ? "Closest to stable" : "Recommended";
    const known = region && region.outside === "unstable";
    id("no-map").hidden = Boolean(page.map) || !region || !region.equations.length + region.facets.length;
    id("no-map").dataset.known = String(known);
    id("no-map-words").textContent = known
      ? "unstable; the degree is not computed for this many parts"
      : "undecided: forces that are not modelled may hold the parts";
    id("ramp-words").textContent = known
      ? "unstable, from slightly to strongly"
      : "unstable with the frictionless contacts alone, from slightly to strongly";
    id("ramp").hidden = !page.map || deepest(page.map) === 0;
    this.keys();
    for (const part of this.stage ? [] : ["fall-play", "fall-at", "supports-play", "supports-at"]) id(part).hidden = true;
    id("bond-pull").textContent = pullWords(page.given.forces && page.given.forces.pull);
  }

  /** Write the question of the ball and the key of its colours. */
  keys() {
    const { region } = this.page;
    id("question").hidden = !region;
    id("stable-key").hidden = !region || region.kind === "none";
    id("gap-key").hidden = !region || !region.inner;
    const signs = new Set((region?.rests ?? []).map(({ state }) => RESTS[state] ?? "○ slides or rolls freely"));
    id("rests-key").hidden = !signs.size;
    id("rests-key").textContent = [...signs].join(" ");
    if (!region) return;
    id("question").textContent = region.words.question;
    id("stable-words").textContent = region.words.inside;
    if (region.inner) id("gap-words").textContent = gapWords(region.gap_deg);
  }

  /** Play the motion once forth and back, or stop it. */
  play() {
    if (this.playing) {
      this.playing = null;
      id("play").textContent = "Play";
      return;
    }
    const started = performance.now();
    this.playing = started;
    id("play").textContent = "Stop";
    const step = (now) => {
      if (this.playing !== started) return;
      const t = (now - started) / 2600;
      id("motion").value = String(0.5 - 0.5 * Math.cos(2 * Math.PI * Math.min(t, 1)));
      this.slide("amount", "motion");
      if (t < 1 && this.found.motion) requestAnimationFrame(step);
      else this.play();
    };
    requestAnimationFrame(step);
  }

  theme() {
    super.theme();
    this.ball.draw();
  }

  /** Set a direction and return the verdict, the margin [rad] and the moving parts; for tests. */
  ask(direction_) {
    this.turn(unit(direction_));
    return { verdict: id("verdict").textContent, margin: this.found.margin, moving: this.found.moving };
  }
}
