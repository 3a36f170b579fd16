// A movement that plays: a button, and a slider from 0 to 1.

import { id, on } from "./dom.js";

const LASTS = 2400; // duration of the whole movement [ms]

/** Share of the way after a share of the time; a power of 2 accelerates evenly from rest. */
export const paced = (time, power) => Math.min(1, Math.max(0, time)) ** power;

export class Clip {
  /** Controls `NAME-play` and `NAME-at`; `show` shows a share of the way. */
  constructor(name, power, show) {
    Object.assign(this, { power, show, playing: null });
    this.button = id(`${name}-play`);
    this.slider = id(`${name}-at`);
    on(`${name}-play`, "click", () => this.play());
    on(`${name}-at`, "input", () => {
      this.stop();
      this.show(Number(this.slider.value));
    });
  }

  /** Play on from the current share, from the start if it is over; or pause. */
  play() {
    if (this.playing) {
      this.stop();
      return;
    }
    const share = Number(this.slider.value);
    const from = share < 1 ? share ** (1 / this.power) : 0;
    const started = performance.now();
    this.playing = started;
    this.button.textContent = "Pause";
    const step = (now) => {
      if (this.playing !== started) return;
      const time = from + Math.max(0, now - started) / LASTS;
      this.show(paced(time, this.power));
      if (time >= 1) this.stop();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    this.playing = null;
    this.button.textContent = "Play";
  }
}
