// The table of decisions, the worst first, the filters, and the one decision that is chosen.
// chain: [topic, source, sequence, to which process, said, transport, queueing, computing], last
// first. age: [percepts, of the newest, of the oldest].

const PAGE = 15;
let shownRows = PAGE;
const badness = (decision) => decision.slack ?? -Infinity;
const worstFirst = [...run.decisions].sort((a, b) => badness(a) - badness(b) || a.id - b.id);

function decisionRow(decision) {
  const changes = { decision: decision.id, t: settledAt(decision) };
  const row = make("tr", { class: decision.late ? "late" : "good", "data-decision": decision.id },
    make("th", { scope: "row" }, linkTo(changes, `${decision.kind} ${decision.id}`)),
    make("td", {}, seconds(decision.until)),
    make("td", {}, decision.slack === null ? "never" : seconds(decision.slack)),
    make("td", {}, seconds(decision.idle)),
    make("td", {}, decision.cells.toLocaleString("en-US")),
    make("td", {}, decision.size.toLocaleString("en-US")),
    make("td", { class: "words" }, `${decision.outcome}. ${decision.words}`));
  if (decision.id === state.decision) row.setAttribute("aria-current", "true");
  return row;
}

let drawnFor = null; // what the table depends on; the time alone does not change it

function drawDecisions() {
  const depends = `${state.late} ${state.kinds} ${state.decision} ${shownRows}`;
  if (depends === drawnFor) return;
  drawnFor = depends;
  const found = worstFirst.filter(passes);
  byId("decisions").tBodies[0].replaceChildren(...found.slice(0, shownRows).map(decisionRow));
  byId("decisions").caption.textContent = `${Math.min(shownRows, found.length)} of ${found.length}` +
    ` decisions that the filters let through; \u2715 is late, \u25C6 in time`;
  byId("more").hidden = found.length <= shownRows;
  for (const box of document.querySelectorAll("input[name=kind]")) {
    box.checked = state.kinds.includes(box.value);
    const figure = byId(`slack-${box.value}`);
    if (figure) figure.hidden = !box.checked;
  }
  byId("late").value = state.late;
}

function chainLine([topic, source, sequence, process, said, transport, queueing, computing]) {
  const waited = queueing ? `, ${seconds(queueing, 3)} waiting there` : "";
  return make("li", {}, make("b", {}, topic), ` ${source} ${sequence}: said at `,
    linkTo({ t: said }, seconds(said, 3)), `, to the ${process}: ${seconds(transport, 4)} on the bus` +
    `${waited}, ${seconds(computing, 4)} of work`);
}

const ageWords = ([percepts, newest, oldest]) => percepts === 1 ? `one, ${seconds(newest, 3)} old` :
  `${percepts}, ${seconds(newest, 3)} to ${seconds(oldest, 3)} old`;

let chosenDrawn = "";

function drawChosen() {
  const decision = decisionOf(state.decision);
  byId("chosen-heading").textContent = decision ? `Decision ${decision.id}, ${decision.kind}` : "Decision";
  if (String(state.decision) === chosenDrawn || !decision) return;
  chosenDrawn = String(state.decision);
  const facts = [["asked", seconds(decision.asked)], ["due", seconds(decision.until)],
    ["decided", decision.decided === null ? "never" : seconds(decision.decided)],
    ["outcome", decision.outcome], ["idle", seconds(decision.idle)],
    ["cells", decision.cells.toLocaleString("en-US")], ["size", decision.size.toLocaleString("en-US")]];
  if (decision.age) facts.push(["percepts", ageWords(decision.age)]);
  const links = decision.chain.map(chainLine);
  byId("chosen").replaceChildren(
    make("p", {}, decision.words),
    make("dl", {}, ...facts.flatMap(([name, words]) => [make("dt", {}, name), make("dd", {}, words)])),
    make("h3", {}, "What led to it, last first"),
    links.length ? make("ol", {}, ...links) : make("p", {}, "No message decided it."),
    decision.whole ? "" : "The chain goes on, or its beginning is not in the log.");
}

byId("more").addEventListener("click", () => { shownRows *= 4; show({}); });
byId("filters").addEventListener("change", () => show({
  kinds: [...document.querySelectorAll("input[name=kind]:checked")].map((box) => box.value),
  late: byId("late").value,
}));
draws.push(drawDecisions, drawChosen);
