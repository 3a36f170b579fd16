// `kilter view` makes the page anew when the file changes: direction and view outlive it.

import { angleBetween } from "./vector.js";

const KEY = "kilter";

/** Take up the place that was kept for this file, and keep it when the page goes. */
export function keepPlace(view) {
  const camera = view.stage && view.stage.camera.position;
  try {
    const kept = JSON.parse(sessionStorage.getItem(KEY) || "null");
    if (kept && kept.title === view.page.title) {
      if (kept.down) view.turn(kept.down, { follow: true });
      if (kept.camera && camera) {
        camera.fromArray(kept.camera);
        view.stage.controls.update();
      }
    }
  } catch {
    // what was kept cannot be read: the page starts anew
  }
  addEventListener("pagehide", () => {
    const turned = angleBetween(view.down, view.page.given.down) > 0;
    const place = {
      title: view.page.title,
      down: turned ? view.down : null,
      camera: camera && camera.toArray(),
    };
    sessionStorage.setItem(KEY, JSON.stringify(place));
  });
}
