// Narrow windows: each table row becomes a card with the names of its columns; names are short.

const NARROW = "(max-width: 480px)";

/** Label the table cells with their columns, and shorten names while the window is narrow. */
export function readNarrow(page) {
  for (const table of document.querySelectorAll(".text table")) label(table);
  const tails = new Map();
  page.parts.tails.forEach((tail, k) => tails.set(page.parts.names[k], tail));
  const query = matchMedia(NARROW);
  const change = () => rename(tails, query.matches);
  query.addEventListener("change", change);
  change();
}

function label(table) {
  const head = [...table.querySelectorAll("th")].map((cell) => cell.textContent);
  for (const row of table.tBodies[0].rows) {
    [...row.cells].forEach((cell, k) => {
      if (head[k]) cell.dataset.column = head[k];
    });
  }
}

/** Replace full names by their shortest unique tails, or restore them. */
function rename(tails, narrow) {
  for (const element of document.querySelectorAll(".text .name, #margins .name")) {
    const whole = element.title || element.textContent;
    const tail = tails.get(whole);
    if (tail === undefined || tail === whole) continue;
    element.title = narrow ? whole : "";
    element.textContent = narrow ? tail : whole;
  }
}
