// Pictures and videos of the stage.

import { id } from "../dom.js";

const FINE = 2; // pixels of a picture per CSS pixel
const RATE = 30; // pictures of a video per second
const ROUND = 6000; // duration of a turn around an assembly at rest [ms]
const AFTER = 400; // a video shows the last picture for this time [ms]
const KINDS = ["video/mp4", "video/webm"];

/** The stage as it is shown, as a PNG file. */
export function picture(stage) {
  const [width, height] = stage.size;
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: FINE * width, height: FINE * height });
  const layer = canvas.cloneNode();
  stage.shootInto(layer, stage.camera, FINE);
  const context = canvas.getContext("2d");
  context.fillStyle = getComputedStyle(document.body).getPropertyValue("--surface");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(layer, 0, 0);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

/**
 * A video of what moves on the stage: the film of a plan, the fall, the motion, or a turn around
 * the assembly. Returns the video and the ending of its file.
 */
export async function video(bench) {
  if (!window.MediaRecorder) throw new Error("this browser records no video");
  const kind = KINDS.find((each) => MediaRecorder.isTypeSupported(each));
  const recorder = new MediaRecorder(id("picture").captureStream(RATE), { mimeType: kind });
  const pieces = [];
  recorder.addEventListener("dataavailable", (e) => pieces.push(e.data));
  const ended = new Promise((done) => recorder.addEventListener("stop", done));
  recorder.start();
  await play(bench);
  await new Promise((done) => setTimeout(done, AFTER));
  recorder.stop();
  await ended;
  return [new Blob(pieces, { type: kind }), kind.split("/")[1]];
}

/** Play what moves once; resolves at its end. */
async function play({ report, tabs }) {
  const { onStage } = tabs;
  if (report.film) {
    onStage.go(0);
    onStage.play();
    await until(() => !onStage.playing);
  } else if (report.found.fall?.places) {
    report.fall(0);
    report.fallClip.play();
    await until(() => !report.fallClip.playing);
  } else if (report.found.motion) {
    report.play();
    await until(() => !report.playing);
  } else {
    let last = performance.now();
    const end = last + ROUND;
    await until((now) => {
      report.stage.orbit((2 * Math.PI * (now - last)) / ROUND, 0);
      last = now;
      return now >= end;
    });
  }
}

/** Resolve at the first picture for which a test holds. */
const until = (test) =>
  new Promise((done) => {
    const step = (now) => (test(now) ? done() : requestAnimationFrame(step));
    requestAnimationFrame(step);
  });
