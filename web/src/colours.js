// Colours: instability from pale to dark (brightness, not hue alone), and the style of the page.

/** The colour of an instability from 0 to 1 in a table of colours from light to dark. */
export function ramp(share, table) {
  const at = Math.max(0, Math.min(1, share)) * (table.length - 1);
  const k = Math.min(table.length - 2, Math.floor(at));
  return table[k].map((c, i) => c + (at - k) * (table[k + 1][i] - c));
}

/** The colour table of the page's style: rows of red, green, blue from 0 to 255. */
export const rampOf = (style) => coloursOf(style, "ramp");

/** A list of colours of the page's style, as rows of red, green, blue from 0 to 255. */
export const coloursOf = (style, name) => style(name).split(",").map((text) => rgb(text.trim()));

/** A function that returns a colour of the page's style by the name of its CSS variable. */
export function themeOf(element) {
  const style = getComputedStyle(element);
  return (name) => style.getPropertyValue(`--${name}`).trim();
}

/** The colour of a body of joined parts by its number. */
export function bodyColour(style, number) {
  const table = coloursOf(style, "bodies");
  return table[number % table.length];
}

/** "#rrggbb" as three numbers from 0 to 255. */
export const rgb = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
