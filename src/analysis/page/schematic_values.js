// What the schematic shows at one time, and what its wires and symbols do to the plots.
let picture = null;                // of the place that is shown
let schematicScale = null;         // null: as it fits
let shownRun = 0;                  // of a sweep
const signalByKey = new Map();
const keyOf = name => name.toLowerCase().replaceAll(":", ".").replaceAll(" ", "");
if (isSweep) (data.quantities ?? []).forEach((name, k) => signalByKey.set(keyOf(name), data.panels[k]));
else data.signals.forEach((signal, k) => signalByKey.set(keyOf(signal.name), [k]));
const pointValues = new Map(Object.entries(run.operating_point ?? {}).map(([name, value]) => [keyOf(name), value]));
const hasWaveforms = () => data.signals.some(signal => signal.edges.length > 1);
const hasSignal = key => signalByKey.has(key) || pointValues.has(key);
const signalOf = key => data.signals[signalByKey.get(key)?.[shownRun]];

// Where the pointer is in a plot, else cursor A, else the end of what is visible.
const schematicTime = () => pointedTime ?? cursors.A ?? visible.max;

// At the time, or the mean of the piece of time where no more is known; null where nothing is.
function valueOnSchematic(key, time) {
  if (!hasWaveforms()) return pointValues.get(key) ?? null;
  const signal = signalOf(key);
  if (!signal) return null;
  const value = valueAt(signal, time);
  if (value !== null || !(time >= signal.begin && time < signal.edges[0])) return value;
  return signal.mean[Math.min(placeIn(signal.bins, time), signal.mean.length - 1)];
}

// For which share of the time a lane conducts at a time. Lanes have twelve digits.
function shareAt(lane, time) {
  const later = time + 2e-12 * Math.abs(time);
  return lane.times.length && later >= lane.times[0] ? lane.shares[placeIn(lane.times, later)] : 0;
}

// Of the lanes of an element: forwards or through its channel, through the diode in it, backwards. A device that is a subcircuit has those within it.
function lanesOf({element, shape}) {
  const key = element.toLowerCase(), isCall = /(^|[.])x[^.]*$/.test(key) && Boolean(shape.valve || shape.channel), lanes = {forward: [], body: [], reverse: []};
  for (const lane of data.lanes) {
    const name = lane.name.toLowerCase();
    if (name !== key && !name.startsWith(key + " (") && !(isCall && name.startsWith(key + "."))) continue;
    const part = name.slice(key.length);
    (/reverse/.test(part) ? lanes.reverse : /body/.test(part) ? lanes.body : /limit|gate|latch/.test(part) ? [] : lanes.forward).push(lane);
  }
  return lanes;
}

const largestShare = (lanes, time) => lanes.reduce((most, lane) => Math.max(most, shareAt(lane, time)), 0);

function paintConduction(view, time) {
  view.lanes ??= lanesOf(view);
  const {forward, body, reverse} = view.lanes;
  if (!forward.length && !body.length && !reverse.length) return;
  const on = largestShare(forward, time), through = largestShare(body, time), back = largestShare(reverse, time);
  view.group.dataset.state = back > 0 && back >= Math.max(on, through) ? "breakdown" : on > 0 || through > 0 ? "conducting" : "blocking";
  const fill = (shape, share) => { if (shape) shape.style.setProperty("--share", share); };
  fill(view.valve, Math.max(on, back));
  fill(view.channel, on);
  fill(view.body, view.channel ? Math.max(through, back) : through);
  if (view.closed) {
    view.closed.style.display = on >= 0.5 ? "inline" : "none";
    view.open.style.display = on >= 0.5 ? "none" : "inline";
  }
  view.stateText = view.group.dataset.state + (on > 0 && on < 1 ? " for " + quantity(100 * on, "%", 3) + " of the time" : "");
}

// What is left of a number when rounding is taken off it.
const pointSize = [...pointValues.values()].reduce((most, value) => Math.max(most, Math.abs(value)), 0);
function withoutRounding(key, value) {
  const rounding = 1e-12, signal = signalOf(key);
  return value !== null && Math.abs(value) <= rounding * (signal ? extentOf(signal).size : pointSize) ? 0 : value;
}

function fillSchematic() {
  if (!picture) return;
  const time = schematicTime(), digits = 4, valueNow = key => withoutRounding(key, valueOnSchematic(key, time));
  for (const net of picture.nets) {
    const voltage = net.texts.length ? quantity(valueNow(net.key), "V", digits) : "";
    for (const text of net.texts) text.textContent = voltage;
  }
  for (const view of picture.parts) {
    const value = view.element && hasSignal(view.key) ? valueNow(view.key) : null;
    if (view.text) view.text.textContent = quantity(value, "A", digits);
    if (view.arrow) turnArrow(view.arrow, value);
    if (view.element) paintConduction(view, time);
    view.title.textContent = titleOf(view);
  }
  fillSchematicTime(time);
}

function titleOf(view) {
  const {part} = view, does = part.block ? "open its sheet" : signalByKey.has(view.key) ? traceVerb(view.key) + " i(" + view.element + ")" : "";
  return [[part.name, part.value].filter(Boolean).join(" "), view.stateText, does].filter(Boolean).join("\n");
}
const traceVerb = key => signalByKey.get(key).every(member => traces.has(member)) ? "hide" : "show";

function fillSchematicTime(time) {
  const origin = pointedTime !== null ? "at the pointer" : cursors.A !== null ? "at cursor A" : "at the end of the view";
  const parts = [];
  if (!hasWaveforms()) parts.push(pointValues.size ? "Values of the operating point." : "");
  else parts.push("t = " + quantity(time, "s", 9) + ", " + origin + ".");
  if (hasWaveforms() && time < detailFrom) parts.push("Only means of time intervals are kept here.");
  element("schematic-time").textContent = parts.join(" ");
  if (document.activeElement !== element("schematic-slider")) element("schematic-slider").value = 1000 * (time - visible.min) / (visible.max - visible.min || 1);
}

// Curves of the plots that are not of these signals become pale.
function emphasize(key) {
  const members = key === null ? [] : signalByKey.get(key) ?? [];
  for (const plot of plots) {
    const place = plot.members.findIndex(member => members.includes(member));
    plot.setSeries(place < 0 ? null : place + 1, {focus: true});
  }
}

function toggleTraces(key) {
  const members = signalByKey.get(key);
  if (!members || !hasWaveforms()) return;
  showOnly(members.every(member => traces.has(member)) ? [...traces].filter(each => !members.includes(each)) : [...traces, ...members]);
  emphasize(key);
}

function makeActive(group, key, name, act) {
  group.setAttribute("tabindex", "0");
  group.setAttribute("role", "button");
  group.setAttribute("aria-label", name);
  group.addEventListener("click", act);
  group.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); act(); } });
  for (const type of ["pointerenter", "focus"]) group.addEventListener(type, () => { group.classList.add("touched"); emphasize(key); });
  for (const type of ["pointerleave", "blur"]) group.addEventListener(type, () => { group.classList.remove("touched"); emphasize(null); });
}

function listenToSchematic() {
  for (const net of picture.nets) {
    if (net.name === "0" || !signalByKey.has(net.key)) continue;
    svgPart(net.group, "title", {}, "v(" + net.node + ")");
    makeActive(net.group, net.key, "net " + net.node, () => toggleTraces(net.key));
  }
  for (const view of picture.parts) {
    view.title = svgPart(view.group, "title");
    const called = view.part.block ? drawing.places.findIndex(place => keyOf(place.path) === keyOf(view.element)) : -1;
    if (called >= 0) makeActive(view.group, null, view.part.name + ", open its sheet", () => showPlace(called));
    else if (signalByKey.has(view.key)) makeActive(view.group, view.key, view.part.name, () => toggleTraces(view.key));
  }
}

function showPlace(number) {
  picture = new SheetPicture(drawing.places[number]);
  listenToSchematic();
  element("schematic-sheet").replaceChildren(picture.svg);
  element("schematic-place").value = number;
  scaleSchematic();
  fillSchematic();
}

function scaleSchematic(factor = null) {
  const least = 0.55, box = element("schematic-sheet");
  const fitting = Math.max(least, Math.min(1, (box.clientWidth || 1160) / picture.width, Math.max(300, 0.5 * innerHeight) / picture.height));
  schematicScale = factor === null ? schematicScale : factor * (schematicScale ?? fitting);
  picture.svg.setAttribute("width", picture.width * (schematicScale ?? fitting));
  picture.svg.setAttribute("height", picture.height * (schematicScale ?? fitting));
}

function fillSchematicLegend() {
  const names = [["conducting", "conducts"], ["blocking", "blocks"], ["breakdown", "breaks down"]];
  const box = element("schematic-legend");
  for (const [state, text] of data.lanes.length ? names : []) {
    const entry = document.createElement("span"), mark = document.createElement("i");
    mark.className = "mark " + state;
    entry.append(mark, text);
    box.append(entry);
  }
  if (data.ports > data.lanes.length) box.append("States of the first " + data.lanes.length + " of " + data.ports + " diodes and switches are known. ");
  if (data.leftOut > 0 && hasWaveforms()) box.append("The page holds " + data.signals.length + " signals; further nets and elements have no values.");
}

// Cursor A through what is visible, once.
let playing = null;
function playSchematic() {
  const seconds = 15, begin = performance.now(), button = element("schematic-play");
  const stop = () => { cancelAnimationFrame(playing); playing = null; isAddressKept = true; keepInAddress(); button.textContent = "▶"; button.setAttribute("aria-label", "Play"); };
  if (playing) return stop();
  isAddressKept = false;  // browsers limit how often it may change
  button.textContent = "■";
  button.setAttribute("aria-label", "Stop");
  const step = now => {
    const share = Math.min(1, (now - begin) / 1000 / seconds);
    setCursor("A", visible.min + share * (visible.max - visible.min));
    playing = share < 1 ? requestAnimationFrame(step) : null;
    if (!playing) stop();
  };
  playing = requestAnimationFrame(step);
}

function startSchematic() {
  if (!drawing) return;
  show("schematic");
  const select = element("schematic-place");
  drawing.places.forEach((place, k) => select.append(new Option(place.path || "main sheet", k)));
  element("schematic-places").hidden = drawing.places.length < 2;
  element("schematic-times").hidden = !hasWaveforms();
  for (const [k, name] of (data.runNames ?? []).entries()) element("schematic-run").append(new Option(name, k));
  element("schematic-runs").hidden = !isSweep || !hasWaveforms();
  element("schematic-run").onchange = event => { shownRun = Number(event.target.value); fillSchematic(); };
  select.onchange = () => showPlace(Number(select.value));
  element("schematic-in").onclick = () => scaleSchematic(1.25);
  element("schematic-out").onclick = () => scaleSchematic(0.8);
  element("schematic-svg").onclick = () => download("svg", new Blob([drawingAsSvg(picture.svg)], {type: "image/svg+xml"}), "schematic");
  element("schematic-pin").onchange = event => element("schematic").classList.toggle("pinned", event.target.checked);
  element("schematic-play").onclick = playSchematic;
  element("schematic-slider").oninput = event => setCursor("A", visible.min + event.target.value / 1000 * (visible.max - visible.min));
  whenViewChanges(fillSchematic);
  whenPointed(() => soon(fillSchematic));
  addEventListener("resize", () => soon(() => scaleSchematic()));
  fillSchematicLegend();
  showPlace(0);
}
