// Rows of work, decisions and waiting over time, on a canvas: thousands of bars stay quick.
// spans: process -> [from, to, handlers, cells, busy]; errands: [number, from, to, shortest].

const canvas = document.querySelector("#timeline canvas");
const pen = canvas.getContext("2d");
const ROW = 24, LABELS = 92, TOP = 6, AXIS = 26, EDGE = 8;
const kindsSeen = allKinds();
const rows = [
  ...Object.keys(run.spans).map((name) => ({ name, of: "work" })),
  ...kindsSeen.map((name) => ({ name, of: "decisions" })),
  { name: "idle", of: "idle" },
  ...(run.errands.length ? [{ name: "errands", of: "errands" }] : []),
];
const idlers = run.decisions.filter((decision) => decision.idle > 0);

const width = () => canvas.clientWidth || 900;
const height = TOP + rows.length * ROW + AXIS;
const toX = (t) => LABELS + (t - state.from) / (state.to - state.from) * (width() - LABELS - EDGE);
const toT = (x) => state.from + (x - LABELS) / (width() - LABELS - EDGE) * (state.to - state.from);
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function drawTimeline() {
  const scale = window.devicePixelRatio || 1;
  canvas.style.height = `${height}px`;
  canvas.width = Math.round(width() * scale);
  canvas.height = Math.round(height * scale);
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.font = "12px system-ui, sans-serif";
  pen.textBaseline = "middle";
  const ink = { good: colour("--good"), late: colour("--late"), idle: colour("--idle"),
    soft: colour("--soft"), line: colour("--line"), robot: colour("--robot"), ink: colour("--ink"),
    open: colour("--open") };
  drawAxis(ink);
  rows.forEach((row, number) => {
    const y = TOP + number * ROW;
    pen.fillStyle = ink.ink;
    pen.fillText(row.name, 4, y + ROW / 2, LABELS - 8);
    pen.save();
    pen.beginPath();
    pen.rect(LABELS, y, width() - LABELS, ROW);
    pen.clip();
    drawRow(row, y + 4, ROW - 8, ink);
    pen.restore();
  });
  pen.strokeStyle = ink.robot;
  pen.lineWidth = 2;
  const now = toX(state.t);
  if (now >= LABELS && now <= width()) stroke(now, 0, now, height - AXIS);
  byId("window").textContent = `${seconds(state.from)} to ${seconds(state.to)}`;
}

function stroke(ax, ay, bx, by) {
  pen.beginPath();
  pen.moveTo(ax, ay);
  pen.lineTo(bx, by);
  pen.stroke();
}

/** A step of 1, 2 or 5 times a power of ten that leaves room for the labels. */
function tick() {
  const least = (state.to - state.from) / Math.max(2, (width() - LABELS) / 90);
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= least);
}

function drawAxis(ink) {
  const step = tick(), digits = Math.max(0, -Math.floor(Math.log10(step)));
  pen.strokeStyle = ink.line;
  pen.lineWidth = 1;
  for (let number = 0; number <= rows.length; number++) {
    stroke(0, TOP + number * ROW - .5, width(), TOP + number * ROW - .5);
  }
  pen.textAlign = "center";
  for (let t = Math.ceil(state.from / step) * step; t <= state.to; t += step) {
    stroke(toX(t), TOP, toX(t), height - AXIS + 4);
    pen.fillStyle = ink.soft;
    pen.fillText(seconds(t, digits), clamp(toX(t), LABELS, width() - 34), height - AXIS / 2);
  }
  pen.textAlign = "left";
}

function drawRow(row, y, high, ink) {
  if (row.of === "work") {
    pen.fillStyle = ink.open;
    const of = run.spans[row.name];
    for (let i = Math.max(0, lastBefore(of, state.from)); i < of.length && of[i][0] <= state.to; i++) {
      bar(of[i][0], of[i][1], y, high);
    }
  } else if (row.of === "decisions") {
    for (const decision of run.decisions) {
      if (decision.kind === row.name && passes(decision)) drawDecision(decision, y, high, ink);
    }
  } else if (row.of === "idle") {
    pen.fillStyle = ink.idle;
    for (const decision of idlers) bar(...idleSpan(decision), y, high);
  } else {
    for (const [, from, to, shortest] of run.errands) {
      pen.fillStyle = ink.line;
      bar(from, to - (to - from) * .004, y, high);
      pen.fillStyle = ink.ink;
      bar(from, from + shortest, y + high / 2 - 1, 3);
    }
  }
}

function bar(from, to, y, high) {
  if (to >= state.from && from <= state.to) {
    pen.fillRect(toX(from), y, Math.max(1, toX(to) - toX(from)), high);
  }
}

function drawDecision(decision, y, high, ink) {
  const { asked, until, decided } = decision;
  if (Math.max(until, decided ?? until) < state.from || asked > state.to) return;
  const hue = decision.late ? ink.late : ink.good, middle = y + high / 2;
  pen.fillStyle = pen.strokeStyle = hue;
  pen.lineWidth = decision.id === state.decision ? 3 : 1;
  pen.strokeRect(toX(asked), y, Math.max(1, toX(until) - toX(asked)), high);
  pen.globalAlpha = .4;
  bar(asked, decided ?? until, y + 4, high - 8);
  pen.globalAlpha = 1;
  mark(toX(settledAt(decision)), middle, 5, decision);
}

/** Told apart by shape: a diamond in time, a cross late, a cross in a circle never. */
function mark(x, y, r, decision) {
  pen.lineWidth = 2.5;
  if (!decision.late) {
    pen.beginPath();
    for (const [dx, dy] of [[0, -r], [r, 0], [0, r], [-r, 0]]) pen.lineTo(x + dx, y + dy);
    pen.fill();
    return;
  }
  stroke(x - r, y - r, x + r, y + r);
  stroke(x - r, y + r, x + r, y - r);
  if (decision.decided === null) {
    pen.beginPath();
    pen.arc(x, y, r + 2, 0, 7);
    pen.stroke();
  }
}

/** What is under a point: the decision, if one is, and words about it. */
function under(x, y) {
  const row = rows[Math.floor((y - TOP) / ROW)], t = toT(x), near = toT(x + 6) - t;
  if (!row || x < LABELS) return null;
  if (row.of === "work") {
    const of = run.spans[row.name][lastBefore(run.spans[row.name], t + near / 3)];
    return of && t <= of[1] + near ? { words: `${row.name}: ${of[2]} handlers, ` +
      `${of[3].toLocaleString("en-US")} cells, busy ${seconds(of[4], 3)} from ${seconds(of[0])}` } : null;
  }
  if (row.of === "errands") {
    const of = run.errands.find(([, from, to]) => from <= t && t <= to);
    return of ? { words: `errand ${of[0]}: ${seconds(of[2] - of[1])} against ${seconds(of[3])} at least` } : null;
  }
  const candidates = row.of === "idle" ? idlers.filter((d) => inside(t, near, idleSpan(d)))
    : run.decisions.filter((d) => d.kind === row.name && passes(d) &&
      inside(t, near, [d.asked, Math.max(d.until, settledAt(d))]));
  const decision = candidates.sort((a, b) =>
    Math.abs(settledAt(a) - t) - Math.abs(settledAt(b) - t))[0];
  if (!decision) return null;
  const idle = row.of === "idle" ? `idle ${seconds(decision.idle)} for ` : "";
  return { decision, words: `${idle}decision ${decision.id}, ${decision.kind}: ${decision.words}; ${decision.outcome}` };
}

const inside = (t, near, [from, to]) => from - near <= t && t <= to + near;

function look(from, to) {
  const wide = clamp(to - from, Math.min(0.01, end), end);
  const begin = clamp(from, 0, end - wide);
  show({ from: begin, to: begin + wide });
}

function zoom(factor, about = (state.from + state.to) / 2) {
  look(about - (about - state.from) * factor, about + (state.to - about) * factor);
}

function pan(share) {
  const by = share * (state.to - state.from);
  look(state.from + by, state.to + by);
}

let drag = null;
canvas.addEventListener("pointerdown", (event) => {
  drag = { x: event.offsetX, from: state.from, to: state.to, moved: false };
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  const found = under(event.offsetX, event.offsetY), tip = byId("tip");
  tip.hidden = !found || drag?.moved;
  if (found) {
    tip.textContent = found.words;
    tip.style.left = `${clamp(event.offsetX + 12, 0, Math.max(0, width() - 330))}px`;
    tip.style.top = `${event.offsetY + 16}px`;
  }
  if (!drag || (!drag.moved && Math.abs(event.offsetX - drag.x) < 4)) return;
  drag.moved = true;
  const by = (drag.x - event.offsetX) / (width() - LABELS - EDGE) * (drag.to - drag.from);
  look(drag.from + by, drag.to + by);
});
canvas.addEventListener("pointerup", (event) => {
  if (drag && !drag.moved) {
    const found = under(event.offsetX, event.offsetY)?.decision;
    show(found ? { decision: found.id, t: settledAt(found) }
      : { t: toT(Math.max(LABELS, event.offsetX)) });
  }
  drag = null;
});
canvas.addEventListener("pointercancel", () => { drag = null; });
canvas.addEventListener("pointerleave", () => { byId("tip").hidden = true; });
canvas.addEventListener("wheel", (event) => {
  if (!event.ctrlKey && !event.metaKey) return; // a plain wheel scrolls the page
  event.preventDefault();
  zoom(event.deltaY > 0 ? 1.25 : 0.8, toT(event.offsetX));
}, { passive: false });
canvas.addEventListener("keydown", (event) => {
  const does = { "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2),
    "0": () => look(0, end), ArrowLeft: () => pan(-.2), ArrowRight: () => pan(.2) }[event.key];
  if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
  does();
  event.preventDefault();
  event.stopPropagation();
});
for (const [id, does] of [["closer", () => zoom(0.5)], ["wider", () => zoom(2)],
  ["earlier", () => pan(-.4)], ["later", () => pan(.4)], ["whole", () => look(0, end)]]) {
  byId(id).addEventListener("click", does);
}
new ResizeObserver(drawTimeline).observe(canvas.parentElement);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawTimeline);
draws.push(drawTimeline);
