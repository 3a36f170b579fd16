// Names by their shortest tail that no other part has: "…bolt_2" for "frame/left/bolt_2".

const SHORT = 18; // characters up to which a name is left as it is
const BEGINNINGS = /[/\\|:. _-]/; // a tail begins after one of these

/** The tails of names, in their order. */
export function tailsOf(names) {
  const often = new Map();
  const count = (tail) => often.set(tail, (often.get(tail) || 0) + 1);
  const all = names.map((name) => [...tails(name)]);
  all.forEach((own, k) => [names[k], ...own].forEach(count));
  return names.map((name, k) => {
    if (name.length <= SHORT) return name;
    const tail = all[k].find((one) => often.get(one) === 1);
    return tail === undefined || tail.length > name.length - 4 ? name : `…${tail}`;
  });
}

/** The tails of a name, the shortest first; none is shorter than a word. */
function* tails(name) {
  for (let k = name.length - 4; k > 0; k -= 1) {
    if (BEGINNINGS.test(name[k - 1])) yield name.slice(k);
  }
}
