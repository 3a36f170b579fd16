// Tables of the page: names are short, and in narrow windows each row is a card.

/** Label the table cells with their columns for narrow windows, and shorten the names. */
export function readTables(page, box = document) {
  for (const table of box.querySelectorAll(".text table, .sheet table")) label(table);
  const tails = new Map();
  page.parts.tails.forEach((tail, k) => tails.set(page.parts.names[k], tail));
  for (const element of box.querySelectorAll(".text .name, #cards .name, .sheet .name")) {
    const tail = tails.get(element.textContent);
    if (tail === undefined || tail === element.textContent) continue;
    element.title = element.textContent;
    element.textContent = tail;
  }
}

function label(table) {
  const head = [...table.querySelectorAll("th")].map((cell) => cell.textContent);
  for (const row of table.tBodies[0].rows) {
    [...row.cells].forEach((cell, k) => {
      if (head[k]) cell.dataset.column = head[k];
    });
  }
}
