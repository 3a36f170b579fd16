// Questions to the user: parts to settle, pairs that look fastened, and open pairs.

import { id } from "../dom.js";
import { shortened } from "../words.js";
import { button, entry, fill } from "./entries.js";
import { sentence } from "./start.js";

const LISTED = 60; // entries of a list; a button settles all of them

export class Decide {
  constructor(bench) {
    this.bench = bench;
  }

  tell({ open, suggestions, settle }) {
    const { bench } = this;
    Object.assign(this, { offer: settle, settling: false, refusal: "" });
    this.tellSettle();
    const decides = open.filter((pair) => pair.decides);
    const left = suggestions.filter((one) => !one.joined);
    const urgent = left.filter((one) => one.decides);
    id("decide").hidden = !open.length && !left.length && !settle;
    id("decide").classList.toggle("urgent", decides.length > 0);
    bench.layout.count(decides.length + urgent.length + (settle ? 1 : 0));
    const join = (one) => this.pair(one, [["Join", () => bench.act({ do: "fasten", parts: one.parts, on: true })]]);
    fill(
      id("suggestions"),
      `Pairs that look fastened (${urgent.length})`,
      urgent.slice(0, LISTED).map(join),
      button("Join all of them", () => bench.act({ do: "fasten_suggested", on: true }), "joins all pairs that look fastened"),
    );
    const decide = (pairs, as) => bench.act({ do: "pair", pairs: pairs.map(({ parts }) => parts), as });
    const open_ = (one) =>
      this.pair(one, [
        ["Touch", () => decide([one], "touching")],
        ["Apart", () => decide([one], "apart")],
        ["Join", () => decide([one], "joined")],
      ]);
    fill(id("open-pairs"), `Open pairs (${decides.length})`, decides.slice(0, LISTED).map(open_), ...(decides.length > 1 ? all(decides, decide) : []));
    const idle = open.filter((pair) => !pair.decides);
    const others = left.filter((one) => !one.decides);
    fold(id("idle-pairs"), "Pairs that do not change the verdict", [...idle.map(open_), ...others.map(join)], idle.length > 1 ? all(idle, decide) : []);
  }

  /** Offer to settle parts that overlap or hang; absent without such parts. */
  tellSettle() {
    const { bench, offer } = this;
    const ask = async () => {
      Object.assign(this, { settling: true, refusal: "" });
      this.tellSettle();
      if (!(await bench.act({ do: "settle" })).ok) this.refused({ error: "" });
    };
    const line = () => {
      if (this.settling) return entry("The parts are moved until they rest on each other …", button("Stop", () => bench.act({ do: "stop" })));
      return entry(offer.parts, button("Settle", ask, "moves the parts by little until they rest on each other; undo takes it back"));
    };
    fill(id("settle"), "Parts that overlap or hang", offer ? [line(), ...(this.refusal ? [entry(this.refusal)] : [])] : []);
  }

  /** State why the parts were not settled. */
  refused(problem) {
    Object.assign(this, { settling: false, refusal: problem.error ? sentence(problem) : "" });
    this.tellSettle();
  }

  /** An entry of a pair: its words zoom to it, its buttons settle it. */
  pair(one, actions) {
    const { bench } = this;
    const names = one.parts.map((name) => bench.shortName(name)).join(" – ");
    const show = button(shortened(bench.report.page, `${names}: ${one.words}`), () => bench.zoomToNames(one.parts), "show this pair");
    show.className = "link";
    const item = entry("", ...actions.map(([label, action]) => button(label, action)));
    item.firstChild.append(show);
    return item;
  }
}

/** Buttons that decide all open pairs of a list. */
const all = (list, decide) =>
  [["All of them touch", "touching"], ["are apart", "apart"], ["are joined", "joined"]].map(([words, as]) => button(words, () => decide(list, as)));

/** A folded list in a box; it stays open if the user has opened it. */
function fold(box, title, entries, buttons) {
  const opened = box.querySelector("details")?.open;
  box.replaceChildren();
  if (!entries.length) return;
  const [details, summary, list] = ["details", "summary", "ul"].map((kind) => document.createElement(kind));
  details.open = Boolean(opened);
  summary.textContent = `${title} (${entries.length})`;
  list.className = "entries";
  list.append(...entries.slice(0, LISTED));
  details.append(summary, ...buttons, list);
  box.append(details);
}
