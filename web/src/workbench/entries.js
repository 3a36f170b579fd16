// Lists of entries with buttons. All words are set as text.

/** A button with a label and an action. */
export function button(label, action, title = "") {
  const element = document.createElement("button");
  element.type = "button";
  element.textContent = label;
  if (title) element.title = title;
  element.addEventListener("click", action);
  return element;
}

/** An entry of a list: words, and buttons beside them. */
export function entry(words, ...buttons) {
  const item = document.createElement("li");
  const text = document.createElement("span");
  text.textContent = words;
  item.append(text, ...buttons);
  return item;
}

/** Replace the content of a box; if one of its buttons has the focus, the button in its place gets it. */
export function refill(box, ...content) {
  const at = [...box.querySelectorAll("button, select, input")].indexOf(document.activeElement);
  box.replaceChildren(...content);
  if (at < 0) return;
  const now = [...box.querySelectorAll("button, select, input")];
  if (now.length) now[Math.min(at, now.length - 1)].focus();
}

/** A titled list in a box; without entries the box is empty. */
export function fill(box, title, entries, ...more) {
  if (!entries.length) {
    box.replaceChildren();
    return;
  }
  const [heading, list] = [document.createElement("h3"), document.createElement("ul")];
  heading.textContent = title;
  list.className = "entries";
  list.append(...entries);
  refill(box, heading, ...more, list);
}

/** Numbers of a text, separated by spaces or commas; null unless there are `count` numbers. */
export function numbersOf(text, count) {
  const numbers = text.trim().split(/[\s,;]+/).filter(Boolean).map(Number);
  return numbers.length === count && numbers.every(Number.isFinite) ? numbers : null;
}
