// The waveforms: one plot a panel, drawn by uPlot from the exact pieces.
const plots = [];
const plotHeight = 240;
let drawn = 0;

// Fewer than pixels: from four points a pixel on uPlot draws one upright line for each pixel, and slopes become stairs.
const columns = () => Math.max(100, Math.min(1600, Math.floor(0.97 * (element("panels").clientWidth - axisWidth() - rightMargin()))));

// The curves for what is visible, with four points a column.
function drawPlot(plot) {
  const count = columns(), width = (visible.max - visible.min) / count;
  const x = Array.from({length: 4 * count}, (unused, k) => visible.min + width * (Math.floor(k / 4) + [0, 0.33, 0.67, 1][k % 4]));
  plot.setData([x, ...plot.members.map(member => columnsOf(data.signals[member], visible.min, visible.max, count))], false);
  plot.setScale("x", visible);
}

// A window of values instead of the one that fits; null: the one that fits.
function setYWindow(plot, window) {
  plot.yWindow = window;
  drawPlot(plot);
  tellChange();
}

// Whether a plot shows anything besides its grid: how many pixels have the colour of a curve.
function countCurvePixels(plot) {
  const {left, top, width, height} = plot.bbox;
  const pixels = plot.ctx.getImageData(left, top, width, height).data;
  let count = 0;
  for (let k = 0; k < pixels.length; k += 4) {
    const spread = Math.max(pixels[k], pixels[k + 1], pixels[k + 2]) - Math.min(pixels[k], pixels[k + 1], pixels[k + 2]);
    if (pixels[k + 3] > 100 && spread > 60) ++count;
  }
  return count;
}

const colourOf = (member, place) => data.signals[member].colour || colours[place % colours.length];

function seriesOf(member, place) {
  const signal = data.signals[member];
  const valueAtPointer = plot => plot.cursor.left === null || plot.cursor.left < 0 ? "–"
    : quantity(valueAt(signal, plot.posToVal(plot.cursor.left, "x")), signal.unit);
  return {label: signal.name, stroke: colourOf(member, place), width: 1.5, pxAlign: 0, points: {show: false}, value: valueAtPointer};
}

function rangeOfValues(plot, min, max) {
  if (plot.yWindow) return [plot.yWindow.min, plot.yWindow.max];
  return min === max ? [min - (Math.abs(min) || 1), max + (Math.abs(max) || 1)] : uPlot.rangeNum(min, max, 0.1, true);
}

// Ends of curves and cursors, and for tests how many plots show a curve.
function finishDrawing(plot) {
  const {top, height} = plot.bbox;
  drawCursors(plot.ctx, time => plot.valToPos(time, "x", true), top, height, devicePixelRatio);
  if (plot.isCounted || countCurvePixels(plot) === 0) return;
  plot.isCounted = true;
  document.documentElement.dataset.drawn = ++drawn;
}

function makePlot(members) {
  const unit = data.signals[members[0]].unit;
  const axis = {font: axisFont(), stroke: styled("--ink"), grid: {stroke: styled("--grid"), width: 1}, ticks: {stroke: styled("--grid"), width: 1}};
  const options = {
    width: element("panels").clientWidth,
    height: plotHeight,
    padding: [8, rightMargin(), 0, 0],
    scales: {x: {time: false, range: () => [visible.min, visible.max]}, y: {range: rangeOfValues}},
    cursor: {sync: {key: "time"}, drag: {x: false, y: false, setScale: false}},
    axes: [
      {...axis, space: 90, values: (plot, ticks) => tickTexts(ticks, "s")},
      {...axis, size: axisWidth(), values: (plot, ticks) => tickTexts(ticks, unit)},
    ],
    series: [{label: "time", value: (plot, value) => quantity(value, "s", 9)}, ...members.map(seriesOf)],
    hooks: {draw: [finishDrawing], ready: [listenToPlot], setCursor: [plot => pointAt(plot.cursor.left >= 0 ? plot.posToVal(plot.cursor.left, "x") : null)]},
  };
  const plot = new uPlot(options, [[whole.min, whole.max], ...members.map(() => [null, null])], element("panels"));
  plot.members = members;
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", "Curves of " + members.map(member => data.signals[member].name).join(", ") + " over time");
  return plot;
}

const extents = new Map();
function extentOf(signal) {
  if (!extents.has(signal)) {
    const m = measure(signal, signal.exactFrom, signal.end);
    extents.set(signal, {size: Math.max(Math.abs(m.low), Math.abs(m.high)), swing: m.high - m.low});
  }
  return extents.get(signal);
}

function rebuildPlots() {
  for (const plot of plots.splice(0)) plot.destroy();
  const panels = isSweep ? data.panels.map(members => members.filter(member => traces.has(member))).filter(members => members.length)
    : panelsByKind(data.signals, traces, signal => extentOf(signal).size);
  // What swings widely would cover what does not: it is drawn first.
  const swing = member => extentOf(data.signals[member]).swing;
  for (const members of panels) plots.push(makePlot(isSweep ? members : [...members].sort((a, b) => swing(b) - swing(a))));
  for (const plot of plots) drawPlot(plot);
  document.documentElement.dataset.plots = plots.length;
  document.documentElement.dataset.columns = columns();
}
