// `kilter view` reloads the page when the file changes; direction and view are kept.

import { angleBetween } from "./vector.js";

const KEY = "kilter";

/** Restore the direction and the view stored for this file, and store them when the page closes. */
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
    // unreadable stored data: start with the defaults
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
