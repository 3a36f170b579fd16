// Questions to the user: parts to settle, pairs that look fastened, and open pairs.

import { id } from "../dom.js";
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
    id("decide").hidden = !open.length && !left.length && !settle;
    id("decide").classList.toggle("urgent", decides.length > 0);
    const fixed = left.filter((one) => one.fixed);
    fill(
      id("suggestions"),
      `Pairs that look fastened (${left.length})`,
      left.slice(0, LISTED).map((one) => this.pair(one, [["Join", () => bench.act({ do: "fasten", parts: one.parts, on: true })]])),
      ...(fixed.length ? [button("Join all of them", () => bench.act({ do: "fasten_suggested", on: true }), "joins the pairs that are suggested as fixed")] : []),
    );
    const list = [...decides, ...open.filter((pair) => !pair.decides)];
    const decide = (pairs, as) => bench.act({ do: "pair", pairs: pairs.map(({ parts }) => parts), as });
    fill(
      id("open-pairs"),
      `Open pairs (${list.length})`,
      list.slice(0, LISTED).map((one) =>
        this.pair(one, [
          ["Touch", () => decide([one], "touching")],
          ["Apart", () => decide([one], "apart")],
          ["Join", () => decide([one], "joined")],
        ]),
      ),
      ...(list.length > 1
        ? [["All of them touch", "touching"], ["are apart", "apart"], ["are joined", "joined"]].map(([words, as]) => button(words, () => decide(list, as)))
        : []),
    );
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
    const show = button(`${names}: ${one.words}`, () => bench.zoomToNames(one.parts), "show this pair");
    show.className = "link";
    const item = entry("", ...actions.map(([label, action]) => button(label, action)));
    item.firstChild.append(show);
    return item;
  }
}
