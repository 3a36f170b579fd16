// Short names: the shortest tail that no other name has, "…bolt_2" for "frame/left/bolt_2".

const SHORT = 18; // names up to this length are not shortened [characters]
const BEGINNINGS = /[/\\|:. _-]/; // a tail begins after one of these

/** The short names of a list of names, in the same order. */
export function tailsOf(names) {
  const often = new Map();
  const count = (tail) => often.set(tail, (often.get(tail) || 0) + 1);
  const all = names.map((name) => [...tails(name)]);
  all.forEach((choices, k) => [names[k], ...choices].forEach(count));
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
