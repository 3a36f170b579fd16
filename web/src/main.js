// The page: which it is, by what its data hold.

import { pageData } from "./data.js";
import { id } from "./look.js";
import { Plan } from "./plan.js";
import { Report } from "./report.js";

const page = pageData(id("data").textContent);
if (page) {
  id("show").hidden = false;
  window.kilter = page.plan ? new Plan(page) : new Report(page);
}
