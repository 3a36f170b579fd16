// Copying text to the clipboard.

/** Copy text; a button that states the result for a moment may be given. */
export async function copyText(text, button = null) {
  const done = (await viaClipboard(text)) || viaSelection(text);
  if (!button) return done;
  const label = (button.dataset.label ??= button.textContent);
  button.textContent = done ? "Copied" : "Copying is not allowed here";
  clearTimeout(button.copied);
  button.copied = setTimeout(() => (button.textContent = label), 1500);
  return done;
}

async function viaClipboard(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false; // no clipboard in this frame, or no permission
  }
}

function viaSelection(text) {
  const area = document.createElement("textarea");
  area.value = text;
  area.setAttribute("readonly", "");
  area.className = "offscreen";
  document.body.append(area);
  const focused = document.activeElement;
  area.select();
  const done = document.execCommand("copy");
  area.remove();
  if (focused) focused.focus({ preventScroll: true });
  return done;
}
