// Access to elements of the page by their ids.

export const id = (name) => document.getElementById(name);
export const on = (name, type, action) => id(name).addEventListener(type, action);

/** Fill a description list with terms and values, set as text. */
export function listFacts(list, facts) {
  list.replaceChildren(
    ...facts.flatMap(([term, value]) => {
      const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
      dt.textContent = term;
      dd.textContent = value;
      return [dt, dd];
    }),
  );
}
