// Short names: the last component first, "bolt (2/1)" for "bracket_2/pair_1/bolt"; flat names by
// their shortest unique tail.

const SHORT = 18; // flat names up to this length are not shortened [characters]
const BEGINNINGS = /[\\|:. _-]/; // a tail of a flat name begins after one of these
const WORD = /[\\|:. _-]$/; // the shared beginning of components ends after one of these

/** The short names of a list of names, in the same order; they differ like the names. */
export function tailsOf(names) {
  const paths = names.map((name) => name.split("/").filter(Boolean));
  const groups = new Map();
  paths.forEach((path, k) => {
    const last = path.length ? path[path.length - 1] : names[k];
    if (groups.has(last)) groups.get(last).push(k);
    else groups.set(last, [k]);
  });
  const result = [...names];
  for (const [last, group] of groups) {
    if (group.length === 1) result[group[0]] = last;
    else contexts(group.map((k) => paths[k].slice(0, -1))).forEach((context, n) => (result[group[n]] = context ? `${last} (${context})` : last));
  }
  const flat = flatTails(result);
  return new Set(flat).size === names.length ? flat : names;
}

/** The differing ends of the paths of equal last components, level by level. */
function contexts(paths) {
  const depth = Math.max(...paths.map((path) => path.length));
  // levels are counted from the last component, so that shorter paths lack the outer ones
  const levels = Array.from({ length: depth }, (_, n) => paths.map((path) => path[path.length - 1 - n] ?? ""));
  const kept = levels.filter((level) => new Set(level).size > 1).map(withoutShared);
  return paths.map((_, k) => kept.map((level) => level[k]).reverse().filter(Boolean).join("/"));
}

/** The components without the beginning that all of them share, unless one would be empty. */
function withoutShared(level) {
  let shared = level[0];
  for (const name of level) while (!name.startsWith(shared)) shared = shared.slice(0, -1);
  while (shared && !WORD.test(shared)) shared = shared.slice(0, -1);
  return level.some((name) => name.length === shared.length) ? level : level.map((name) => name.slice(shared.length));
}

/** Long names by their shortest tail that no other name has. */
function flatTails(names) {
  const often = new Map();
  const all = names.map((name) => (name.includes("(") ? [] : [...tails(name)]));
  all.forEach((choices, k) => [names[k], ...choices].forEach((tail) => often.set(tail, (often.get(tail) || 0) + 1)));
  return names.map((name, k) => {
    if (name.length <= SHORT) return name;
    const tail = all[k].find((choice) => often.get(choice) === 1);
    return tail === undefined || tail.length > name.length - 4 ? name : `…${tail}`;
  });
}

/** The tails of a name that begin at a word, the shortest first. */
function* tails(name) {
  for (let k = name.length - 4; k > 0; k -= 1) {
    if (BEGINNINGS.test(name[k - 1])) yield name.slice(k);
  }
}
