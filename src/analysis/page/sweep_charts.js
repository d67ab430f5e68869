// Measurements of a sweep against the swept parameter, one chart a measurement; as a histogram where the runs are draws of chance.

// The parameter along the axis is the one with most values; each combination of the others is a curve.
function sweptParameter(runs) {
  const names = Object.keys(runs[0].parameters);
  const counts = names.map(name => new Set(runs.map(each => each.parameters[name])).size);
  return names[counts.indexOf(Math.max(...counts))];
}

function curvesOf(runs, parameter, place) {
  const curves = new Map();
  for (const each of runs) {
    const measured = each.measurements[place];
    if (!measured || measured.failure || !Number.isFinite(measured.value)) continue;
    const others = Object.entries(each.parameters).filter(([name]) => name !== parameter).map(([name, value]) => name + "=" + value).join(", ");
    if (!curves.has(others)) curves.set(others, []);
    curves.get(others).push([Number(each.parameters[parameter]), measured.value]);
  }
  for (const points of curves.values()) points.sort((a, b) => a[0] - b[0]);
  return curves;
}

// Draws of chance turn at two of three points; a curve that something makes of a parameter hardly ever.
function looksRandom(points) {
  const least = 20, values = points.map(point => point[1]);
  let turns = 0;
  for (let k = 1; k + 1 < values.length; ++k) if ((values[k] - values[k - 1]) * (values[k + 1] - values[k]) < 0) ++turns;
  return values.length >= least && turns > (values.length - 2) / 2;
}

function histogramOf(values) {
  const low = Math.min(...values), high = Math.max(...values), count = Math.max(5, Math.min(60, Math.ceil(2 * Math.cbrt(values.length))));
  const bins = new Array(count).fill(0), width = (high - low) / count || 1;
  for (const value of values) ++bins[Math.min(count - 1, Math.floor((value - low) / width))];
  return {low, width, bins};
}

function drawHistogram(canvas, values, unit) {
  const {low, width, bins} = histogramOf(values);
  const x = {min: low - width, max: low + (bins.length + 1) * width, unit}, y = {min: 0, max: 1.06 * Math.max(...bins), text: tick => Number.isInteger(tick) ? tick + " runs" : ""};
  drawChart(canvas, x, y, (context, xOf, yOf) => {
    context.fillStyle = colours[0];
    bins.forEach((count, k) => context.fillRect(xOf(low + k * width), yOf(count), xOf(low + width) - xOf(low) - 1, yOf(0) - yOf(count)));
  });
  canvas.dataset.bins = bins.join(" ");
}

function drawCurves(canvas, curves, unit) {
  const all = [...curves.values()].flat();
  drawChart(canvas, scaleOf(all.map(point => point[0]), "", 0.03), scaleOf(all.map(point => point[1]), unit), (context, xOf, yOf) => {
    [...curves.values()].forEach((points, k) => {
      const places = points.map(([a, b]) => [xOf(a), yOf(b)]);
      drawCurve(context, places, colours[k % colours.length]);
      if (points.length > 60) return;
      context.fillStyle = colours[k % colours.length];
      for (const [a, b] of places) { context.beginPath(); context.arc(a, b, 3, 0, 7); context.fill(); }
    });
  });
  canvas.dataset.curves = curves.size;
}

function statisticsText(values, unit) {
  const sorted = [...values].sort((a, b) => a - b), mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const deviation = Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / Math.max(values.length - 1, 1));
  const quantile = share => sorted[Math.round(share * (sorted.length - 1))];
  return "mean " + quantity(mean, unit) + ", standard deviation " + quantity(deviation, unit) + ", 5 % below " + quantity(quantile(0.05), unit) +
    ", median " + quantity(quantile(0.5), unit) + ", 5 % above " + quantity(quantile(0.95), unit);
}

function makeSweepChart(name, unit, parameter, curves) {
  const box = document.createElement("figure"), heading = document.createElement("figcaption"), canvas = document.createElement("canvas");
  const legend = document.createElement("p"), hint = document.createElement("p"), values = [...curves.values()].flat().map(point => point[1]);
  const mostNames = 8, isRandom = looksRandom([...curves.values()][0]);
  heading.textContent = isRandom ? name + " of " + values.length + " runs" : name + " against " + parameter;
  canvas.className = "chart";
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", heading.textContent + "; the numbers are in the table of runs");
  hint.className = "hint";
  legend.className = "legend";
  if (isRandom) hint.textContent = statisticsText(values, unit);
  box.append(heading, canvas, legend, hint);
  element("sweep-charts").append(box);
  return () => {
    if (isRandom) return drawHistogram(canvas, values, unit);
    drawCurves(canvas, curves, unit);
    if (curves.size > 1 && curves.size <= mostNames) fillLegend(legend, [...curves.keys()].map((text, k) => [text, colours[k % colours.length]]));
  };
}

const sweepCharts = [];
function fillSweepCharts() {
  const runs = (run.runs ?? []).filter(each => each.measurements.length);
  if (runs.length < 2) return;
  const mostCharts = 24, parameter = sweptParameter(runs);
  if (runs.some(each => !Number.isFinite(Number(each.parameters[parameter])))) return;
  runs[0].measurements.slice(0, mostCharts).forEach(({name}, place) => {
    const curves = curvesOf(runs, parameter, place), unit = runs.find(each => each.measurements[place]?.unit)?.measurements[place].unit ?? "";
    if ([...curves.values()].flat().length > 1) sweepCharts.push(makeSweepChart(name, unit, parameter, curves));
  });
  if (!sweepCharts.length) return;
  show("sweep");
  drawSweepCharts();
  document.documentElement.dataset.sweepCharts = sweepCharts.length;
}

function drawSweepCharts() { for (const draw of sweepCharts) draw(); }
