// Colours: instability from pale to dark (never by hue alone), and the style of the page.

const RAMP = [
  [255, 246, 222],
  [253, 214, 140],
  [243, 161, 75],
  [213, 94, 0],
  [140, 48, 6],
];

/** The colour of an instability from 0 to 1: light to dark, yellow to brown. */
export function ramp(share) {
  const at = Math.max(0, Math.min(1, share)) * (RAMP.length - 1);
  const k = Math.min(RAMP.length - 2, Math.floor(at));
  return RAMP[k].map((c, i) => c + (at - k) * (RAMP[k + 1][i] - c));
}

/** The colours of the page's style, by their names there. */
export function themeOf(element) {
  const style = getComputedStyle(element);
  return (name) => style.getPropertyValue(`--${name}`).trim();
}

/** "#rrggbb" as three numbers from 0 to 255. */
export const rgb = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
