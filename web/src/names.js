// Name labels over the picture: each label lies on its own part and covers no other part.

import { short } from "./words.js";

export const CELL = 4; // size of a cell of the picture of part numbers [CSS px]
const REST = 140; // labels are placed anew after this time without a new picture [ms]
const ROOM = 1; // margin around a label [cells]

/**
 * Position of a label: the middle of a rectangle of `wide` x `high` cells, or null if none fits.
 * The rectangle contains no cell of another part and none of `taken`. At least half of it lies on
 * the label's part, all of it if possible; among those, the one nearest to `at` is chosen. `cells`
 * has the number of the part in each cell, counted from 1, and 0 for the background.
 */
export function spotFor(cells, width, height, part, at, wide, high, taken) {
  const own = part + 1;
  const box = boundsOf(cells, width, height, own);
  if (!box) return null;
  const [left, top] = [Math.max(0, box[0] - wide), Math.max(0, box[1] - high)];
  const [right, bottom] = [Math.min(width, box[2] + wide + 1), Math.min(height, box[3] + high + 1)];
  const [w, h] = [right - left + 1, bottom - top + 1];
  const mine = new Int32Array(w * h); // summed-area tables: counts above and to the left
  const others = new Int32Array(w * h);
  for (let y = 1; y < h; y += 1) {
    for (let x = 1; x < w; x += 1) {
      const k = (top + y - 1) * width + left + x - 1;
      const [i, up] = [y * w + x, (y - 1) * w + x];
      const other = taken[k] || (cells[k] && cells[k] !== own) ? 1 : 0;
      mine[i] = (cells[k] === own && !other ? 1 : 0) + mine[i - 1] + mine[up] - mine[up - 1];
      others[i] = other + others[i - 1] + others[up] - others[up - 1];
    }
  }
  const sum = (array, x, y) =>
    array[(y + high) * w + x + wide] - array[y * w + x + wide] - array[(y + high) * w + x] + array[y * w + x];
  let [best, least] = [null, Infinity];
  for (let y = 0; y + high < h; y += 1) {
    for (let x = 0; x + wide < w; x += 1) {
      if (sum(others, x, y)) continue;
      const share = sum(mine, x, y) / (wide * high);
      if (share < 0.5) continue;
      const middle = [left + x + wide / 2, top + y + high / 2];
      const cost = Math.hypot(middle[0] - at[0], middle[1] - at[1]) + (share < 1 ? 1e4 * (1 - share) : 0);
      if (cost < least) [best, least] = [middle, cost];
    }
  }
  return best;
}

/** Bounding box of a part's cells as [left, top, right, bottom]; null if the part is not seen. */
function boundsOf(cells, width, height, own) {
  const box = [Infinity, Infinity, -1, -1];
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      if (cells[y * width + x] !== own) continue;
      box[0] = Math.min(box[0], x);
      box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x);
      box[3] = Math.max(box[3], y);
    }
  }
  return box[2] < 0 ? null : box;
}

/** The labels as text elements. While the picture moves, they move with their parts. */
export class Names {
  constructor(element, stage) {
    Object.assign(this, { element, stage });
    this.tags = new Map();
  }

  /** Replace the labels by those of the listed parts. */
  show(list) {
    this.element.replaceChildren();
    this.element.hidden = !list.length;
    this.tags = new Map(
      list.map((k) => {
        const element = document.createElement("span");
        element.textContent = short(this.stage.page.parts.tails[k], 24);
        this.element.append(element);
        return [k, { element, off: null }];
      }),
    );
    this.settle();
  }

  /** Move the labels with their parts; place them anew once the picture rests. */
  place() {
    for (const [k, { element, off }] of this.tags) {
      const at = off && this.stage.parts.shown(k) && this.stage.onScreen(this.stage.parts.centre(k));
      element.style.visibility = at ? "visible" : "hidden";
      if (at) element.style.transform = `translate(${at[0] + off[0]}px, ${at[1] + off[1]}px) translate(-50%, -50%)`;
    }
    clearTimeout(this.waiting);
    if (this.tags.size) this.waiting = setTimeout(() => this.settle(), REST);
  }

  /** Find a position for each label, the largest parts first. */
  settle() {
    const { stage, tags } = this;
    if (!tags.size || !stage.size) return;
    const { cells, width, height } = stage.numbered(CELL);
    const taken = new Uint8Array(cells.length);
    const { radius } = stage.page.parts;
    for (const k of [...tags.keys()].sort((a, b) => radius[b] - radius[a])) {
      const tag = tags.get(k);
      const at = stage.onScreen(stage.parts.centre(k));
      const [wide, high] = [tag.element.offsetWidth, tag.element.offsetHeight].map((size) => Math.ceil(size / CELL) + 2 * ROOM);
      const spot = at && wide < width && high < height && spotFor(cells, width, height, k, [at[0] / CELL, at[1] / CELL], wide, high, taken);
      tag.off = spot ? [spot[0] * CELL - at[0], spot[1] * CELL - at[1]] : null;
      if (spot) mark(taken, width, spot, wide, high);
    }
    this.place();
    clearTimeout(this.waiting);
  }
}

/** Mark the cells under a placed label as taken. */
function mark(taken, width, [x, y], wide, high) {
  for (let j = Math.round(y - high / 2); j < y + high / 2; j += 1) {
    taken.fill(1, j * width + Math.round(x - wide / 2), j * width + Math.round(x + wide / 2));
  }
}
