const run = JSON.parse(byId("run").textContent);
const percent = 100;

/** What may be plotted: name, factor and unit of the columns of a run that are of interest. */
const columnNames = {
  differential_stress: ["differential stress", 1e-6, "MPa"], axial_stress: ["axial stress", 1e-6, "MPa"],
  lateral_stress: ["lateral stress", 1e-6, "MPa"], axial_strain: ["axial strain", percent, "%"],
  lateral_strain: ["lateral strain", percent, "%"], volumetric_strain: ["volumetric strain", percent, "%"],
  strength_factor: ["strengths divided by", 1, ""], cracks_tension: ["cracks in tension", 1, ""], cracks_shear: ["cracks in shear", 1, ""],
  open: ["open joints", 1, ""], sliding: ["sliding joints", 1, ""], locked: ["locked joints", 1, ""],
  net_broken: ["net that has failed", percent, "%"], open_close_iterations: ["linear solves", 1, ""], balance_error: ["balance error", 1, ""],
  unbalanced_ratio: ["unbalanced ratio", 1, ""], jumps: ["jumps", 1, ""], kinetic_ratio: ["kinetic over strain energy", 1, ""],
  energy_error: ["energy error", percent, "%"], load: ["stage + load factor", 1, ""], step: ["load step", 1, ""],
};
const rows = run.rows;
const nRows = rows.step.length;
rows.load = rows.stage.map((stage, i) => stage + rows.load_factor[i]);
const stressed = new Set(["differential_stress", "axial_stress", "axial_strain", "lateral_strain", "volumetric_strain"]);

const labelOf = (key) => { const [name, , unit] = columnNames[key]; return unit ? `${name} (${unit})` : name; };
const valuesOf = (key, from = rows) => {
  const factor = columnNames[key][1] * (run.sense < 0 && stressed.has(key) ? -1 : 1);
  return from[key].map((each) => (each === null ? null : factor * each));
};
/** Rows over which a plot across strain goes: from the last one before the platen moves, whose strains are zero there. */
const firstPlatenRow = run.platen_stage === null ? 0 : Math.max(0, rows.stage.findIndex((stage) => stage >= run.platen_stage) - 1);
function pointsOf(xKey, yKey) {
  const [x, y] = [valuesOf(xKey), valuesOf(yKey)];
  const overStrain = xKey === "axial_strain" && run.platen_stage !== null;
  return x.map((each, i) => {
    if (overStrain && i < firstPlatenRow) return { x: NaN, y: NaN };
    const isStart = overStrain && i === firstPlatenRow;
    return { x: isStart ? 0 : each, y: isStart && yKey.endsWith("_strain") ? 0 : y[i] };
  });
}
const isThere = (point) => Number.isFinite(point.x) && Number.isFinite(point.y);

function fillChoices(select, keys, names, chosen) {
  for (const key of keys) select.add(new Option(names(key), key, false, key === chosen));
}
const varies = (key) => rows[key]?.some((each) => each !== rows[key][0]);

const plotFont = { family: 'system-ui, "DejaVu Sans", sans-serif', size: 12 };
Chart.defaults.font = plotFont;
Chart.defaults.color = "#3b464d";
Chart.defaults.animation = false;
/** The text at a tick; what rounding has left of a zero is one. */
function tickText(value, index, ticks) {
  const largest = Math.max(...ticks.map((tick) => Math.abs(tick.value)));
  return Chart.Ticks.formatters.numeric.call(this, Math.abs(value) < 1e-9 * largest ? 0 : value, index, ticks);
}
function plot(canvas, datasets, xName, yName, more = {}) {
  const axis = (text) => ({ type: "linear", title: { display: true, text }, ticks: { callback: tickText }, grid: { color: "#e6eaec" }, ...more.axis });
  return new Chart(canvas, {
    type: "scatter",
    data: { datasets },
    options: {
      maintainAspectRatio: false, responsive: true, parsing: false, onClick: more.onClick,
      interaction: { mode: "nearest", intersect: false },
      scales: { x: axis(xName), y: { ...axis(yName), beginAtZero: true } },
      plugins: {
        legend: { display: Boolean(more.legend), labels: { usePointStyle: true, filter: (item) => item.text !== "" } },
        tooltip: { callbacks: { label: (item) => more.tip?.(item) ?? `${digits(item.parsed.x)}, ${digits(item.parsed.y)}` } },
      },
    },
  });
}
const lineStyle = (colour, more = {}) => ({ showLine: true, pointStyle: "line", borderColor: colour, backgroundColor: colour, borderWidth: 1.6, pointRadius: 0, ...more });

/* The states and the body. */
const states = run.states;
const cache = new Map();
async function stateArrays(index) {
  if (!cache.has(index)) {
    if (cache.size > 12) cache.delete(cache.keys().next().value);
    cache.set(index, unpackArrays(`state-${index}`));
  }
  return cache.get(index);
}
let view = null;
let current = states.length - 1;
const rowOfState = states.map((state) => rows.step.indexOf(state.step));

function stateInWords(index) {
  const state = states[index];
  const row = rowOfState[index];
  const parts = [`load step ${state.step}`];
  const stage = run.names.stages[rows.stage[row]];
  if (stage) parts.push(`stage ${stage}`);
  if (row >= 0 && run.platen_stage !== null && row >= firstPlatenRow) {
    parts.push(`axial strain ${digits(valuesOf("axial_strain")[row])} %`, `differential stress ${digits(valuesOf("differential_stress")[row])} MPa`);
  } else if (row >= 0) parts.push(`load factor ${digits(rows.load_factor[row])}`);
  if (index === run.peak_state) parts.push("nearest to the peak");
  if (row >= 0 && !rows.balanced[row]) parts.push("not balanced");
  return `State ${index + 1} of ${states.length}: ${parts.join(", ")}`;
}

let asked = 0;
async function showState(index) {
  if (states.length === 0) return;
  current = Math.min(states.length - 1, Math.max(0, index));
  byId("slider").value = current;
  byId("slider").setAttribute("aria-valuetext", stateInWords(current));
  byId("where").textContent = stateInWords(current);
  markCurve();
  const turn = ++asked;
  const arrays = await stateArrays(current);
  if (turn !== asked) return; // another one has been asked for since
  view.setState(arrays);
  redraw();
}

const element = (name, text) => { const made = document.createElement(name); made.textContent = text; return made; };
function tell(place, found) {
  if (!found) return;
  const [title, facts] = view.describe(found);
  const list = document.createElement("dl");
  for (const [name, text] of facts) list.append(element("dt", name), element("dd", text));
  byId(place).replaceChildren(element("strong", title), list);
}

let waiting = false;
function redraw() {
  if (waiting || !view?.state) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    view.draw();
    showLegend();
    if (view.pinned) tell("pinned", view.pinned);
    byId("body").dataset.drawn = `${current} ${view.options.magnification}`;
  });
}

function showLegend() {
  const parts = [];
  const put = (name, ...children) => { const made = element("span", ""); made.append(...children, name); parts.push(made); };
  const sample = (colour) => { const made = element("span", ""); made.className = "line"; made.style.borderTopColor = colour; return made; };
  const values = view.blockValues();
  if (values) {
    const [name, unit] = blockFields[view.options.field];
    const [factor, unitName] = unitFor(Math.max(Math.abs(values.low), Math.abs(values.high)), unit);
    const bar = element("span", "");
    bar.className = "bar";
    bar.style.background = `linear-gradient(to right, ${values.colours.filter((_, i) => i % 7 === 0).join(",")})`;
    put(`${digits(values.high / factor, 3)} ${unitName}`, `${name} ${digits(values.low / factor, 3)} `, bar, " ");
    const least = values.numbers.reduce((a, b) => Math.min(a, b));
    const largest = values.numbers.reduce((a, b) => Math.max(a, b));
    if (least < values.low || largest > values.high) // single blocks may lie far beyond what the colours span
      put(`of all blocks: ${digits(least / factor, 3)} to ${digits(largest / factor, 3)} ${unitName}`);
  } else {
    run.names.materials.forEach((name, i) => put(name, sample(categories[i % categories.length])));
  }
  if (view.options.joints === "state") {
    put("failed in tension", sample(ink.tension));
    put("failed in shear", sample(ink.shear));
    put("sliding", sample(ink.sliding));
    put("open", sample("#c9ced1"));
  } else {
    const [name, unit] = jointFields[view.options.joints];
    put(`${name} > 0`, sample(ink.shear));
    put(`< 0, widest ${quantity(view.jointRange, unit)}`, sample(ink.tension));
  }
  if (view.options.slips && view.largestSlip) put(`slip, longest ${quantity(view.largestSlip, "m")}`, sample(ink.shear));
  if (view.options.forces && view.largestForce) put(`contact force, widest ${digits(view.largestForce / 1e3)} kN/m`, sample(ink.compression));
  byId("legend").replaceChildren(...parts);
}

function pin(found) {
  view.pinned = found;
  byId("unpin").hidden = !found;
  if (!found) byId("pinned").replaceChildren();
  redraw();
}

/** Pointers on the body: one moves the view or chooses, two zoom. */
function listenToPointers(canvas) {
  const down = new Map();
  let moved = 0;
  const placeOf = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  canvas.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, placeOf(event));
    moved = 0;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const place = placeOf(event);
    if (!down.has(event.pointerId)) {
      if (view?.state) tell("hovered", view.at(...place));
      return;
    }
    const before = down.get(event.pointerId);
    if (down.size === 2) {
      const other = [...down].find(([id]) => id !== event.pointerId)[1];
      const distance = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]) || 1;
      view.zoomAt(distance(place) / distance(before), (place[0] + other[0]) / 2, (place[1] + other[1]) / 2);
    } else view.pan(place[0] - before[0], place[1] - before[1]);
    moved += Math.hypot(place[0] - before[0], place[1] - before[1]);
    down.set(event.pointerId, place);
    redraw();
  });
  const up = (event) => {
    if (down.delete(event.pointerId) && moved < 4 && event.type === "pointerup" && view?.state) {
      const found = view.at(...placeOf(event));
      if (found) { tell("hovered", found); pin(found); }
    }
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls until the body is chosen
    event.preventDefault();
    view.zoomAt(Math.exp(-0.0015 * event.deltaY), ...placeOf(event));
    redraw();
  }, { passive: false });
}

function zoomBy(factor) {
  const { width, height } = view.size;
  view.zoomAt(factor, width / 2, height / 2);
  redraw();
}
function listenToKeys(canvas) {
  const step = 40;
  const actions = {
    ArrowLeft: () => view.pan(step, 0), ArrowRight: () => view.pan(-step, 0), ArrowUp: () => view.pan(0, step), ArrowDown: () => view.pan(0, -step),
    "+": () => zoomBy(1.25), "=": () => zoomBy(1.25), "-": () => zoomBy(0.8), 0: () => view.fit(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!actions[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    actions[event.key]();
    redraw();
  });
}

async function startBody() {
  if (states.length === 0) {
    byId("body").closest(".body-side").replaceChildren(element("p", "No state is kept of this run, so the body is not shown (output.fields: true keeps states)."));
    for (const part of document.querySelectorAll(".states, .told, #states > .controls")) part.hidden = true;
    for (const part of document.querySelectorAll("#states > .controls")) part.style.display = "none";
    return;
  }
  if (typeof DecompressionStream === "undefined") {
    byId("where").textContent = "This browser cannot unpack the states (it has no DecompressionStream); a newer one can.";
    return;
  }
  view = new BodyView(byId("body"), await unpackArrays("shape"), run);
  const canvas = byId("body");
  listenToPointers(canvas);
  listenToKeys(canvas);
  new ResizeObserver(redraw).observe(canvas);
  byId("zoom-in").addEventListener("click", () => zoomBy(1.4));
  byId("zoom-out").addEventListener("click", () => zoomBy(1 / 1.4));
  byId("zoom-all").addEventListener("click", () => { view.fit(); redraw(); });
  fillChoices(byId("field"), [...Object.keys(blockFields), "material"], (key) => blockFields[key]?.[0] ?? "material", "sigma_1");
  fillChoices(byId("joint-field"), ["state", ...Object.keys(jointFields)], (key) => jointFields[key]?.[0] ?? "state", "state");
  const choose = (id, option, value) => byId(id).addEventListener("input", (event) => {
    view.options[option] = value(event.target);
    view.values = null;
    redraw();
  });
  choose("field", "field", (target) => target.value);
  choose("joint-field", "joints", (target) => target.value);
  for (const each of ["crosses", "slips", "forces", "hold"]) choose(each, each, (target) => target.checked);
  choose("magnification", "magnification", (target) => {
    const factor = Number((percent ** Number(target.value)).toPrecision(2)); // 1 to 100, even steps in its logarithm
    byId("magnification-text").textContent = factor;
    return factor;
  });
  byId("find").max = view.nBlocks - 1;
  byId("find").addEventListener("change", (event) => {
    const block = Number(event.target.value);
    if (event.target.value !== "" && Number.isInteger(block) && block >= 0 && block < view.nBlocks) pin({ kind: "block", index: block });
  });
  byId("unpin").addEventListener("click", () => pin(null));
  const slider = byId("slider");
  slider.max = states.length - 1;
  slider.addEventListener("input", () => showState(Number(slider.value)));
  byId("previous").addEventListener("click", () => showState(current - 1));
  byId("next").addEventListener("click", () => showState(current + 1));
  byId("to-peak").hidden = run.peak_state === null;
  byId("to-peak").addEventListener("click", () => showState(run.peak_state));
  await showState(run.peak_state ?? states.length - 1);
}

/* The curve. */
let curve = null;
let curvePoints = [];
const curveStates = () => states.map((_, i) => ({ ...(curvePoints[rowOfState[i]] ?? { x: NaN, y: NaN }), state: i }));
function markCurve() {
  if (!curve || states.length === 0) return;
  const here = curvePoints[rowOfState[current]];
  curve.data.datasets[0].data = here && isThere(here) ? [here] : [];
  curve.update("none");
}
function drawCurve() {
  const [xKey, yKey] = [byId("curve-x").value, byId("curve-y").value];
  curvePoints = pointsOf(xKey, yKey);
  const fine = xKey === "axial_strain" && run.fine[yKey] ? valuesOf("axial_strain", run.fine).map((x, i) => ({ x, y: valuesOf(yKey, run.fine)[i] })) : [];
  const unbalanced = curvePoints.filter((point, i) => !rows.balanced[i] && isThere(point));
  const datasets = [
    { label: "shown", data: [], pointRadius: 8, borderWidth: 2.5, borderColor: "#e08a00", backgroundColor: "rgba(224,138,0,.25)" },
    { label: "stored states", data: curveStates().filter(isThere), pointRadius: states.length > 40 ? 2.5 : 4, backgroundColor: "#1d6a78", borderColor: "#fff" },
    { label: unbalanced.length > 0 ? "not balanced" : "", data: unbalanced, pointRadius: 4, backgroundColor: "#fff", borderColor: "#a3201d" },
    lineStyle("#1d6a78", { label: "load steps", data: curvePoints.filter(isThere) }),
    lineStyle("rgba(29,106,120,.3)", { label: fine.length > 0 ? "all equilibria" : "", data: fine, borderWidth: 1 }),
  ];
  curve?.destroy();
  const goThere = (event) => {
    let best = null;
    for (const point of curveStates().filter(isThere)) {
      const distance = Math.hypot(curve.scales.x.getPixelForValue(point.x) - event.x, curve.scales.y.getPixelForValue(point.y) - event.y);
      if (!best || distance < best.distance) best = { distance, state: point.state };
    }
    if (best) showState(best.state);
  };
  curve = plot(byId("curve"), datasets, labelOf(xKey), labelOf(yKey), { onClick: goThere, legend: true });
  markCurve();
}

function startCurve() {
  const hasPlaten = run.platen_stage !== null;
  const across = [...(hasPlaten ? ["axial_strain"] : []), "load", "step"];
  const first = hasPlaten ? "differential_stress" : rows.strength_factor ? "strength_factor"
    : ["volumetric_strain", "sliding", "open", "locked"].find(varies) ?? "locked";
  const up = Object.keys(columnNames).filter((key) => rows[key] && !across.includes(key) && (key === first || varies(key)));
  fillChoices(byId("curve-y"), up, labelOf, first);
  fillChoices(byId("curve-x"), across, labelOf, rows.strength_factor ? "step" : across[0]);
  for (const id of ["curve-x", "curve-y"]) byId(id).addEventListener("change", drawCurve);
  drawCurve();
}

/* Histories, or where the scene asks for none, further columns of the run. */
let historyPlot = null;
function drawHistory() {
  const [xKey, yKey] = [byId("history-x").value, byId("history-y").value];
  const own = run.histories.columns[yKey];
  let points = null;
  if (own) {
    const rowOf = new Map(rows.step.map((step, i) => [step, i]));
    const x = pointsOf(xKey, "step");
    points = own.map((y, i) => ({ x: x[rowOf.get(run.histories.step[i])]?.x ?? NaN, y }));
  } else points = pointsOf(xKey, yKey);
  historyPlot?.destroy();
  historyPlot = plot(byId("history"), [lineStyle("#1d6a78", { data: points.filter(isThere) })], labelOf(xKey), own ? yKey : labelOf(yKey));
}
function startHistories() {
  const own = Object.keys(run.histories.columns);
  const across = [...(run.platen_stage !== null ? ["axial_strain"] : []), "load", "step"];
  const others = Object.keys(columnNames).filter((key) => rows[key] && !across.includes(key) && varies(key));
  const first = own[0] ?? (others.includes("volumetric_strain") ? "volumetric_strain" : others[0] ?? "sliding");
  fillChoices(byId("history-y"), [...own, ...(others.length > 0 ? others : ["sliding"])], (key) => (columnNames[key] ? labelOf(key) : key), first);
  fillChoices(byId("history-x"), across, labelOf, across[0]);
  for (const id of ["history-x", "history-y"]) byId(id).addEventListener("change", drawHistory);
  drawHistory();
}

function startCracks() {
  const section = byId("cracks");
  if (!varies("cracks_tension") && !varies("cracks_shear")) {
    section.replaceChildren(element("h2", "Cracks"), element("p", "No potential crack has failed."));
    return;
  }
  const xKey = run.platen_stage !== null ? "axial_strain" : "load";
  const series = (key, colour) => lineStyle(colour, { label: columnNames[key][0], data: pointsOf(xKey, key).filter(isThere), stepped: false, borderWidth: 2 });
  plot(byId("crack-plot"), [series("cracks_tension", ink.tension), series("cracks_shear", ink.shear)], labelOf(xKey), "number", { legend: true });
}

/* The scene: a key that has a value is a button that puts it into the line. */
const quoted = (text) => (/^[\w.%+-]*$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/** Adds the keys with values of a mapping in braces that begins at `at`: {from, name, path, value}. Returns where it ends. */
function keysInBraces(line, at, path, found) {
  const isList = line[at] === "[";
  for (let item = 0; at < line.length && !/[}\]]/.test(line[at]); ++item) {
    at += 1; // the brace, or the comma before
    while (line[at] === " ") ++at;
    const key = isList ? null : /^[\w-]+(?=:)/.exec(line.slice(at))?.[0];
    const inside = [...path, isList ? String(item) : key];
    const from = at;
    if (key) at += key.length + 1;
    while (line[at] === " ") ++at;
    if (line[at] === "{" || line[at] === "[") {
      const isPoint = line[at] === "[" && !/^\[[^\]]*[{[]/.test(line.slice(at));
      const start = at;
      at = keysInBraces(line, at, inside, isPoint ? [] : found);
      if (isPoint && key) found.push({ from, name: key, path: inside, value: line.slice(start, at) });
    } else {
      const value = /^("[^"]*"|'[^']*'|[^,}\]]*)/.exec(line.slice(at))[0];
      at += value.length;
      if (key && value.trim() !== "") found.push({ from, name: key, path: inside, value: value.trim() });
    }
    while (line[at] === " ") ++at;
    if (line[at] !== "," && !/[}\]]/.test(line[at] ?? "")) return line.length; // goes on in the next line
  }
  return at + 1;
}

/** The keys with values in each line of a scene as it was run. */
function keysOfScene(lines) {
  const path = []; // of the line: [indent, key]
  const counts = new Map(); // items so far of each list
  return lines.map((line) => {
    const match = /^(\s*)(- )?(?:([\w][\w-]*):(?: +(.*))?|(.*))$/.exec(line);
    const found = [];
    if (!match || line.trimStart().startsWith("#") || line.trim() === "") return found;
    const [, blank, dash, name, value] = match;
    let indent = blank.length;
    while (path.length > 0 && path.at(-1)[0] >= indent + (dash && !/^\d+$/.test(path.at(-1)[1]) ? 1 : 0)) path.pop();
    if (dash) {
      const list = `${path.map((each) => each[1]).join(".")} ${indent}`;
      counts.set(list, (counts.get(list) ?? -1) + 1);
      path.push([indent, String(counts.get(list))]);
      indent += 2;
    }
    const above = path.map((each) => each[1]);
    if (name === undefined) {
      if (line[indent] === "{") keysInBraces(line, indent, above, found);
      return found;
    }
    path.push([indent, name]);
    const here = [...above, name];
    const start = line.length - (value ?? "").length;
    if (!value || name === "kluft" || /^[|>&*]/.test(value)) return found;
    if (value[0] === "{") keysInBraces(line, start, here, found);
    else found.push({ from: indent, name, path: here, value: value.replace(/\s+#.*$/, "") });
    return found;
  });
}

function startScene() {
  const pre = byId("scene");
  const lines = pre.textContent.split("\n");
  const keys = keysOfScene(lines);
  pre.replaceChildren();
  lines.forEach((line, i) => {
    let done = 0;
    for (const { from, name, path, value } of keys[i].sort((a, b) => a.from - b.from)) {
      const setting = `--set ${path.join(".")}=${quoted(value.replace(/^"(.*)"$/, "$1"))}`;
      const button = element("button", name);
      button.title = setting;
      button.addEventListener("click", () => {
        const box = byId("command");
        box.value += ` ${setting}`;
        box.focus();
        box.setSelectionRange(box.value.length, box.value.length);
        box.scrollLeft = box.scrollWidth;
      });
      pre.append(line.slice(done, from), button);
      done = from + name.length;
    }
    pre.append(`${line.slice(done)}\n`);
  });
}

startCurve();
startHistories();
startCracks();
startScene();
startBody().then(() => { document.documentElement.dataset.ready = "yes"; });
