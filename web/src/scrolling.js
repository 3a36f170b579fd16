// Wheel and touch over the picture scroll the page, unless the picture has the focus.

export function scrollPast(stage, canvas) {
  const change = () => {
    const has = document.activeElement === canvas;
    stage.controls.enableZoom = has;
    canvas.style.touchAction = has ? "none" : "pan-y";
  };
  canvas.addEventListener("focus", change);
  canvas.addEventListener("blur", change);
  change();
}
