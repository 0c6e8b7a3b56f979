// Loads the page of a run that goes on again: about as often as it is written, and not while somebody is at it.
(() => {
  "use strict";
  const usual_ms = 1000 * Math.max(3, Number(document.documentElement.dataset.againS) || 3);
  const said = document.getElementById("running");
  const place = `forwardstep ${location.pathname} since`;

  // For how long the page says the same; a run may be killed, and the page of another may not have been written since.
  let since = Date.now();
  try {
    const before = JSON.parse(sessionStorage.getItem(place));
    if (before?.said === said.textContent) since = before.since;
    sessionStorage.setItem(place, JSON.stringify({ said: said.textContent, since }));
  } catch {
    // Then it is not known.
  }
  const same_ms = Date.now() - since;
  if (same_ms > Math.max(60_000, 5 * usual_ms)) {
    document.getElementById("running-note").textContent =
      `Nothing new for ${Math.round(same_ms / 60_000)} min. If the run was killed, \`forwardstep report\` with its folder finishes this page. `;
  }

  let touched = -Infinity;
  let held = false;
  const touch = () => (touched = performance.now());
  for (const kind of ["pointermove", "wheel", "keydown", "scroll", "touchmove", "input"]) addEventListener(kind, touch, { capture: true, passive: true });
  addEventListener("pointerdown", () => ((held = true), touch()), true);
  for (const kind of ["pointerup", "pointercancel"]) addEventListener(kind, () => ((held = false), touch()), true);

  const reload = document.getElementById("reload");
  const isBusy = () => held || performance.now() - touched < (document.activeElement?.tagName === "SELECT" ? 10_000 : 1500);
  const look = () => (reload.checked && !document.hidden && !isBusy() ? location.reload() : setTimeout(look, 250));
  setTimeout(look, Math.max(usual_ms, Math.min(60_000, same_ms / 4)));
})();
