"use strict";
(() => {
  const data = JSON.parse(document.getElementById("run").textContent);
  const run = data.run;
  const colours = ["#1f5fbf", "#d1480a", "#1b7f3b", "#7a3fa0", "#8a6d00", "#b0154f"];
  const axisWidth = 104;
  const element = id => document.getElementById(id);
  const show = id => { element(id).hidden = false; };

  const prefixes = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"], [1e-15, "f"]];
  // A number with a metric prefix; one without a unit has an exponent instead.
  function quantity(value, unit, digits = 6) {
    if (value === null || value === undefined || !Number.isFinite(value)) return "–";
    if (value === 0) return unit ? "0 " + unit : "0";
    const size = Math.abs(Number(value.toPrecision(digits)));
    const fitting = unit && prefixes.find(([factor]) => size >= factor);
    if (!fitting || size >= 1e12) return Number(value.toPrecision(digits)).toString() + (unit ? " " + unit : "");
    return Number((value / fitting[0]).toPrecision(digits)).toString() + " " + fitting[1] + unit;
  }

  function row(table, cells, tag = "td") {
    const line = document.createElement("tr");
    for (const cell of cells) {
      const field = document.createElement(tag);
      field.textContent = cell;
      line.append(field);
    }
    table.append(line);
    return line;
  }

  function list(id, items) {
    for (const item of items) {
      const line = document.createElement("li");
      line.textContent = item;
      element(id).append(line);
    }
  }

  // --- Waveforms -------------------------------------------------------------------------------------------------

  const times = data.times;
  const whole = {min: data.from, max: data.to};
  let visible = {...whole};
  let drawn = 0;
  const cursors = {A: null, B: null};
  const plots = [];

  function setRange(min, max) {
    const least = (whole.max - whole.min) * 1e-9;
    if (max - min < least) [min, max] = [(min + max - least) / 2, (min + max + least) / 2];
    visible = {min: Math.max(min, whole.min), max: Math.min(max, whole.max)};
    for (const plot of plots)
      if (plot.scales.x.min !== visible.min || plot.scales.x.max !== visible.max) plot.setScale("x", visible);
    drawTimeline();
    fillMeasurements();
  }

  function zoom(factor, about = (visible.min + visible.max) / 2) {
    setRange(about - (about - visible.min) * factor, about + (visible.max - about) * factor);
  }

  function shift(share) {
    const length = visible.max - visible.min;
    const min = Math.min(Math.max(visible.min + share * length, whole.min), whole.max - length);
    setRange(min, min + length);
  }

  function setCursor(name, time) {
    cursors[name] = time === null ? null : Math.min(Math.max(time, whole.min), whole.max);
    for (const plot of plots) plot.redraw(false);
    drawTimeline();
    fillMeasurements();
  }

  function drawCursors(context, xOf, top, height, scale) {
    for (const [name, time] of Object.entries(cursors)) {
      if (time === null || time < visible.min || time > visible.max) continue;
      const x = xOf(time);
      context.save();
      context.strokeStyle = context.fillStyle = name === "A" ? "#000" : "#c0392b";
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

  function listen(over, timeAt) {
    let pressed = null;
    over.addEventListener("mousedown", event => { pressed = event.clientX; });
    over.addEventListener("click", event => {
      if (pressed === null || Math.abs(event.clientX - pressed) > 3) return;
      setCursor(event.shiftKey ? "B" : "A", timeAt(event));
    });
    over.addEventListener("wheel", event => {
      event.preventDefault();
      zoom(event.deltaY > 0 ? 1.25 : 0.8, timeAt(event));
    }, {passive: false});
    over.addEventListener("dblclick", () => setRange(whole.min, whole.max));
  }

  function makePlot(members) {
    const unit = data.signals[members[0]].unit;
    let counted = false;
    const options = {
      width: element("panels").clientWidth,
      height: 240,
      padding: [8, 16, 0, 0],
      scales: {
        x: {time: false, range: (plot, min, max) => [min, max]},
        y: {range: (plot, min, max) => min === max ? [min - (Math.abs(min) || 1), max + (Math.abs(max) || 1)] : uPlot.rangeNum(min, max, 0.1, true)},
      },
      cursor: {sync: {key: "time"}, drag: {x: true, y: false, setScale: false}},
      axes: [
        {space: 90, values: (plot, ticks) => ticks.map(tick => quantity(tick, "s"))},
        {size: axisWidth, values: (plot, ticks) => ticks.map(tick => quantity(tick, unit))},
      ],
      series: [{label: "time", value: (plot, value) => quantity(value, "s", 9)}].concat(members.map((member, k) => ({
        label: data.signals[member].name,
        stroke: data.signals[member].colour || colours[k % colours.length],
        width: 1.5,
        pxAlign: 0,
        points: {show: false},
        value: (plot, value) => quantity(value, unit),
      }))),
      hooks: {
        setSelect: [plot => {
          if (plot.select.width < 3) return;
          const from = plot.posToVal(plot.select.left, "x"), to = plot.posToVal(plot.select.left + plot.select.width, "x");
          plot.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
          setRange(from, to);
        }],
        draw: [plot => {
          const {top, height} = plot.bbox;
          drawCursors(plot.ctx, time => plot.valToPos(time, "x", true), top, height, devicePixelRatio);
          if (!counted && countCurvePixels(plot) > 0) {
            counted = true;
            document.documentElement.dataset.drawn = ++drawn;
          }
        }],
        ready: [plot => listen(plot.over, event => plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x"))],
      },
    };
    return new uPlot(options, [times, ...members.map(member => data.signals[member].values)], element("panels"));
  }

  // --- Time line of events and modes ---------------------------------------------------------------------------

  const rowHeight = 16;

  function timelineX(canvas) {
    const width = canvas.clientWidth - axisWidth - 16;
    return time => axisWidth + width * (time - visible.min) / (visible.max - visible.min);
  }

  // Those that could not be told apart become a pale bar.
  function drawTicks(context, places, y) {
    const leastCrowd = 4;
    for (let k = 0; k < places.length;) {
      let end = k + 1;
      while (end < places.length && places[end] <= places[end - 1] + 1) ++end;
      const length = places[end - 1] - places[k] + 1;
      context.globalAlpha = length < leastCrowd ? 1 : 0.4;
      context.fillRect(places[k], y, length, rowHeight - 5);
      k = end;
    }
    context.globalAlpha = 1;
  }

  function drawTimeline() {
    const canvas = element("timeline");
    const rows = data.marks.length + data.lanes.length;
    canvas.style.display = rows === 0 ? "none" : "block";
    if (rows === 0) return;
    const width = canvas.clientWidth, height = rows * rowHeight + 4;
    canvas.style.height = height + "px";
    canvas.width = width * devicePixelRatio;
    canvas.height = height * devicePixelRatio;
    const context = canvas.getContext("2d");
    context.scale(devicePixelRatio, devicePixelRatio);
    const xOf = timelineX(canvas), right = width - 16;
    context.font = "11px sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    let y = 2;
    const label = (name, colour) => {
      context.fillStyle = colour || "#222";
      context.fillText(name.length > 16 ? "…" + name.slice(-15) : name, axisWidth - 6, y + rowHeight / 2);
    };
    for (const marks of data.marks) {
      label(marks.name, marks.colour);
      context.fillStyle = marks.colour || colours[1];
      drawTicks(context, marks.x.filter(time => time >= visible.min && time <= visible.max).map(time => Math.round(xOf(time))), y + 2);
      y += rowHeight;
    }
    for (const lane of data.lanes) {
      label(lane.name);
      context.fillStyle = colours[0];
      for (let k = 0; k < lane.times.length; ++k) {
        const begin = Math.max(lane.times[k], visible.min);
        const end = Math.min(k + 1 < lane.times.length ? lane.times[k + 1] : whole.max, visible.max);
        if (lane.shares[k] === 0 || end <= begin) continue;
        context.globalAlpha = Math.max(lane.shares[k], 0.1);
        context.fillRect(xOf(begin), y + 2, Math.max(xOf(end) - xOf(begin), 0.5), rowHeight - 5);
      }
      context.globalAlpha = 1;
      y += rowHeight;
    }
    context.strokeStyle = "#bbb";
    context.strokeRect(axisWidth, 0.5, right - axisWidth, height - 1);
    drawCursors(context, xOf, 0, height, 1);
    document.documentElement.dataset.lanes = data.lanes.length;
    document.documentElement.dataset.marks = data.marks.length;
  }

  // --- Measurements ----------------------------------------------------------------------------------------------

  // The last row at or before a time.
  function rowBefore(time) {
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  function valueAt(values, time) {
    const k = rowBefore(time);
    if (k + 1 >= times.length || times[k] >= time) return values[k];
    return values[k] + (values[k + 1] - values[k]) * (time - times[k]) / (times[k + 1] - times[k]);
  }

  // Of the straight lines between rows, over [from, to].
  function measure(values, from, to) {
    const first = valueAt(values, from), last = valueAt(values, to);
    let low = Math.min(first, last), high = Math.max(first, last), area = 0, square = 0;
    let time = from, value = first;
    const add = (nextTime, nextValue) => {
      area += (nextTime - time) * (value + nextValue) / 2;
      square += (nextTime - time) * (value * value + value * nextValue + nextValue * nextValue) / 3;
      [time, value] = [nextTime, nextValue];
    };
    for (let k = rowBefore(from); k < times.length && times[k] < to; ++k) {
      if (times[k] <= from) continue;
      low = Math.min(low, values[k]);
      high = Math.max(high, values[k]);
      add(times[k], values[k]);
    }
    add(to, last);
    return {low, high, mean: area / (to - from), rms: Math.sqrt(square / (to - from))};
  }

  // Where a signal has values: runs of a sweep need not be equally long.
  function extentOf(signal) {
    if (!signal.extent) {
      const has = value => value !== null;
      signal.extent = {begin: times[signal.values.findIndex(has)], end: times[signal.values.findLastIndex(has)]};
    }
    return signal.extent;
  }

  function fillMeasurements() {
    const both = cursors.A !== null && cursors.B !== null && cursors.A !== cursors.B;
    const from = Math.max(both ? Math.min(cursors.A, cursors.B) : visible.min, times[0]);
    const to = Math.min(both ? Math.max(cursors.A, cursors.B) : visible.max, times[times.length - 1]);
    const parts = [];
    for (const name of ["A", "B"]) if (cursors[name] !== null) parts.push(name + " = " + quantity(cursors[name], "s", 9));
    if (both) parts.push("B − A = " + quantity(cursors.B - cursors.A, "s", 9), "1/|B − A| = " + quantity(1 / (to - from), "Hz"));
    parts.push((both ? "between the cursors" : "visible") + ": " + quantity(from, "s", 9) + " to " + quantity(to, "s", 9));
    element("window").textContent = parts.join(";  ");
    const table = element("measurements");
    table.replaceChildren();
    row(table, ["signal", "at A", "at B", "B − A", "minimum", "maximum", "peak to peak"].concat(data.thinned ? [] : ["mean", "RMS"]), "th");
    if (to <= from) return;
    for (const signal of data.signals) {
      const {begin, end} = extentOf(signal);
      const at = name => cursors[name] === null || cursors[name] < begin || cursors[name] > end ? null : valueAt(signal.values, cursors[name]);
      const a = at("A"), b = at("B");
      const own = {from: Math.max(from, begin), to: Math.min(to, end)};
      if (own.to <= own.from) continue;
      const m = measure(signal.values, own.from, own.to);
      const numbers = [a, b, a === null || b === null ? null : b - a, m.low, m.high, m.high - m.low].concat(data.thinned ? [] : [m.mean, m.rms]);
      row(table, [signal.name, ...numbers.map(number => quantity(number, signal.unit))]);
    }
  }

  function fillWaveforms() {
    if (times.length < 2) return;
    show("waveforms");
    for (const members of data.panels) plots.push(makePlot(members));
    document.documentElement.dataset.plots = plots.length;
    const canvas = element("timeline");
    const timeAt = event => {
      const box = canvas.getBoundingClientRect(), width = canvas.clientWidth - axisWidth - 16;
      return visible.min + (visible.max - visible.min) * (event.clientX - box.left - axisWidth) / width;
    };
    listen(canvas, timeAt);
    const ports = data.ports > data.lanes.length ? " The first " + data.lanes.length + " of " + data.ports + " ports are shown." : "";
    const ticks = data.marksTitle && data.marks.length ? "A line a run, with a tick where " + data.marksTitle + "; pale where ticks are too many to be told apart." : "";
    element("timeline-hint").textContent = data.lanes.length ? "Filled: the diode or switch conducts; a shade: for that share of the time." + ports : ticks;
    element("measurement-hint").textContent = data.thinned
      ? "The run has more rows than this page keeps: the curves show the extremes of each short piece of time, so that values between them, means and RMS values are not given. Zoom by running a shorter part (.tran … Tstart)."
      : "Values lie on straight lines between the rows.";
    element("whole").onclick = () => setRange(whole.min, whole.max);
    element("in").onclick = () => zoom(0.5);
    element("out").onclick = () => zoom(2);
    element("left").onclick = () => shift(-0.25);
    element("right").onclick = () => shift(0.25);
    element("clear").onclick = () => { setCursor("A", null); setCursor("B", null); };
    addEventListener("resize", () => {
      for (const plot of plots) plot.setSize({width: element("panels").clientWidth, height: 240});
      drawTimeline();
    });
    showWanted();
  }

  // report.html#from=1e-3&to=2e-3&A=1.1e-3&B=1.5e-3 opens at that view.
  function showWanted() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const number = (name, otherwise) => wanted.has(name) && Number.isFinite(Number(wanted.get(name))) ? Number(wanted.get(name)) : otherwise;
    for (const name of ["A", "B"]) setCursor(name, number(name, null));
    setRange(number("from", whole.min), number("to", whole.max));
  }

  // --- Tables ----------------------------------------------------------------------------------------------------

  function fillEvents() {
    if (data.eventCount === 0) return;
    show("events");
    element("event-hint").textContent = data.eventCount + " events" +
      (data.events.length < data.eventCount ? ", the first " + data.events.length + " of them" : "") + ". Click one to see it.";
    const table = element("event-table");
    table.className = "words";
    const head = document.createElement("thead"), body = document.createElement("tbody");
    table.append(head, body);
    row(head, ["time", "what", "changes"], "th");
    for (const event of data.events) {
      row(body, [quantity(event.time, "s", 12), event.kinds.join(", "), event.changes]).onclick = () => {
        const half = Math.min((visible.max - visible.min) / 2, (whole.max - whole.min) / 40);
        setCursor("A", event.time);
        setRange(event.time - half, event.time + half);
        element("waveforms").scrollIntoView();
      };
    }
  }

  function fillOperatingPoint() {
    if (!run.operating_point) return;
    show("operating-point");
    const units = Object.fromEntries(run.signals.map(signal => [signal.name, signal.unit]));
    for (const [name, value] of Object.entries(run.operating_point))
      row(element("operating-point-table"), [name, quantity(value, units[name], 9)]);
  }

  function valueOf(result) {
    return quantity(result.value, result.unit, 9) + (result.left_out ? " (leaves out " + result.left_out + ")" : "");
  }

  function fillResults() {
    if (run.measurements.length + run.fourier.length === 0) return;
    show("results");
    for (const result of run.measurements) row(element("result-table"), [result.name, result.failure || valueOf(result)]);
    for (const result of run.fourier) {
      const heading = document.createElement("h3"), table = document.createElement("table");
      heading.textContent = "Fourier analysis of " + result.signal + 
        (result.failure ? ": " + result.failure : ", THD " + (result.thd === null ? "infinite: there are impulses" : quantity(100 * result.thd, "%")));
      row(table, ["frequency", "magnitude", "phase"], "th");
      for (const harmonic of result.harmonics)
        row(table, [quantity(harmonic.frequency, "Hz"), quantity(harmonic.magnitude, ""), quantity(harmonic.phase, "") + "°"]);
      element("fourier").append(heading, table);
    }
  }

  function fillRuns() {
    if (!run.runs) return;
    show("runs");
    const mostRows = 1000, runs = run.runs.slice(0, mostRows), table = element("run-table");
    const count = run.runs.length, failed = run.runs.filter(each => each.failure !== null).length;
    element("run-hint").textContent = count + " runs" + (failed ? ", " + failed + " of them failed" : "") +
      (count > mostRows ? "; the first " + mostRows + " are listed" : "") +
      (0 < data.drawnRuns && data.drawnRuns < count ? "; the curves are those of " + data.drawnRuns + ", evenly spread" : "") + ".";
    const measured = runs.find(each => each.measurements.length)?.measurements.map(each => each.name) ?? [];
    const units = run.signals.map(signal => signal.unit), points = runs.find(each => each.operating_point)?.operating_point ?? {};
    row(table, [...Object.keys(runs[0].parameters), ...Object.keys(points), ...measured, "rows", "events", "worst residual", "failure"], "th");
    for (const each of runs) {
      const values = measured.map((name, k) => { const m = each.measurements[k]; return m && !m.failure ? valueOf(m) : "failed"; });
      const point = Object.keys(points).map((name, k) => each.operating_point ? quantity(each.operating_point[name], units[k], 9) : "failed");
      const {complementarity, kcl_kvl, energy} = each.certificate;
      row(table, [...Object.values(each.parameters), ...point, ...values, each.rows, each.events,
        Math.max(complementarity, kcl_kvl, energy).toExponential(1), each.failure ?? ""]);
    }
    document.documentElement.dataset.runs = runs.length;
  }

  function fillIdealisation() {
    if (run.idealisation.length === 0) return;
    show("idealisation");
    const table = element("idealisation-table");
    row(table, ["what", "where", "of", "how"], "th");
    for (const departure of run.idealisation) row(table, [departure.kind, departure.place, departure.subject, departure.text]);
  }

  function fillCertificate(stats) {
    show("certificate");
    const names = {complementarity: "complementarity: ideal diodes conduct without voltage, block without current",
      kcl_kvl: "Kirchhoff's laws", energy: "energy: delivered = dissipated + stored"};
    const table = element("certificate-table");
    for (const [key, words] of Object.entries(names)) row(table, [words, stats.certificate[key] === 0 ? "0" : stats.certificate[key]?.toExponential(1) ?? "–"]);
    const passive = stats.certificate.passive;
    row(table, ["passive: without its sources the circuit cannot deliver energy", passive === null ? "not decided" : passive ? "yes" : "no"]);
    row(table, ["points checked", stats.certificate.points_checked]);
  }

  function fillStatistics(stats) {
    show("statistics");
    const table = element("statistics-table");
    for (const [key, value] of Object.entries(stats)) {
      if (typeof value === "object") continue;
      row(table, [key.replaceAll("_", " "), value]);
    }
    for (const [key, value] of Object.entries(stats.seconds)) row(table, ["time: " + key, quantity(value, "s", 3)]);
  }

  element("title").textContent = document.title = run.title || run.deck;
  const parts = [run.deck];
  if (run.output) parts.push(run.output.rows + " rows to t = " + quantity(run.output.end, "s") + " in " + run.output.file);
  if (run.stats) parts.push(run.stats.engine + " engine", run.stats.events + " events", run.stats.modes_visited + " modes");
  element("summary").textContent = parts.join(" · ");
  const errors = run.notes.filter(note => note.includes("error["));
  if (errors.length) {
    element("failure").textContent = errors.join("\n");
    show("failure");
  }
  fillWaveforms();
  fillOperatingPoint();
  fillResults();
  fillRuns();
  fillEvents();
  fillIdealisation();
  if (run.stats) {
    fillCertificate(run.stats);
    fillStatistics(run.stats);
  }
  if (run.notes.length) {
    show("messages");
    list("message-list", run.notes);
  }
  document.documentElement.dataset.ready = "true";
})();
