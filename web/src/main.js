// Entry point: starts the page of a report, of a plan, or of the workbench, depending on the data.

import { pageData } from "./data.js";
import { id } from "./dom.js";
import { printWell } from "./paper.js";
import { Plan } from "./plan.js";
import { Report } from "./report.js";
import { scrollPast } from "./scrolling.js";
import { readTables } from "./tables.js";
import { Workbench } from "./workbench/bench.js";

const page = pageData(id("data").textContent);
if (page && page.workbench) {
  window.bench = new Workbench(page.workbench);
} else if (page) {
  id("show").hidden = false;
  window.kilter = page.plan ? new Plan(page) : new Report(page);
  readTables(page);
  printWell(window.kilter, id("printed"));
  if (window.kilter.stage) scrollPast(window.kilter.stage, id("picture"));
}
