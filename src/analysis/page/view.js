// What the page shows: the traces, the window of time, the cursors; and whom a change of these concerns.
const data = JSON.parse(element("run").textContent);
const run = data.run;
const isSweep = Boolean(run.runs);
const {placeIn, valueAt, measure, columnsOf, derived, piecesWithin} = solutionOf(data);

const darkMode = matchMedia("(prefers-color-scheme: dark)");
const coloursOnLight = ["#1f5fbf", "#d1480a", "#1b7f3b", "#7a3fa0", "#8a6d00", "#b0154f"];
const coloursOnDark = ["#7fb0ff", "#ff9a66", "#6fd08f", "#cfa0f0", "#e0c050", "#ff8fb5"];
let colours = darkMode.matches ? coloursOnDark : coloursOnLight;

const isNarrow = matchMedia("(max-width: 600px)");
// The room for labels at the left of all plots, so that their times stand above each other, and for half of the last label of time.
const axisWidth = () => isNarrow.matches ? 88 : 104;
const rightMargin = () => isNarrow.matches ? 30 : 36;
const axisFont = () => (isNarrow.matches ? 11 : 12) + "px sans-serif";

const whole = {min: data.from, max: data.to};
let visible = {...whole};
const cursors = {A: null, B: null};
let traces = new Set();

const watchers = [];
// Has a function called after each change of the window, the cursors or the traces.
function whenViewChanges(act) { watchers.push(act); }
function tellChange() { for (const act of watchers) act(); }

// The time at the pointer while that is in a plot, else null; and whom it concerns.
let pointedTime = null;
const pointerWatchers = [];
function whenPointed(act) { pointerWatchers.push(act); }
function pointAt(time) {
  if (time === pointedTime) return;
  pointedTime = time;
  for (const act of pointerWatchers) act();
}

// Once before the next picture, however often it is asked for: a moving pointer reports more often than a screen draws.
const waiting = new Set();
function soon(act) {
  if (waiting.has(act)) return;
  waiting.add(act);
  requestAnimationFrame(() => { waiting.delete(act); act(); });
}

function setRange(min, max) {
  const least = (whole.max - whole.min) * 1e-9;
  if (max - min < least) [min, max] = [(min + max - least) / 2, (min + max + least) / 2];
  visible = {min: Math.max(min, whole.min), max: Math.min(max, whole.max)};
  for (const plot of plots) drawPlot(plot);
  tellChange();
}

function zoom(factor, about = (visible.min + visible.max) / 2) {
  setRange(about - (about - visible.min) * factor, about + (visible.max - about) * factor);
}

// Moves a window of this length, as far as the run goes.
function moveTo(min, length = visible.max - visible.min) {
  const begin = Math.min(Math.max(min, whole.min), whole.max - length);
  setRange(begin, begin + length);
}

function shift(share) { moveTo(visible.min + share * (visible.max - visible.min)); }

function showWhole() {
  for (const plot of plots) plot.yWindow = null;
  setRange(whole.min, whole.max);
}

// Where only bins are known a window ends between two of them.
const detailFrom = Math.max(...data.signals.map(signal => signal.edges[0]));
function knownTime(time) {
  for (const record of data.records) {
    if (!record.bins.length || time >= record.bins[record.bins.length - 1]) continue;
    const k = placeIn(record.bins, time);
    return k + 1 < record.bins.length && record.bins[k + 1] - time < time - record.bins[k] ? record.bins[k + 1] : record.bins[k];
  }
  return time;
}

// The times that statistics are of: between the cursors where there are two, else what is visible.
function measuredWindow() {
  const isBetween = cursors.A !== null && cursors.B !== null && cursors.A !== cursors.B;
  const begin = Math.min(...data.signals.map(signal => signal.begin)), end = Math.max(...data.signals.map(signal => signal.end));
  return {isBetween, from: knownTime(Math.max(isBetween ? Math.min(cursors.A, cursors.B) : visible.min, begin)),
    to: knownTime(Math.min(isBetween ? Math.max(cursors.A, cursors.B) : visible.max, end))};
}

// The event nearest to a time, if it is within a few pixels.
function snapped(time) {
  const reach = 6 * (visible.max - visible.min) / columns();
  let best = time, distance = reach;
  for (const marks of data.marks) {
    const k = placeIn(marks.x, time);
    for (const candidate of [marks.x[k], marks.x[k + 1]])
      if (candidate !== undefined && Math.abs(candidate - time) < distance) [best, distance] = [candidate, Math.abs(candidate - time)];
  }
  for (const record of data.records) {  // the event itself: marks have fewer digits
    const k = placeIn(record.edges, best);
    for (const edge of [record.edges[k], record.edges[k + 1]])
      if (best !== time && Math.abs(edge - best) <= 1e-11 * Math.abs(best)) return edge;
  }
  return best;
}

// The next event after a time, or the last before it.
function nextEvent(time, forwards) {
  const all = data.marks.flatMap(marks => {
    const k = placeIn(marks.x, time);
    return [marks.x[k - 1], marks.x[k], marks.x[k + 1]];
  }).filter(candidate => candidate !== undefined && (forwards ? candidate > time : candidate < time));
  return all.length ? (forwards ? Math.min(...all) : Math.max(...all)) : time;
}

function setCursor(name, time) {
  cursors[name] = time === null ? null : Math.min(Math.max(time, whole.min), whole.max);
  for (const plot of plots) plot.redraw(false);
  tellChange();
}

function clearCursors() {
  setCursor("A", null);
  setCursor("B", null);
}

function drawCursors(context, xOf, top, height, scale) {
  for (const [name, time] of Object.entries(cursors)) {
    if (time === null || time < visible.min || time > visible.max) continue;
    const x = xOf(time);
    context.save();
    context.strokeStyle = context.fillStyle = name === "A" ? styled("--ink") : styled("--mark");
    context.lineWidth = scale;
    context.setLineDash([4 * scale, 3 * scale]);
    context.beginPath();
    context.moveTo(x, top);
    context.lineTo(x, top + height);
    context.stroke();
    context.font = 12 * scale + "px sans-serif";
    context.textAlign = "left";
    context.textBaseline = "top";
    context.fillText(name, x + 3 * scale, top + 2 * scale);
    context.restore();
  }
}
