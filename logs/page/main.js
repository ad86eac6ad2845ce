// Playing, keys, and the first drawing.

let playing = null; // the moment of the last frame, by the browser's clock

function frame(now) {
  if (playing === null) return;
  const passed = Math.min(now - playing, 250) / 1000 * Number(byId("speed").value);
  playing = now;
  show({ t: state.t + passed }, { inAddress: false });
  if (state.t >= end) play(false); else requestAnimationFrame(frame);
}

function play(on) {
  if (on && state.t >= end) state.t = 0;
  playing = on ? performance.now() : null;
  byId("play").textContent = on ? "Pause" : "Play";
  byId("play").setAttribute("aria-pressed", String(on));
  show({});
  if (on) requestAnimationFrame(frame);
}

/** To the next (1) or previous (-1) decision that the filters let through. */
function step(direction) {
  const found = bySettled.filter(passes);
  const beyond = direction > 0
    ? found.find((decision) => settledAt(decision) > state.t + 1e-4)
    : found.findLast((decision) => settledAt(decision) < state.t - 1e-4);
  if (beyond) show({ decision: beyond.id, t: settledAt(beyond) });
}

const KEYS = {
  " ": () => play(playing === null),
  ArrowLeft: () => show({ t: state.t - 10 }),
  ArrowRight: () => show({ t: state.t + 10 }),
  n: () => step(1),
  p: () => step(-1),
};

document.addEventListener("keydown", (event) => {
  const typing = event.target.matches("select, canvas, input:not([type=range])");
  const own = event.key === " " && event.target.matches("button, a, summary");
  const does = KEYS[event.key.length > 1 ? event.key : event.key.toLowerCase()];
  if (!does || typing || own || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  does();
});
byId("play").addEventListener("click", () => play(playing === null));
byId("before").addEventListener("click", () => step(-1));
byId("after").addEventListener("click", () => step(1));
byId("slider").max = end;
byId("slider").addEventListener("input", () => show({ t: Number(byId("slider").value) }));
window.addEventListener("hashchange", () => {
  readAddress();
  show({});
});
// Links that stand for a moment: a click counts even if the address stays as it is.
document.querySelector("main").addEventListener("click", (event) => {
  const link = event.target.closest('a[href^="#t="]');
  if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  history.pushState(null, "", link.getAttribute("href"));
  const leads = link.closest("#decisions"); // before the table is drawn anew
  readAddress();
  show({});
  if (!leads) return;
  byId("replay").scrollIntoView();
  byId("chosen-heading").focus({ preventScroll: true });
});

readAddress();
show({}, { inAddress: false });
