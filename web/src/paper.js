// Printing: light colours, with the current picture and the gravity ball.

import { themeOf } from "./colours.js";

const ROWS = 400; // closed sections are printed up to this many table rows

/** Prepare the page for print at `beforeprint` and restore it at `afterprint`. */
export function printWell(shown, canvas) {
  const root = document.documentElement;
  let was = null;
  let opened = [];
  window.addEventListener("beforeprint", () => {
    was = root.dataset.theme || "";
    opened = [...document.querySelectorAll("details:not([open])")].filter(
      (section) => section.querySelectorAll("tr").length <= ROWS,
    );
    for (const section of opened) section.open = true;
    root.dataset.theme = "light";
    shown.theme();
    if (shown.ball) shown.ball.paint();
    canvas.hidden = !shown.stage;
    if (shown.stage) picture(shown, canvas);
  });
  window.addEventListener("afterprint", () => {
    if (was) root.dataset.theme = was;
    else delete root.dataset.theme;
    for (const section of opened) section.open = false;
    shown.theme();
  });
}

/** Copy the current picture and its names to a 2D canvas; browsers do not print a WebGL canvas. */
function picture({ stage, names }, canvas) {
  const [width, height] = stage.size;
  const dense = canvas.width / width;
  canvas.height = Math.round(height * dense);
  // Chromium prints drawn images, but not pixels from putImageData
  const layer = document.createElement("canvas");
  Object.assign(layer, { width: canvas.width, height: canvas.height });
  stage.shootInto(layer, stage.camera, dense);
  const style = themeOf(document.documentElement);
  const c = canvas.getContext("2d");
  c.drawImage(layer, 0, 0);
  c.font = `600 ${13 * dense}px system-ui, sans-serif`;
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.lineJoin = "round";
  c.lineWidth = 4 * dense;
  c.strokeStyle = style("surface");
  c.fillStyle = style("ink");
  for (const [part, { element, off }] of names.tags) {
    const at = off && stage.onScreen(stage.parts.centre(part));
    if (!at) continue;
    const where = [0, 1].map((i) => (at[i] + off[i]) * dense);
    c.strokeText(element.textContent, ...where);
    c.fillText(element.textContent, ...where);
  }
}
