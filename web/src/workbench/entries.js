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

/**
 * Numbers of a text, separated by spaces or commas; null unless there are `count` numbers. `g`: the
 * factor of numbers that end with g, as .5g on the command line.
 */
export function numbersOf(text, count, g = null) {
  const words = text.trim().split(/[\s,;]+/).filter(Boolean);
  const value = (word) => (g !== null && /g$/i.test(word) ? g * Number(word.slice(0, -1) || NaN) : Number(word));
  const numbers = words.map(value);
  return numbers.length === count && numbers.every(Number.isFinite) ? numbers : null;
}

/** A coefficient of friction: a number, a share as 30%, or an angle as 17deg; NaN for other text. */
export function frictionOf(text) {
  const word = text.trim();
  if (word.endsWith("%")) return Number(word.slice(0, -1) || NaN) / 100;
  if (word.endsWith("deg")) return Math.tan((Number(word.slice(0, -3) || NaN) * Math.PI) / 180);
  return Number(word || NaN);
}

/** The text of a field; a field that is left alone has the default that it shows in grey. */
export const entered = (field) => field.value.trim() || field.placeholder;
