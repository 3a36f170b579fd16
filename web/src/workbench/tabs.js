// Analyses as tabs under the picture, with progress, stop and command line; and the changes.

import { copyText } from "../clipboard.js";
import { unpacked } from "../data.js";
import { id, on } from "../dom.js";
import { readTables } from "../tables.js";
import { OnStage } from "./on_stage.js";
import { Helps } from "./helps.js";
import { button, entered, entry, numbersOf, refill } from "./entries.js";
import { roveTabs } from "./layout.js";
import { Places } from "./places.js";
import { sentence } from "./start.js";
import { StrapTool } from "./strap_tool.js";

const TABS = {
  changes: "Changes",
  orient: "Which way up",
  margin: "Margins",
  helps: "What helps",
  plan: "Order",
  hold: "What to hold",
  transport: "Transport",
  place: "Place",
  forces: "Forces",
  supports: "Supports",
  contacts: "Contacts",
  compare: "Compare",
};
const AT_ONCE = ["orient", "margin", "helps", "plan", "hold", "contacts", "forces"]; // computed when they are opened

export class Tabs {
  constructor(bench) {
    this.bench = bench;
    this.results = new Map();
    this.asked = new Set();
    this.now = null;
    this.moved = {};
    this.places = new Places(bench);
    this.onStage = new OnStage(bench);
    this.helps = new Helps(bench, this.onStage);
    this.strap = new StrapTool(bench);
    this.buttons = Object.entries(TABS).map(([name, label], k) => {
      const element = button(label, () => this.show(this.now === name ? null : name));
      element.id = `tab-${name}`;
      element.setAttribute("role", "tab");
      element.setAttribute("aria-controls", "sheet");
      element.tabIndex = k ? -1 : 0;
      element.dataset.name = name;
      return element;
    });
    id("tablist").replaceChildren(...this.buttons);
    on("tablist", "keydown", (e) => roveTabs(this.buttons, e));
    on("copy-tab-command", "click", () => copyText(id("tab-command").textContent, id("copy-tab-command")));
    this.mark();
  }

  /** Open a tab, or close the open one; some are computed at once. */
  show(name) {
    this.now = name;
    if (name && AT_ONCE.includes(name) && !this.results.has(name) && !this.asked.has(name)) this.ask({});
    this.draw();
  }

  mark() {
    for (const element of this.buttons) {
      element.setAttribute("aria-selected", String(element.dataset.name === this.now));
    }
    id("sheet").hidden = !this.now;
    if (this.now) id("sheet").setAttribute("aria-labelledby", `tab-${this.now}`);
  }

  ask(options, name = this.now) {
    this.asked.add(name);
    this.results.delete(name);
    this.bench.act({ do: "ask", tab: name, options });
    this.draw();
  }

  /** Add the movement of a support to the question of the tab of supports; zeros take it back. */
  moveSupport(name, way) {
    this.moved = { ...this.moved, [name]: way };
    if (!way.some(Boolean)) delete this.moved[name];
    this.now = "supports";
    this.ask({ moved: this.moved });
  }

  /** Take the result of an analysis. */
  take(message) {
    this.asked.delete(message.name);
    for (const name of ["film", "changes", "movement"]) if (message[name]) message[name] = unpacked(message[name]);
    this.results.set(message.name, message);
    if (message.ball) this.bench.report?.showDirections(unpacked(message.ball));
    if (message.name === this.now) this.draw();
  }

  /** Drop the results of an older state. */
  renew() {
    this.results.clear();
    this.asked.clear();
    if (this.bench.report?.page.region) this.bench.report.showDirections(null);
    this.draw();
  }

  /** Show the words of the progress of an analysis. */
  progress(what, words) {
    this.running = { what, words };
    if (what && what === this.now && this.asked.has(what)) this.tellProgress();
  }

  tellProgress() {
    const words = this.running?.what === this.now ? this.running.words : "";
    id("sheet-body").textContent = `Being computed${words ? `: ${words}` : ""} …`;
  }

  draw() {
    this.mark();
    const map = this.now === "place" && this.results.get("place");
    this.places.tell(map && map.place ? map : null);
    this.onStage.tell(this.now, this.results.get(this.now) ?? null);
    const { session } = this.bench;
    const count = session?.changes.length ?? 0;
    id("tab-changes").textContent = count ? `Changes (${count})` : "Changes";
    if (!this.now || !session) return;
    const result = this.results.get(this.now);
    const body = id("sheet-body");
    refill(id("sheet-controls"), ...this.controls(result));
    id("sheet-error").hidden = !(result && result.error);
    if (result && result.error) id("sheet-error").textContent = sentence(result);
    id("sheet-command").hidden = !(result && result.command);
    if (result) id("tab-command").textContent = result.command ?? "";
    if (this.now === "changes") {
      refill(body, this.changes(session));
      return;
    }
    body.replaceChildren();
    if (result) {
      // the server escapes all words of this text, and the policy of the page allows no program
      body.innerHTML = result.html;
      body.prepend(...this.onStage.content);
      if (this.now === "helps") this.helps.tell(body, result);
      if (this.bench.report) readTables(this.bench.report.page, id("sheet"));
    } else if (this.asked.has(this.now)) this.tellProgress();
  }

  /** Buttons of the open tab. */
  controls(result) {
    const { bench } = this;
    const { report } = bench;
    const again = (label, options) => button(label, () => this.ask(options()));
    const busy = this.asked.has(this.now);
    if (busy) return [button("Stop", () => bench.act({ do: "stop" }))];
    if (this.now === "changes") return [];
    if (this.now === "compare") return this.comparison();
    const drawn = this.onStage.controls();
    if (this.now === "margin") return [again("With the capacity of each part", () => ({ loads: true })), ...drawn];
    if (this.now === "transport") return [...this.transport(), ...drawn];
    if (this.now === "helps") return this.helps.controls((options) => this.ask(options));
    if (this.now === "place") return this.places.controls((options) => this.ask(options));
    const list = AT_ONCE.includes(this.now) && !result ? [again("Compute", () => ({}))] : [];
    if (this.now === "forces") list.push(...this.between());
    if (this.now === "supports") list.push(...this.supports());
    if (this.now === "orient" && result?.data?.found) {
      list.push(
        button("Show this direction", () => report.turn(result.data.down, { follow: true })),
        button("Use this direction", () => bench.act({ do: "gravity", down: result.data.down })),
      );
    }
    const grips = this.now === "hold" ? gripped(result) : [];
    if (grips.length) list.push(button(`Hold ${grips.map((name) => bench.shortName(name)).join(", ")}`, () => bench.act({ do: "hold", parts: grips, on: true })));
    if (this.now === "plan" && result && result.data && result.data.found) {
      list.push(...drawn, button("Save the page of the plan", () => bench.export("plan.html")));
    }
    return list;
  }

  /** The range of the force between the two selected parts. */
  between() {
    const { parts } = this.bench;
    return [
      button("All pairs", () => this.ask({})),
      button("Between the two selected parts", () =>
        parts.names().length === 2 ? this.ask({ between: parts.names() }) : this.bench.complain("Select two parts that touch."),
      ),
    ];
  }

  /** The supports that move, or how to move them. */
  supports() {
    const ways = Object.entries(this.moved).map(([name, way]) => `${this.bench.shortName(name)} by ${way.join(" ")}`);
    const words = document.createElement("span");
    words.textContent = ways.join("; ") || "Select a held part: its card has a field for its movement.";
    const back = button("Move all back", () => {
      this.moved = {};
      this.results.delete("supports");
      this.draw();
    });
    return ways.length ? [words, back] : [words];
  }

  transport() {
    const field = document.createElement("input");
    field.placeholder = "0.5g 0 0";
    field.setAttribute("aria-label", "acceleration of the carrier x y z [m/s²]");
    const code = document.createElement("select");
    code.setAttribute("aria-label", "rule of load securing");
    for (const name of ["", "en12195", "en12195:tipping", "gdv", "vdi2700:3.5t"]) code.add(new Option(name || "no rule", name));
    const limits = button("Limits of all axes", () => this.ask({}));
    const at = button("At this acceleration [m/s²]", () => {
      const accelerate = numbersOf(entered(field), 3, this.bench.report?.page.gravity);
      if (accelerate) this.ask({ accelerate });
      else this.bench.complain("Give the acceleration: 3 numbers, separated by spaces, in m/s² or with g as 0.5g.");
    });
    const rule = button("By this rule", () => (code.value ? this.ask({ code: code.value }) : this.bench.complain("Choose a rule.")));
    return [limits, field, at, code, rule, ...this.strap.controls()];
  }

  comparison() {
    const { session } = this.bench;
    const labels = ["as opened", ...session.changes.map(({ label }, k) => `${k + 1}: ${label}`)];
    const choice = (name, value) => {
      const select = document.createElement("select");
      select.setAttribute("aria-label", name);
      labels.forEach((label, k) => select.add(new Option(label, String(k))));
      select.value = String(value);
      return select;
    };
    if (labels.length < 2) {
      const words = document.createElement("span");
      words.textContent = "There is no change yet, so there is nothing to compare.";
      return [words];
    }
    const [a, b] = [choice("first state", 0), choice("second state", labels.length - 1)];
    return [a, b, button("Compare", () => {
      this.asked.add("compare");
      this.bench.act({ do: "compare", a: Number(a.value), b: Number(b.value) });
      this.draw();
    })];
  }

  /** The list of changes: each can be reverted; undone changes can be done again. */
  changes({ changes, redo }) {
    const { bench } = this;
    const list = document.createElement("ol");
    list.className = "entries";
    list.append(
      entry("as opened", ...(changes.length ? [button("Go back to here", () => bench.act({ do: "go", index: 0 }))] : [])),
      ...changes.map(({ label }, index) => {
        const buttons = [button("Revert", () => bench.act({ do: "revert", index }), "drops this change and keeps the later ones")];
        if (index + 1 < changes.length) buttons.push(button("Go back to here", () => bench.act({ do: "go", index: index + 1 })));
        return entry(`${index + 1}. ${label}`, ...buttons);
      }),
      ...redo.map(({ label }, k) => entry(`undone: ${label}`, ...(k ? [] : [button("Redo", () => bench.act({ do: "redo" }))]))),
    );
    return list;
  }
}

/** Names of the parts that an answer of hold grips. */
function gripped(result) {
  const supports = result?.data?.supports ?? [];
  return supports.filter(({ kind }) => kind === "grip").map(({ part }) => part);
}
