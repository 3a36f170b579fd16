// What the answer leaves to the user: remedies, pairs that look fastened, and open pairs.

import { id } from "../dom.js";
import { button, entry, fill } from "./entries.js";
import { sentence } from "./start.js";

const LISTED = 60; // entries of a list; a button settles all of them

export class Decide {
  constructor(bench) {
    this.bench = bench;
  }

  tell({ open, suggestions, remedies, settle }) {
    const { bench } = this;
    Object.assign(this, { offer: settle, settling: false, refusal: "" });
    this.tellSettle();
    const decides = open.filter((pair) => pair.decides);
    const left = suggestions.filter((one) => !one.joined);
    id("decide").hidden = !open.length && !left.length && !remedies.length && !settle;
    id("decide").classList.toggle("urgent", decides.length > 0);
    const verdicts = bench.report.page.words;
    fill(
      id("remedies"),
      "Remedies",
      remedies.filter(({ actions }) => actions.length && actions[0].do !== "settle").map((one) => {
        const words = one.actions.map((action) => this.words(action)).join(", ");
        const end = verdicts[one.leads_to] ?? one.leads_to;
        return entry(end ? `${words}: then ${end.toLowerCase()}` : words, button("Do it", () => this.all(one.actions)));
      }),
    );
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
      const words = offer.result ? `${offer.parts}: ${offer.result}` : offer.parts;
      return entry(words, button("Settle", ask, "moves the parts by little until they rest on each other; undo takes it back"));
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

  /** Words for the action of a remedy. */
  words({ do: name, parts = [], mu, ...rest }) {
    const names = parts.map((part) => this.bench.shortName(part)).join(" and ");
    const words = {
      fasten_suggested: "join the pairs that look fastened",
      fasten_overlaps: "join the pairs that overlap",
      loose: "loose tolerances",
      friction: `friction ${mu}`,
      fasten: `join ${names}`,
      leave_out: `leave out ${names}`,
      hold: `hold ${names}`,
      tolerance: `tolerance: ${Object.entries(rest).map(([key, value]) => `${key} ${value}`).join(", ")}`,
    };
    return words[name] ?? name;
  }

  /** Do several actions, one after the other. */
  async all(actions) {
    for (const action of actions) {
      const reply = await this.bench.act(action);
      if (!reply.ok) return;
    }
  }
}
