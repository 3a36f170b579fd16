// The tab "Place": the map of places of the next box on the stage, and the box under the pointer.

import { stateAt } from "../place_state.js";
import { button, entered, numbersOf } from "./entries.js";

const WORDS = { stands: "the box stands", falls: "something falls", open: "open" };

export class Places {
  constructor(bench) {
    this.bench = bench;
    this.entered = { size: "", mass: "" };
    this.shown = null;
  }

  /** Fields of the box, and a button that computes its map. */
  controls(ask) {
    const field = (key, placeholder, label) => {
      const input = document.createElement("input");
      input.id = `place-${key}`;
      input.placeholder = placeholder;
      input.value = this.entered[key];
      input.setAttribute("aria-label", label);
      input.addEventListener("input", () => (this.entered[key] = input.value));
      input.addEventListener("keydown", (e) => {
        if (e.key !== "Enter") return;
        e.preventDefault(); // the button that takes the focus, Stop, is not pressed
        compute();
      });
      return input;
    };
    const units = this.bench.report?.page.units ?? "";
    const size = field("size", "0.4 0.3 0.25", `length, width and height of the box${units ? ` [${units}]` : ""}`);
    const mass = field("mass", "6", "mass of the box [kg]");
    const compute = () => {
      const [lengths, kg] = [numbersOf(entered(size), 3), numbersOf(entered(mass), 1)];
      if (lengths && kg) ask({ size: lengths, mass: kg[0] });
      else this.bench.complain("Give the size of the box, 3 numbers separated by spaces, and its mass in kg.");
    };
    const words = document.createElement("span");
    words.id = "place-state";
    words.setAttribute("role", "status");
    return [size, mass, button("Map the places", compute), words];
  }

  /** Show the map of a result on the stage; without a result the stage has no map. */
  tell(result) {
    const stage = this.bench.report?.stage;
    if (!stage || this.shown === result) return;
    this.shown = result;
    if (result) {
      this.listen(stage);
      const { center, radius } = this.bench.report.page;
      stage.places.set(result.data.levels, result.place, center, radius);
    } else stage.places.clear();
    stage.draw();
  }

  /** A coordinate as text; below the rounding of the picture it is 0. */
  length(value) {
    return Math.abs(value) < 1e-6 * this.bench.report.page.radius ? "0" : value.toPrecision(4);
  }

  listen(stage) {
    if (this.heard === stage) return;
    this.heard = stage;
    stage.canvas.addEventListener("pointermove", (e) => this.move(e));
    stage.canvas.addEventListener("pointerleave", () => this.put(null));
  }

  move(event) {
    if (!this.shown || event.buttons) return;
    const { stage } = this.bench.report;
    const box = stage.canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    this.put(stage.places.under(x, y, stage.camera));
  }

  /** Put the box at a place, and say whether it stands there. */
  put(place) {
    if (!this.shown) return;
    const { stage } = this.bench.report;
    const found = place && stateAt(this.shown.data.levels, ...place);
    stage.places.move(place, found);
    stage.draw();
    const words = document.getElementById("place-state");
    if (!words) return;
    words.dataset.state = found ? found.state : "";
    words.textContent = found
      ? `x ${this.length(place[0])}, y ${this.length(place[1])}: ${WORDS[found.state]}`
      : "move the pointer over the map";
  }
}
