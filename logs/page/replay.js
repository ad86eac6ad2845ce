// The building at one moment: where the robot is, what it hears, what it believes.
// trail: [time, x, y, heading in degrees]; pings: [time, range in cm of each transducer, 0: none];
// beliefs: [time, P of each corridor]; goals: [time, intersection or -1];
// places, of a robot that was lost: [time, [intersection that may be ahead, P] ...].

const map = byId("map");
const unit = map ? Number(map.dataset.size) / 45 : 1; // metres that read well on the map

function poseAt(t) {
  const rows = run.trail;
  if (!rows.length) return null;
  const i = lastBefore(rows, t);
  const [a, b] = [rows[Math.max(i, 0)], rows[Math.min(Math.max(i + 1, 0), rows.length - 1)]];
  const share = b[0] > a[0] ? clamp((t - a[0]) / (b[0] - a[0]), 0, 1) : 1;
  const turn = ((b[3] - a[3] + 540) % 360 + 360) % 360 - 180;
  const between = (k) => a[k] + share * (b[k] - a[k]);
  return { x: between(1), y: between(2), heading: a[3] + share * turn };
}

function sureness(p) {
  if (p >= 0.99) return "sure";
  if (p <= 0.01) return "ruled-out";
  return p > 0.6 ? "likely" : p < 0.4 ? "unlikely" : "open";
}

const WORDS = { "sure": "known to be there", "likely": "likely", "open": "open",
  "unlikely": "unlikely", "ruled-out": "known not to be there" };

function beliefAt(t) {
  return run.beliefs[lastBefore(run.beliefs, t)]?.slice(1) ?? null;
}

function placeWords(intersection) {
  const columns = run.building.columns.length;
  return `${intersection % columns},${Math.floor(intersection / columns)}`;
}

/** Where a robot that was lost may be heading: one row, or none. */
function aheadAt(t) {
  const rows = run.places[lastBefore(run.places, t)]?.slice(1);
  const words = rows?.map(([place, p]) => `${placeWords(place)} (${p.toFixed(3)})`).join(", ");
  return words ? [["junction ahead", words]] : [];
}

function placeAt(intersection) {
  const { columns, rows } = run.building;
  return [columns[intersection % columns.length], rows[Math.floor(intersection / columns.length)]];
}

const put = (element, x, y, more = "") =>
  element.setAttribute("transform", `translate(${x.toFixed(3)} ${(-y).toFixed(3)}) ${more}`);

/** Where an echo came from: the transducers stand evenly around, the first ahead. */
function echoAt(pose, transducer, number, range) {
  const angle = (pose.heading + 360 * transducer / number) * Math.PI / 180;
  return [pose.x + range * Math.cos(angle), pose.y + range * Math.sin(angle)];
}

function drawEchoes(ping) {
  let rays = "", hits = "";
  const pose = ping && state.t - ping[0] < 10 ? poseAt(ping[0]) : null;
  for (let k = 1; pose && k < ping.length; k++) {
    if (!ping[k]) continue;
    const [x, y] = echoAt(pose, k - 1, ping.length - 1, ping[k] / 100);
    const point = `${x.toFixed(2)} ${(-y).toFixed(2)}`;
    rays += `M${pose.x.toFixed(2)} ${(-pose.y).toFixed(2)}L${point}`;
    hits += `M${point}h0`;
  }
  byId("rays").setAttribute("d", rays);
  byId("hits").setAttribute("d", hits);
}

function drawBelief(chances) {
  run.building.exists.forEach((_, corridor) => {
    const p = chances ? chances[corridor] : 0.5;
    byId(`corridor-${corridor}`).setAttribute("class", `belief ${sureness(p)}`);
    byId(`chance-${corridor}`).textContent = chances ? p.toFixed(2) : "?";
  });
}

function meetingAt(t) {
  return run.meetings.find((of) => of.from <= t && t <= (of.over ?? end)) ?? null;
}

function drawPerson(meeting) {
  const seen = meeting?.seen[lastBefore(meeting.seen, state.t)];
  const marker = byId("person");
  marker.toggleAttribute("hidden", !seen);
  if (!seen) return;
  const pose = poseAt(seen[0]);
  put(marker, ...echoAt(pose, seen[2], run.pings[0].length - 1, seen[1] + 0.25),
    `scale(${unit * 0.8})`);
}

function idleAt(t) {
  return run.decisions.find((d) => d.idle > 0 && idleSpan(d)[0] <= t && t < idleSpan(d)[1]) ?? null;
}

/** When the robot stood for want of a decision: until it came, or from its deadline on. */
function idleSpan(decision) {
  const { idle, decided, until } = decision;
  return decided === null ? [until, until + idle] : [decided - idle, decided];
}

function corridorTable(chances) {
  const cell = (tag, words) => make(tag, tag === "th" ? { scope: "row" } : {}, words);
  const rows = run.building.ends.map(([a, b], corridor) => make("tr", {},
    cell("th", `${placeWords(a)} to ${placeWords(b)}`),
    cell("td", chances ? chances[corridor].toFixed(4) : "-"),
    cell("td", WORDS[sureness(chances ? chances[corridor] : 0.5)]),
    cell("td", run.building.exists[corridor] ? "there is one" : "there is none")));
  const head = ["corridor", "P", "believed", "truth"].map((w) => make("th", { scope: "col" }, w));
  return make("table", {}, make("thead", {}, make("tr", {}, ...head)),
    make("tbody", {}, ...rows));
}

let tableOf = null; // the belief that the table of corridors shows; it changes once a corridor

function describe(items) {
  byId("state").replaceChildren(...items.flatMap(([name, words]) =>
    [make("dt", {}, name), make("dd", {}, words)]));
}

function drawReplay() {
  byId("clock").textContent = `${seconds(state.t)} of ${seconds(end)}`;
  byId("slider").value = state.t;
  byId("slider").setAttribute("aria-valuetext", seconds(state.t));
  if (!map) return;
  const pose = poseAt(state.t), idle = idleAt(state.t), meeting = meetingAt(state.t);
  const chances = beliefAt(state.t);
  const goal = run.goals[lastBefore(run.goals, state.t)]?.[1] ?? -1;
  byId("robot").toggleAttribute("hidden", !pose);
  if (pose) put(byId("robot"), pose.x, pose.y, `rotate(${-pose.heading}) scale(${unit})`);
  byId("robot").classList.toggle("idle", idle !== null);
  byId("goal").toggleAttribute("hidden", goal < 0);
  if (goal >= 0) put(byId("goal"), ...placeAt(goal), `scale(${unit})`);
  const past = run.trail.slice(0, lastBefore(run.trail, state.t) + 1);
  const points = [...past.map((row) => [row[1], row[2]]), ...(pose ? [[pose.x, pose.y]] : [])];
  byId("past").setAttribute("d", points.map(([x, y], i) => `${i ? "L" : "M"}${x} ${-y}`).join(""));
  drawEchoes(run.pings[lastBefore(run.pings, state.t)]);
  drawPerson(meeting);
  if (tableOf !== chances?.join()) {
    tableOf = chances?.join();
    drawBelief(chances);
    byId("corridors").replaceChildren(corridorTable(chances));
  }
  describe([
    ["robot", pose ? `${pose.x.toFixed(1)} m east, ${pose.y.toFixed(1)} m north` : "not known yet"],
    ...aheadAt(state.t),
    ["errand", goal >= 0 ? `to ${placeWords(goal)}` : "none"],
    ["idle", idle ? `waits for decision ${idle.id} (${idle.kind})` : "no"],
    ["person", meeting ? `encounter ${meeting.encounter}` : "nobody"],
  ]);
}

/** The last decision whose outcome was seen, in words, for those who look and those who listen. */
function drawWords() {
  const last = byOutcome[lastBefore(byOutcome, state.t, (d) => d.at)];
  const words = last ? `Decision ${last.id}, ${last.kind}: ${last.words} (${last.outcome})` : "";
  if (byId("said").textContent !== words) byId("said").textContent = words || "No decision yet.";
}

function drawCursors() {
  for (const line of document.querySelectorAll("svg[data-end] .now")) {
    const x = 56 + 652 * clamp(state.t / Number(line.ownerSVGElement.dataset.end), 0, 1);
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
  }
}

for (const label of document.querySelectorAll(".chance")) {
  label.style.fontSize = `${unit * 1.3}px`;
  const line = byId(label.id.replace("chance", "corridor"));
  const upright = line.getAttribute("x1") === line.getAttribute("x2");
  label.setAttribute(upright ? "dx" : "dy", upright ? unit * 2.6 : unit * 2.1);
}
draws.push(drawReplay, drawWords, drawCursors);
