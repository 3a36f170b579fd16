// The tree of parts as data: groups from the "/" in names, search, visible rows. No drawing.

/**
 * Nest the names: nodes {label, path, part, children, parts}. A group has `part` null; a group
 * with a single child is merged with it. `parts` lists the indices of all parts in the node.
 */
export function nest(names) {
  const root = { label: "", path: "", part: null, children: [], parts: [], groups: new Map() };
  names.forEach((name, k) => {
    const pieces = name.split("/").filter(Boolean);
    let node = root;
    root.parts.push(k);
    for (const piece of pieces.slice(0, -1)) {
      if (!node.groups.has(piece)) {
        const path = node.path ? `${node.path}/${piece}` : piece;
        const child = { label: piece, path, part: null, children: [], parts: [], groups: new Map() };
        node.groups.set(piece, child);
        node.children.push(child);
      }
      node = node.groups.get(piece);
      node.parts.push(k);
    }
    const label = pieces.length ? pieces[pieces.length - 1] : name;
    node.children.push({ label, path: name, part: k, children: [], parts: [k] });
  });
  return merged(root).children;
}

function merged(node) {
  const children = node.children.map((child) => (child.part === null ? merged(child) : child));
  const single = children.length === 1 && node.label;
  if (!single) return { ...node, children };
  return { ...children[0], label: `${node.label}/${children[0].label}` };
}

/** A test of names for a search: a pattern with * and ?, else a substring; without case. */
export function matcher(text) {
  const wanted = text.trim().toLowerCase();
  if (!/[*?]/.test(wanted)) return (name) => name.toLowerCase().includes(wanted);
  const pattern = wanted.replace(/[.+^${}()|[\]\\]/g, "\\$&").replaceAll("*", ".*").replaceAll("?", ".");
  const whole = new RegExp(`^(.*/)?${pattern}$`, "s");
  return (name) => whole.test(name.toLowerCase());
}

/** The rows of a tree with some groups open: [node, level], at most `most` children of a group. */
export function rowsOf(nodes, open, most, level = 1) {
  const shown = nodes.slice(0, most);
  const rows = shown.flatMap((node) => {
    const inner = node.part === null && open.has(node.path) ? rowsOf(node.children, open, most, level + 1) : [];
    return [[node, level], ...inner];
  });
  const left = nodes.length - shown.length;
  return left > 0 ? [...rows, [{ more: left, parts: [] }, level]] : rows;
}
