// What the page shows, kept in one place and mirrored in the address: #t=1500&decision=17&late=1
// &kinds=path,sensing&from=0&to=900. Everything that draws registers with `draws`.

const run = JSON.parse(document.getElementById("run").textContent);
const end = Math.max(run.duration, 1e-3);
const state = { t: 0, decision: null, late: "", kinds: allKinds(), from: 0, to: end };
const draws = [];

const byId = (id) => document.getElementById(id);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const seconds = (value, digits = 1) => value === null ? "-" : value.toLocaleString("en-US",
  { minimumFractionDigits: digits, maximumFractionDigits: digits }) + " s";

function allKinds() {
  return [...document.querySelectorAll("input[name=kind]")].map((box) => box.value);
}

/** Index of the last row whose time, its first entry, is not after t; -1 before the first. */
function lastBefore(rows, t, time = (row) => row[0]) {
  let low = 0, high = rows.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time(rows[middle]) <= t) low = middle + 1; else high = middle;
  }
  return low - 1;
}

const decisionOf = (id) => run.decisions.find((decision) => decision.id === id) ?? null;
const settledAt = (decision) => decision.decided ?? decision.until;
const bySettled = [...run.decisions].sort((a, b) => settledAt(a) - settledAt(b));
const byOutcome = [...run.decisions].sort((a, b) => a.at - b.at);

function passes(decision) {
  const late = state.late === "" || (state.late === "1") === decision.late;
  return late && state.kinds.includes(decision.kind);
}

function readAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const number = (name, otherwise, low, high) => {
    const value = Number.parseFloat(asked.get(name));
    return Number.isFinite(value) ? clamp(value, low, high) : otherwise;
  };
  state.decision = asked.has("decision") ? number("decision", null, 0, Infinity) : null;
  const chosen = decisionOf(state.decision);
  state.t = number("t", chosen ? settledAt(chosen) : 0, 0, end);
  state.late = ["0", "1"].includes(asked.get("late")) ? asked.get("late") : "";
  state.kinds = asked.has("kinds")
    ? allKinds().filter((kind) => asked.get("kinds").split(",").includes(kind)) : allKinds();
  state.from = number("from", 0, 0, end);
  state.to = number("to", end, 0, end);
  if (state.to <= state.from) [state.from, state.to] = [0, end];
}

function address(changes = {}) {
  const shown = { ...state, ...changes };
  const parts = [`t=${+shown.t.toFixed(4)}`];
  if (shown.decision !== null) parts.push(`decision=${shown.decision}`);
  if (shown.late !== "") parts.push(`late=${shown.late}`);
  if (shown.kinds.length < allKinds().length) parts.push(`kinds=${shown.kinds.join(",")}`);
  if (shown.from > 0 || shown.to < end) {
    parts.push(`from=${+shown.from.toFixed(3)}`, `to=${+shown.to.toFixed(3)}`);
  }
  return "#" + parts.join("&");
}

/** Change what is shown and draw it. The address follows, without a step in the history. */
function show(changes, { inAddress = true } = {}) {
  Object.assign(state, changes);
  state.t = clamp(state.t, 0, end);
  if (inAddress) history.replaceState(null, "", address());
  for (const draw of draws) draw();
}

/** An element with text and attributes; text is never taken for HTML. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const linkTo = (changes, words) => make("a", { href: address(changes) }, words);
