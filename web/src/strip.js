// The steps as a strip of small pictures; each is a button.

const WIDE = 168;
const HIGH = 126;

export class Strip {
  /** `go(k)` shows step k in the large picture; `paint(k, canvas)` draws its small picture. */
  constructor(list, page, go, paint) {
    Object.assign(this, { list, page, go, paint, now: -1, stale: new Set() });
    this.buttons = page.plan.steps.map((step, k) => this.button(step, k));
    list.replaceChildren(
      ...this.buttons.map((button) => {
        const item = document.createElement("li");
        item.append(button);
        return item;
      }),
    );
    list.addEventListener("keydown", (e) => this.key(e));
    addEventListener("beforeprint", () => this.finish());
    this.seen = new IntersectionObserver((entries) => {
      entries.forEach((entry) => entry.isIntersecting && this.want(this.buttons.indexOf(entry.target)));
    }, { rootMargin: "300px" });
    this.renew();
  }

  button(step, k) {
    const make = (kind, name, text) => {
      const element = document.createElement(kind);
      element.className = name;
      element.textContent = text;
      return element;
    };
    const button = make("button", "step", "");
    button.type = "button";
    button.tabIndex = k ? -1 : 0;
    const canvas = document.createElement("canvas");
    canvas.width = 2 * WIDE;
    canvas.height = 2 * HIGH;
    const { tails } = this.page.parts;
    const names = step.parts.map((part) => tails[part]).join(", ");
    const held = step.held.map((part) => tails[part]).join(", ");
    const word = make("bdi", "step-name", names);
    button.append(canvas, make("span", "step-number", String(k + 1)), word);
    if (held) button.append(make("span", "step-held", `hold ${held}`));
    button.addEventListener("click", () => this.go(k));
    return button;
  }

  key(event) {
    const last = this.buttons.length - 1;
    const ways = { ArrowLeft: this.now - 1, ArrowRight: this.now + 1, Home: 0, End: last };
    if (!(event.key in ways)) return;
    event.preventDefault();
    const k = Math.max(0, Math.min(last, ways[event.key]));
    this.go(k);
    this.buttons[k].focus();
  }

  /** Mark step k as the current step, and scroll to it. */
  mark(k) {
    if (this.now === k) return;
    this.now = k;
    this.buttons.forEach((button, j) => {
      button.tabIndex = j === k ? 0 : -1;
      if (j === k) button.setAttribute("aria-current", "step");
      else button.removeAttribute("aria-current");
    });
    const [item, list] = [this.buttons[k].parentElement, this.list];
    const left = item.offsetLeft - list.offsetLeft;
    if (left < list.scrollLeft || left + item.offsetWidth > list.scrollLeft + list.clientWidth) {
      list.scrollLeft = left - (list.clientWidth - item.offsetWidth) / 2;
    }
  }

  /** Repaint all pictures: first those in view, one after the other. */
  renew() {
    this.stale = new Set(this.buttons.keys());
    this.queue = [];
    this.seen.disconnect();
    this.buttons.forEach((button) => this.seen.observe(button));
  }

  want(k) {
    if (!this.stale.has(k) || this.queue.includes(k)) return;
    this.queue.push(k);
    if (!this.busy) this.next();
  }

  next() {
    const k = this.queue.shift();
    this.busy = k !== undefined;
    if (!this.busy) return;
    this.draw(k);
    setTimeout(() => this.next(), 0);
  }

  draw(k) {
    this.stale.delete(k);
    this.paint(k, this.buttons[k].firstChild);
  }

  /** Paint all remaining pictures at once, for print. */
  finish() {
    for (const k of [...this.stale]) this.draw(k);
  }
}
