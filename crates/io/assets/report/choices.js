// What a reader chose, kept while the page of a run that goes on is loaded again, and once more when the whole page takes its place.

const choices = (() => {
  const part = (id) => document.getElementById(id);
  const place = `forwardstep ${location.pathname}`;
  const grows = document.documentElement.dataset.againS !== undefined;
  const nameOf = (e) => e?.id || e?.dataset.plot || e?.className || "";
  const folds = () => [...document.querySelectorAll("main details")].map((fold) => [`${nameOf(fold.parentElement.closest("[id], [data-plot]"))} ${fold.querySelector("summary")?.textContent}`, fold]);
  // The part of the page at the upper edge of the window: what stands above it may have grown.
  const anchors = () => [...document.querySelectorAll("main > *, [data-plot]")].map((e) => [nameOf(e), e.getBoundingClientRect().top]);
  const edge = () => {
    const above = anchors().filter(([, top]) => top <= 1);
    return scrollY > 0 && above.length > 0 ? above.reduce((a, b) => (b[1] >= a[1] ? b : a)) : null;
  };

  const gathered = () => ({
    t: stage.now.t, last: stage.now.t >= stage.end, playing: stage.playing(), rate: part("rate").value, alone: part("chosen").value, camera: { ...camera },
    zoom: view.zoom, breakPoints: view.breakPoints, joint: joint.value, hidden: everybody.map((_, i) => i).filter((i) => !shownAgents.has(i)),
    picks: Object.fromEntries(all.map((card) => [card.dataset.plot, state.get(card)?.picks ?? []])),
    open: folds().filter(([, fold]) => fold.open).map(([name]) => name),
    edge: edge(), focus: document.activeElement?.id ?? "", reload: part("reload")?.checked ?? true,
  });

  const choose = (select, value) => {
    if ([...select.options].some((option) => option.value === value)) select.value = value;
  };
  const scroll = (to) => {
    const now = to && anchors().find(([name]) => name === to[0]);
    if (now) scrollBy({ top: now[1] - to[1], behavior: "instant" });
  };
  const restore = (kept) => {
    history.scrollRestoration = "manual";
    choose(joint, kept.joint);
    for (const card of all) {
      const [mine, picks] = [state.get(card), kept.picks[card.dataset.plot]];
      if (!mine || !picks || String(picks) === String(mine.picks)) continue;
      mine.picks = picks;
      fill(card);
    }
    kept.hidden.forEach((i) => shownAgents.delete(i));
    showAgents();
    view.breakPoints = lines.checked = kept.breakPoints;
    if (kept.zoom) zoomTo(kept.zoom);
    else for (const plot of plots) plot.redraw(false);
    Object.assign(camera, kept.camera);
    part("follow").checked = camera.follow;
    choose(part("rate"), kept.rate);
    choose(part("chosen"), kept.alone);
    part("chosen").dispatchEvent(new Event("change"));
    stage.go(kept.last ? stage.end : kept.t);
    if (kept.playing && !kept.last) part("play").click();
    for (const [name, fold] of folds()) fold.open = kept.open.includes(name);
    if (part("reload")) part("reload").checked = kept.reload;
    part(kept.focus)?.focus({ preventScroll: true });
    scroll(kept.edge);
    // Tables are filled when they have opened.
    addEventListener("load", () => setTimeout(() => (scroll(kept.edge), (history.scrollRestoration = grows ? "manual" : "auto"))));
  };

  // Where a browser keeps nothing, the page is loaded as it was written.
  const storage = (use) => {
    try {
      return use(sessionStorage);
    } catch {
      return null;
    }
  };
  if (grows) addEventListener("pagehide", () => storage((kept) => kept.setItem(place, JSON.stringify(gathered()))));
  return () => {
    const kept = storage((kept) => JSON.parse(kept.getItem(place)));
    if (!grows) storage((kept) => (kept.removeItem(place), kept.removeItem(`${place} since`)));
    try {
      if (kept) restore(kept);
    } catch (error) {
      console.warn(error); // what another page left under this name
    }
  };
})();
