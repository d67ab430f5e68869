// One signal against another, within the window of time.

// Values of two signals of one run at the ends of their pieces and between, with both values of a jump.
function pathOf(first, second, from, to) {
  const edges = new Set([from, to]), mostPoints = 100000;
  for (const signal of [first, second]) for (const edge of signal.edges) if (edge > from && edge < to) edges.add(edge);
  const times = [...edges].sort((a, b) => a - b), parts = Math.max(1, Math.min(24, Math.floor(mostPoints / times.length)));
  const points = [], at = (time, isBefore) => points.push([valueAt(first, time, isBefore), valueAt(second, time, isBefore)]);
  for (let k = 0; k + 1 < times.length; ++k) {
    for (let part = 0; part < parts; ++part) at(times[k] + (times[k + 1] - times[k]) * part / parts, false);
    at(times[k + 1], true);
  }
  return points.filter(([x, y]) => x !== null && y !== null);
}

const xySignal = id => data.signals.find(signal => signal.name === element(id).value);

function fillXy() {
  if (!element("xy").open) return;
  const first = xySignal("xy-x"), second = xySignal("xy-y");
  const isPossible = first && second && first.record === second.record, {from, to} = measuredWindow();
  element("xy-chart").hidden = !isPossible;
  element("xy-hint").textContent = isPossible ? second.name + " over " + first.name + ", " + quantity(Math.max(from, detailFrom), "s", 9) + " to " + quantity(to, "s", 9) + "."
    : "Both signals must be of the same run.";
  if (!isPossible) return;
  const points = pathOf(first, second, Math.max(from, detailFrom), to);
  const x = scaleOf(points.map(point => point[0]), first.unit), y = scaleOf(points.map(point => point[1]), second.unit);
  drawChart(element("xy-chart"), x, y, (context, xOf, yOf) => drawCurve(context, points.map(([a, b]) => [xOf(a), yOf(b)]), colours[0]));
  Object.assign(element("xy-chart").dataset, {points: points.length, x: [x.min, x.max].join(" "), y: [y.min, y.max].join(" ")});
}

function fillXyChoices() {
  for (const [id, place] of [["xy-x", 0], ["xy-y", 1]]) {
    const box = element(id), chosen = box.value;
    box.replaceChildren(...data.signals.map(signal => new Option(signal.name)));
    box.value = data.signals.some(signal => signal.name === chosen) ? chosen : data.signals[Math.min(place, data.signals.length - 1)].name;
  }
}

function listenToXy() {
  fillXyChoices();
  element("xy").addEventListener("toggle", () => { fillXy(); keepInAddress(); });
  for (const id of ["xy-x", "xy-y"]) element(id).addEventListener("change", () => { fillXy(); keepInAddress(); });
  whenViewChanges(() => { if (element("xy-x").options.length !== data.signals.length) fillXyChoices(); soon(fillXy); });
}

function keepXy(kept) {
  if (element("xy").open) kept.set("xy", element("xy-x").value + ";" + element("xy-y").value);
}

function showWantedXy(wanted) {
  if (!wanted.has("xy")) return;
  [element("xy-x").value, element("xy-y").value] = wanted.get("xy").split(";");
  element("xy").open = true;
  fillXy();
}
