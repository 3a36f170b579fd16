// The workbench: the page of `kilter view`, which shows a session of the server.
//
// The server sends the state of the session, the scene, and answers. Each answer belongs to a state;
// an answer to an older state is dropped.

import { copyText } from "../clipboard.js";
import { unpacked } from "../data.js";
import { id, on } from "../dom.js";
import { controls, press } from "../ladder.js";
import { printWell } from "../paper.js";
import { scrollPast } from "../scrolling.js";
import { Decide } from "./decide.js";
import { Forces } from "./forces.js";
import { Link } from "./link.js";
import { Help } from "./help.js";
import { Layout } from "./layout.js";
import { LoadDrag } from "./load_drag.js";
import { LiveReport, pending, prepareParts } from "./live_report.js";
import { readTables } from "../tables.js";
import { PartActions } from "./part_actions.js";
import { picture, video } from "./recording.js";
import { SelectionBar } from "./selection_bar.js";
import { Start, sentence } from "./start.js";
import { Tabs } from "./tabs.js";

const MAPPED = 60; // most free parts for which the gravity ball is coloured without a question
const PROBE = 80; // least time between two questions about a direction of gravity [ms]
const SHOWN = 6000; // a message of success is shown for this time [ms]

export class Workbench {
  constructor({ token, guides }) {
    this.session = null;
    this.answer = null;
    document.body.classList.add("bench");
    this.layout = new Layout();
    this.layout.opened = (name) => name === "gravity" && this.mapDirections();
    this.start = new Start(this);
    this.forces = new Forces(this);
    this.parts = new PartActions(this);
    this.decide = new Decide(this);
    this.tabs = new Tabs(this);
    for (const one of controls()) {
      one.addEventListener("click", () => this.assume({ assume: one.dataset.rung, friction: null }));
    }
    on("undo", "click", () => this.act({ do: "undo" }));
    on("redo", "click", () => this.act({ do: "redo" }));
    on("save", "click", () => this.save());
    on("show-help", "click", () => this.help.show());
    on("end-trouble", "click", () => (id("trouble").hidden = true));
    on("end-message", "click", () => (id("message").hidden = true));
    on("stop", "click", () => this.act({ do: "stop" }));
    on("copy-command", "click", () => copyText(id("command").textContent, id("copy-command")));
    on("export", "change", () => {
      const name = id("export").value;
      id("export").value = "";
      if (name) this.export(name);
    });
    document.addEventListener("keydown", (e) => this.key(e));
    this.link = new Link(token, (message) => this.hear(message), (connected) => this.connected(connected));
    this.help = new Help(guides, (path) => this.link.address(path));
  }

  /** Keys of the whole page: undo, redo, save, help. */
  key(event) {
    if (event.key === "?" && !event.target.matches?.("input, textarea, select")) this.help.show();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || !this.session?.file) return;
    const writing = event.target.matches?.("input:not([type=range], [type=checkbox]), textarea");
    const name = event.key.toLowerCase();
    if (name === "s") this.save();
    else if (name === "z" && !writing) this.act({ do: event.shiftKey ? "redo" : "undo" });
    else if (name === "y" && !writing) this.act({ do: "redo" });
    else return;
    event.preventDefault();
  }

  /** Send an action; a refusal is shown as a sentence. */
  async act(action) {
    const reply = await this.link.send(action);
    if (reply.ok) id("trouble").hidden = true;
    else this.complain(sentence(reply));
    return reply;
  }

  /** Choose the rung of a row of the ladder, with the friction of the row if it states one. */
  assume({ assume: rung, friction: mu }) {
    return this.act({ do: "assume", rung, ...(mu === null ? {} : { mu }) });
  }

  complain(words) {
    id("trouble").hidden = false;
    id("trouble-words").textContent = words.charAt(0).toUpperCase() + words.slice(1);
  }

  connected(connected) {
    id("connection").hidden = connected;
    if (connected) return;
    id("connection").textContent = this.link.opened
      ? "The connection to kilter is lost, and the page tries to connect again. Changes until now are kept; if kilter has ended, start it again with kilter view."
      : `The page has no connection to kilter, and tries again. If a proxy serves this page, it must pass WebSockets on, and kilter view needs the option --host ${location.hostname}.`;
  }

  /** Whether the open file is a copy that kilter keeps only while it runs. */
  get temporary() {
    return this.session.temporary;
  }

  /** Save the choices beside the file; without the user's folder they are downloaded, too. */
  async save() {
    const reply = await this.act({ do: "save", file: null });
    if (reply.ok && this.temporary) await this.export("choices.kilter.json", reply.saved);
  }

  // messages --------------------------------------------------------------------------

  hear(message) {
    const act = { session: "tellSession", scene: "showScene", answer: "showAnswer", problem: "tellProblem", progress: "tellProgress", tab: "showTab", probe: "showProbe" }[message.is];
    if (act) this[act](message);
  }

  tellSession(session) {
    const before = this.session;
    this.session = session;
    const open = Boolean(session.file);
    for (const name of ["save", "export", "command-line"]) id(name).hidden = !open;
    id("undo").hidden = !open || !session.changes.length;
    id("redo").hidden = !open || !session.redo.length;
    id("undo").title = session.changes.length ? `undo: ${session.changes.at(-1).label} (Ctrl+Z)` : "";
    id("title").textContent = session.title;
    document.title = session.title ? `${session.title} – kilter` : "kilter";
    id("saved").textContent = !open ? "" : session.dirty ? "not saved" : session.saved ? `saved: ${session.saved}` : "";
    id("saved").title = open && this.temporary ? "The file was dropped on the page. Saved choices are downloaded: put them beside the file." : "";
    id("command").textContent = session.command;
    id("command-note").textContent = session.command_needs_save ? "needs the saved choices" : "";
    if (!before || session.message !== before.message) this.note(session.message, /^saved/.test(session.message));
    this.start.tell(session);
    this.forces.tell(session);
    if (!before || before.state !== session.state) this.stale();
    if (session.choices.assume) press(session.choices.assume);
    if (!open) id("show").hidden = true;
    else if (this.report && before && before.file === session.file) id("show").hidden = false;
    if (this.report) this.parts.tell();
    this.bar?.tell();
    keepFocus();
    if (before && before.file !== session.file) {
      id("show").hidden = true; // until the parts of the other file arrive
      this.other = true;
      this.tabs.moved = {};
    }
  }

  /** Mark the answer as one of an older state. */
  stale() {
    this.answer = null;
    this.tabs.renew();
    if (!this.report) return;
    const banner = id("banner");
    banner.dataset.stale = "true";
    banner.dataset.phase = "";
    banner.setAttribute("aria-busy", "true");
    id("level").textContent = "is being computed anew";
  }

  /** Show a sentence; `brief`: it disappears by itself. */
  note(words, brief = true) {
    id("message").hidden = !words;
    id("message-words").textContent = words ? words.charAt(0).toUpperCase() + words.slice(1) : "";
    clearTimeout(this.noted);
    if (words && brief) this.noted = setTimeout(() => (id("message").hidden = true), SHOWN);
  }

  showScene({ page: data }) {
    const page = unpacked(data);
    page.shapes ??= this.shapes;
    this.shapes = page.shapes;
    prepareParts(page.parts);
    const { down } = page;
    page.given = pending(page.parts.names.length, down, this.other ? null : this.report?.page.given);
    id("show").hidden = false;
    const acted = id("part").contains(document.activeElement);
    if (/^Reading/.test(id("message-words").textContent)) this.note("");
    if (!this.report) this.begin(page);
    else if (this.other) {
      this.report.restart(page);
      this.shown = false;
    } else this.report.replace(page);
    this.other = false;
    this.parts.tellLeftOut(page.left_out ?? []);
    this.forces.tell(this.session);
    this.parts.tell();
    this.bar?.tell();
    this.stale();
    // the selected parts were left out: the keyboard goes on in the tree
    if (acted && id("part").hidden) this.report.tree.focus(this.report.tree.at);
  }

  /** Make the picture with the first scene. */
  begin(page) {
    this.report = new LiveReport(page);
    this.report.ladder.choose = (row) => this.assume(row);
    this.report.told = () => this.tellPhase();
    this.report.selected_ = () => {
      this.parts.tell();
      this.bar?.tell();
    };
    this.report.key = (key) => this.partKey(key);
    this.report.unknown = (down) => this.probe(down);
    window.kilter = this.report;
    printWell(this.report, id("printed"));
    if (!this.report.stage) return;
    scrollPast(this.report.stage, id("picture"));
    new LoadDrag(this, id("picture"));
    this.bar = new SelectionBar(this);
    const { drawn } = this.report.stage;
    this.report.stage.drawn = () => {
      drawn();
      this.bar.place();
    };
  }

  /** Keys of the selected parts; returns whether the workbench uses the key. */
  partKey(key) {
    if (key === "Escape" && this.bar.joining >= 0) {
      this.bar.joining = -1;
      this.bar.tell();
      this.note("");
      return true;
    }
    const act = { h: () => this.parts.hold(), x: () => this.parts.leaveOut(), Delete: () => this.parts.leaveOut(), j: () => this.bar.startJoin() }[key];
    if (!act || !this.report.selection.size) return false;
    act();
    return true;
  }

  showAnswer(message) {
    if (!this.report || message.state !== this.session.state) return;
    const given = unpacked(message.given);
    if (given.moves.length !== this.report.page.parts.names.length) return; // of another scene
    const first = !this.shown;
    // often only the complete answer finds a motion
    this.shown = message.phase === "complete" || given.moves.some(Boolean);
    this.answer = message;
    const banner = id("banner");
    banner.scrollTop = 0;
    banner.dataset.stale = "false";
    banner.dataset.phase = message.phase;
    banner.dataset.state = String(message.state);
    banner.setAttribute("aria-busy", String(message.phase !== "complete"));
    markDeciding(this.report.page, message.open);
    this.tellChange(message, given);
    this.report.answered(given);
    if (first) this.report.reveal();
    else this.report.unveil();
    if (this.layout.now === "gravity") this.mapDirections();
    this.decide.tell(message);
    id("answer-html").innerHTML = message.html ?? ""; // escaped by the server
    readTables(this.report.page, id("answer-section"));
    id("answer-section").hidden = !message.html;
  }

  /** After the file was read again, state the verdict until then and the verdict now. */
  tellChange({ phase, check: { verdict } }, { sentence: words }) {
    if (phase !== "complete") return;
    const now = `${this.report.page.words[verdict] ?? verdict}`;
    const before = this.last;
    this.last = { now, words };
    if (!before || !/^the file changed/.test(this.session.message)) return;
    const change = before.now === now ? `still ${now.toLowerCase()}` : `was: ${before.words} Now: ${words}`;
    this.note(`${this.session.message}; ${change}`, false);
  }

  /** State in the banner which phase the answer has. */
  tellPhase() {
    const { phase } = this.answer ?? {};
    if (phase === "equilibrium" && this.report.found.from === "given") {
      id("level").textContent = "equilibrium; the complete answer is being computed";
    } else if (!phase && this.report.found.from === "given") {
      id("verdict").textContent = "…";
      id("level").textContent = "is being computed";
      id("moving").textContent = "";
    }
  }

  tellProblem({ state, ...problem }) {
    if (state !== this.session.state) return;
    const banner = id("banner");
    banner.dataset.stale = "false";
    banner.dataset.phase = "problem";
    banner.dataset.verdict = "unknown";
    banner.dataset.state = String(state);
    banner.setAttribute("aria-busy", "false");
    id("sign").textContent = "?";
    id("verdict").textContent = "No answer";
    for (const name of ["level", "figure", "moving"]) id(name).textContent = "";
    id("sentence").textContent = sentence(problem);
    this.report?.ladder.tell(null);
    press(this.session.choices.assume);
    if (!this.report || id("show").hidden) this.complain(sentence(problem));
  }

  tellProgress({ what, words, working }) {
    id("progress").hidden = !working;
    id("progress-words").textContent = words || (what === "answer" ? "The answer is being computed." : "Being computed.");
    this.tabs.progress(what, words);
    if (!this.report && working) this.note(words && words !== "reading" ? `reading: ${words}` : "reading");
  }

  showProbe({ state, given }) {
    if (state === this.session.state) this.report?.showProbe(unpacked(given));
  }

  /** Compute the answers for other directions of gravity, of a small assembly, for the ball. */
  mapDirections() {
    const { tabs, report } = this;
    if (!report || tabs.results.has("orient") || tabs.asked.has("orient")) return;
    const free = report.page.parts.grounded.filter((held) => !held).length;
    if (free <= MAPPED && this.answer?.phase === "complete") tabs.ask({}, "orient");
  }

  /** Ask for the verdict on another direction of gravity, at most once in a while. */
  probe(down) {
    this.wanted = down;
    this.probing ??= setTimeout(() => {
      this.probing = undefined;
      this.link.send({ do: "probe", down: this.wanted });
    }, PROBE);
  }

  showTab(message) {
    if (message.state !== this.session.state) return;
    if (message.name === "settle") this.decide.refused(message);
    else this.tabs.take(message);
  }

  // helpers ---------------------------------------------------------------------------

  /** The short name of a part on this page. */
  shortName(name) {
    if (!this.report) return name;
    const { full_names: names, tails } = this.report.page.parts;
    const k = names.indexOf(name);
    return k < 0 ? name : tails[k];
  }

  zoomToNames(names) {
    const { full_names: all } = this.report.page.parts;
    const pair = names.map((name) => all.indexOf(name)).filter((k) => k >= 0);
    if (pair.length) this.report.bring(pair);
  }

  /** A file of a kind: the stage makes pictures and videos, the server makes the others. */
  async made(name) {
    if (name === "picture.png") return [await picture(this.report.stage), name];
    if (name === "film.webm") {
      const [blob, ending] = await video(this);
      return [blob, `film.${ending}`];
    }
    const response = await fetch(this.link.address(`export/${name}`));
    if (!response.ok) throw new Error(sentence(await response.json()));
    return [await response.blob(), name];
  }

  /** Download a file; `as`: the name of the download. */
  async export(name, as = "") {
    this.note(`${as || name} is being made`);
    try {
      const [blob, own] = await this.made(name);
      const anchor = document.createElement("a");
      anchor.href = URL.createObjectURL(blob);
      anchor.download = as || own;
      anchor.click();
      setTimeout(() => URL.revokeObjectURL(anchor.href), SHOWN);
      this.note(`${as || own} is downloaded`);
    } catch (error) {
      this.note("");
      this.complain(`${name} was not made: ${error.message}`);
    }
  }
}

/** If the focused button has disappeared, move the focus to another button of the bar. */
function keepFocus() {
  const { activeElement: element } = document;
  if (!element?.closest(".bar") || !element.hidden) return;
  const next = [...document.querySelectorAll(".bar button")].find((one) => !one.hidden);
  if (next) next.focus();
}

/** Mark the open pairs of a page that change the verdict. */
function markDeciding({ open, parts: { full_names: names } }, pairs) {
  const key = (a, b) => [a, b].sort().join("\n");
  const deciding = new Set(pairs.filter(({ decides }) => decides).map(({ parts: [a, b] }) => key(a, b)));
  open.decides = Array.from({ length: open.parts.length / 2 }, (_, k) => deciding.has(key(names[open.parts[2 * k]], names[open.parts[2 * k + 1]])));
}
