"use strict";
(() => {
  const data = JSON.parse(document.getElementById("run").textContent);
  const run = data.run;
  const {placeIn, valueAt, measure, columnsOf, derived} = solutionOf(data);
  const darkMode = matchMedia("(prefers-color-scheme: dark)");
  const coloursOnLight = ["#1f5fbf", "#d1480a", "#1b7f3b", "#7a3fa0", "#8a6d00", "#b0154f"];
  const coloursOnDark = ["#7fb0ff", "#ff9a66", "#6fd08f", "#cfa0f0", "#e0c050", "#ff8fb5"];
  let colours = darkMode.matches ? coloursOnDark : coloursOnLight;
  const styled = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const axisWidth = 104;
  const element = id => document.getElementById(id);
  const show = id => { element(id).hidden = false; };

  const prefixes = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"], [1e-15, "f"]];
  // A number with a metric prefix; one without a unit has an exponent instead.
  function quantity(value, unit, digits = 6) {
    if (value === null || value === undefined || !Number.isFinite(value)) return "–";
    if (value === 0) return unit ? "0 " + unit : "0";
    const size = Math.abs(Number(value.toPrecision(digits)));
    const fitting = unit && unit !== "%" && prefixes.find(([factor]) => size >= factor);
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

  function button(text, act) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.onclick = act;
    return made;
  }

  function list(id, items) {
    for (const item of items) {
      const line = document.createElement("li");
      line.textContent = item;
      element(id).append(line);
    }
  }

  // --- Waveforms -------------------------------------------------------------------------------------------------

  const whole = {min: data.from, max: data.to};
  let visible = {...whole};
  let drawn = 0;
  const cursors = {A: null, B: null};
  const plots = [];

  function setRange(min, max) {
    const least = (whole.max - whole.min) * 1e-9;
    if (max - min < least) [min, max] = [(min + max - least) / 2, (min + max + least) / 2];
    visible = {min: Math.max(min, whole.min), max: Math.min(max, whole.max)};
    for (const plot of plots) drawPlot(plot);
    drawTimeline();
    drawOverview();
    fillMeasurements();
    keepInAddress();
  }

  const columns = () => Math.max(100, Math.min(1600, Math.round(element("panels").clientWidth - axisWidth)));

  // The curves for what is visible, with four points a column.
  function drawPlot(plot) {
    const count = columns(), width = (visible.max - visible.min) / count;
    const x = Array.from({length: 4 * count}, (unused, k) => visible.min + width * (Math.floor(k / 4) + [0, 0.33, 0.67, 1][k % 4]));
    plot.setData([x, ...plot.members.map(member => columnsOf(data.signals[member], visible.min, visible.max, count))], false);
    plot.setScale("x", visible);
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
    keepInAddress();
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
      setCursor(event.shiftKey ? "B" : "A", snapped(timeAt(event)));
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
    const axis = {stroke: styled("--ink"), grid: {stroke: styled("--grid"), width: 1}, ticks: {stroke: styled("--grid"), width: 1}};
    const options = {
      width: element("panels").clientWidth,
      height: 240,
      padding: [8, 16, 0, 0],
      scales: {
        x: {time: false, range: () => [visible.min, visible.max]},
        y: {range: (plot, min, max) => min === max ? [min - (Math.abs(min) || 1), max + (Math.abs(max) || 1)] : uPlot.rangeNum(min, max, 0.1, true)},
      },
      cursor: {sync: {key: "time"}, drag: {x: true, y: false, setScale: false}},
      axes: [
        {...axis, space: 90, values: (plot, ticks) => ticks.map(tick => quantity(tick, "s"))},
        {...axis, size: axisWidth, values: (plot, ticks) => ticks.map(tick => quantity(tick, unit))},
      ],
      series: [{label: "time", value: (plot, value) => quantity(value, "s", 9)}].concat(members.map((member, k) => ({
        label: data.signals[member].name,
        stroke: data.signals[member].colour || colours[k % colours.length],
        width: 1.5,
        pxAlign: 0,
        points: {show: false},
        value: plot => plot.cursor.left === null || plot.cursor.left < 0 ? "–"
          : quantity(valueAt(data.signals[member], plot.posToVal(plot.cursor.left, "x")), unit),
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
    const plot = new uPlot(options, [[whole.min, whole.max], ...members.map(() => [null, null])], element("panels"));
    plot.members = members;
    return plot;
  }

  // --- Traces ------------------------------------------------------------------------------------------------------

  const isSweep = Boolean(run.runs);
  const sizes = new Map();
  function sizeOf(signal) {
    if (!sizes.has(signal)) {
      const m = measure(signal, signal.begin, signal.end);
      sizes.set(signal, {size: Math.max(Math.abs(m.low), Math.abs(m.high)), swing: m.high - m.low});
    }
    return sizes.get(signal).size;
  }
  // Pulses at a node that is named like a gate.
  for (const signal of data.signals) {
    const flat = Array.from(signal.lengths).filter(digit => digit === "0").length;
    signal.isGate = !isSweep && signal.unit === "V" && 2 * flat >= signal.lengths.length && signal.lengths.length > 4 &&
      /^v\((.*[.:])?(g|gate|vg|clk|pwm|ctl|ctrl|drive)_?[a-z]?\d*[a-z]?\)$/i.test(signal.name);
  }
  const everyTrace = () => data.signals.map((signal, k) => k);
  let traces = new Set(everyTrace().filter(k => !data.signals[k].isGate));
  if (traces.size === 0) traces = new Set(everyTrace());

  function rebuildPlots() {
    for (const plot of plots.splice(0)) plot.destroy();
    const panels = isSweep ? data.panels : panelsByKind(data.signals, traces, sizeOf);
    // What swings widely would cover what does not: it is drawn first.
    const swing = member => { sizeOf(data.signals[member]); return sizes.get(data.signals[member]).swing; };
    for (const members of panels) plots.push(makePlot([...members].sort((a, b) => swing(b) - swing(a))));
    for (const plot of plots) drawPlot(plot);
    document.documentElement.dataset.plots = plots.length;
  }

  function showOnly(numbers) {
    traces = new Set(numbers);
    rebuildPlots();
    fillTraces();
    fillMeasurements();
    keepInAddress();
  }

  function fillTraces() {
    element("traces").hidden = isSweep;
    const wanted = element("trace-search").value.toLowerCase(), box = element("trace-list");
    box.replaceChildren();
    data.signals.forEach((signal, k) => {
      if (!signal.name.toLowerCase().includes(wanted)) return;
      const label = document.createElement("label"), check = document.createElement("input"), line = document.createElement("span");
      check.type = "checkbox";
      check.checked = traces.has(k);
      check.onchange = () => showOnly(check.checked ? [...traces, k] : [...traces].filter(each => each !== k));
      label.append(check, " " + signal.name);
      line.append(label, button("only", () => showOnly([k])));
      box.append(line);
    });
    element("trace-search").oninput = fillTraces;
    element("all-traces").onclick = () => showOnly(everyTrace());
    element("no-traces").onclick = () => showOnly([]);
    element("expression-form").onsubmit = event => {
      event.preventDefault();
      if (addExpression(element("expression").value)) keepInAddress();
    };
    const folded = data.signals.filter((signal, k) => signal.isGate && !traces.has(k)).length;
    element("trace-count").textContent = traces.size + " of " + data.signals.length + (folded ? ", gate signals folded away" : "");
  }

  function addExpression(text) {
    try {
      const made = expressionOf(text, data.signals.filter(signal => !signal.isDerived));
      if (made.signals.some(signal => signal.record !== made.signals[0].record)) throw new Error("its signals are of different runs");
      data.signals.push(derived(text, made.unit, made.signals, made.at));
      showOnly([...traces, data.signals.length - 1]);
      element("expression-error").textContent = "";
      return true;
    } catch (error) {
      element("expression-error").textContent = error.message;
      return false;
    }
  }

  // --- The address, keys, files ------------------------------------------------------------------------------------

  let isAddressKept = false;  // not before the one that the page was opened with is read
  function keepInAddress() {
    if (!isAddressKept) return;
    const kept = new URLSearchParams();
    if (visible.min !== whole.min || visible.max !== whole.max) { kept.set("from", visible.min); kept.set("to", visible.max); }
    for (const name of ["A", "B"]) if (cursors[name] !== null) kept.set(name, cursors[name]);
    for (const signal of data.signals) if (signal.isDerived) kept.append("expression", signal.name);
    if (!isSweep && traces.size < data.signals.length) kept.set("traces", [...traces].map(k => data.signals[k].name).join(";"));
    history.replaceState(null, "", "#" + kept);
  }

  // The next event behind a time, or the last before it.
  function nextEvent(time, forwards) {
    const all = data.marks.flatMap(marks => {
      const k = placeIn(marks.x, time);
      return [marks.x[k - 1], marks.x[k], marks.x[k + 1]];
    }).filter(candidate => candidate !== undefined && (forwards ? candidate > time : candidate < time));
    return all.length ? (forwards ? Math.min(...all) : Math.max(...all)) : time;
  }

  function useKey(event) {
    if (/^(INPUT|TEXTAREA)$/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = forwards => setCursor("A", nextEvent(cursors.A ?? visible.min, forwards));
    const keys = {ArrowLeft: () => shift(-0.25), ArrowRight: () => shift(0.25), "+": () => zoom(0.5), "-": () => zoom(2), Home: () => setRange(whole.min, whole.max),
      n: () => step(true), p: () => step(false), Escape: () => { setCursor("A", null); setCursor("B", null); }};
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  }

  function download(kind, blob) {
    const link = document.createElement("a");
    link.download = run.deck.replace(/.*\//, "").replace(/\.[^.]*$/, "") + "-view." + kind;
    link.href = URL.createObjectURL(blob);
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  // The shown traces at the edges of pieces, twice where one may jump, and at places between.
  function viewAsCsv() {
    const shown = isSweep ? data.signals : [...traces].map(k => data.signals[k]);
    const places = new Set(), count = columns();
    for (let k = 0; k <= count; ++k) places.add(visible.min + (visible.max - visible.min) * k / count);
    for (const signal of shown) for (const edge of signal.edges) if (edge >= visible.min && edge <= visible.max) places.add(edge);
    const quoted = text => /[",]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
    const lines = [["time", ...shown.map(signal => quoted(signal.name))].join(",")];
    for (const time of [...places].sort((a, b) => a - b)) lines.push([time, ...shown.map(signal => valueAt(signal, time) ?? "")].join(","));
    return lines.join("\n") + "\n";
  }

  // The plots one above the other, as they are drawn.
  function viewAsPicture() {
    const canvases = [...element("panels").querySelectorAll("canvas"), ...(data.marks.length + data.lanes.length ? [element("timeline")] : [])];
    const picture = document.createElement("canvas"), context = picture.getContext("2d");
    picture.width = Math.max(...canvases.map(canvas => canvas.width));
    picture.height = canvases.reduce((sum, canvas) => sum + canvas.height, 0);
    context.fillStyle = styled("--paper");
    context.fillRect(0, 0, picture.width, picture.height);
    let y = 0;
    for (const canvas of canvases) {
      context.drawImage(canvas, 0, y);
      y += canvas.height;
    }
    return picture;
  }

  function viewAsSvg() {
    const width = 900, height = 200, left = axisWidth, escaped = text => text.replace(/[&<>]/g, c => "&#" + c.charCodeAt(0) + ";");
    const parts = plots.map((plot, p) => {
      const {min, max} = plot.scales.y, top = p * (height + 40) + 20;
      const xOf = time => left + (width - left - 10) * (time - visible.min) / (visible.max - visible.min);
      const yOf = value => top + height * (max - value) / (max - min);
      const labels = [[max, top + 12], [min, top + height]].map(([value, y]) => `<text x="${left - 6}" y="${y}" text-anchor="end">${quantity(value, data.signals[plot.members[0]].unit)}</text>`);
      const curves = plot.members.map((member, k) => {
        const colour = data.signals[member].colour || colours[k % colours.length];
        const points = plot.data[0].map((time, i) => plot.data[k + 1][i] === null ? "" : xOf(time).toFixed(1) + "," + yOf(plot.data[k + 1][i]).toFixed(1)).join(" ");
        return `<polyline fill="none" stroke="${colour}" points="${points}"/><text x="${left + 8 + 130 * k}" y="${top - 5}" fill="${colour}">${escaped(data.signals[member].name)}</text>`;
      });
      return `<rect x="${left}" y="${top}" width="${width - left - 10}" height="${height}" fill="none" stroke="#999"/>` + labels.join("") + curves.join("");
    });
    const bottom = plots.length * (height + 40);
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${bottom + 20}" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="#fff"/>` +
      parts.join("") + `<text x="${left}" y="${bottom + 10}">${quantity(visible.min, "s", 9)}</text><text x="${width - 10}" y="${bottom + 10}" text-anchor="end">${quantity(visible.max, "s", 9)}</text></svg>\n`;
  }

  // --- Overview: the whole run, with what is visible of it -----------------------------------------------------------

  function drawOverview() {
    const canvas = element("overview"), width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * devicePixelRatio;
    canvas.height = height * devicePixelRatio;
    const first = plots.length ? data.signals[plots[0].members[0]] : null;
    if (!first || width <= axisWidth) return;
    const context = canvas.getContext("2d"), inner = width - axisWidth - 16, values = columnsOf(first, whole.min, whole.max, inner);
    const known = values.filter(value => value !== null), low = known.reduce((a, b) => Math.min(a, b), Infinity), high = known.reduce((a, b) => Math.max(a, b), -Infinity);
    context.scale(devicePixelRatio, devicePixelRatio);
    context.strokeStyle = styled("--grey");
    context.beginPath();
    values.forEach((value, k) => { if (value !== null) context.lineTo(axisWidth + k / 4, 3 + (height - 6) * (high === low ? 0.5 : (high - value) / (high - low))); });
    context.stroke();
    const xOf = time => axisWidth + inner * (time - whole.min) / (whole.max - whole.min);
    context.fillStyle = styled("--window");
    context.fillRect(xOf(visible.min), 0, Math.max(2, xOf(visible.max) - xOf(visible.min)), height);
  }

  function listenToOverview() {
    const canvas = element("overview");
    const go = event => {
      const box = canvas.getBoundingClientRect(), half = (visible.max - visible.min) / 2;
      const time = whole.min + (whole.max - whole.min) * (event.clientX - box.left - axisWidth) / (canvas.clientWidth - axisWidth - 16);
      const middle = Math.min(Math.max(time, whole.min + half), whole.max - half);
      setRange(middle - half, middle + half);
    };
    canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); go(event); });
    canvas.addEventListener("pointermove", event => { if (event.buttons) go(event); });
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
      context.fillStyle = colour || styled("--ink");
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

  function fillMeasurements() {
    const both = cursors.A !== null && cursors.B !== null && cursors.A !== cursors.B;
    const begin = Math.min(...data.signals.map(signal => signal.begin)), end = Math.max(...data.signals.map(signal => signal.end));
    const from = knownTime(Math.max(both ? Math.min(cursors.A, cursors.B) : visible.min, begin));
    const to = knownTime(Math.min(both ? Math.max(cursors.A, cursors.B) : visible.max, end));
    const parts = [];
    for (const name of ["A", "B"]) if (cursors[name] !== null) parts.push(name + " = " + quantity(cursors[name], "s", 9));
    if (both) parts.push("B − A = " + quantity(cursors.B - cursors.A, "s", 9), "1/|B − A| = " + quantity(1 / (to - from), "Hz"));
    parts.push((both ? "between the cursors" : "visible") + ": " + quantity(from, "s", 9) + " to " + quantity(to, "s", 9));
    element("window").textContent = parts.join(";  ");
    const table = element("measurements");
    table.replaceChildren();
    row(table, ["signal", "at A", "at B", "B − A", "minimum", "maximum", "peak to peak", "mean", "RMS"], "th");
    if (to <= from) return;
    for (const signal of isSweep ? data.signals : data.signals.filter((each, k) => traces.has(k))) {
      const at = name => cursors[name] === null ? null : valueAt(signal, cursors[name]);
      const a = at("A"), b = at("B");
      const own = {from: Math.max(from, signal.begin), to: Math.min(to, signal.end)};
      if (own.to <= own.from) continue;
      const m = measure(signal, own.from, own.to);
      const numbers = [a, b, a === null || b === null ? null : b - a, m.low, m.high, m.high - m.low, m.mean, m.rms];
      const line = row(table, [signal.name, ...numbers.map(number => quantity(number, signal.unit))]);
      numbers.forEach((number, k) => { if (number !== null) line.children[k + 1].title = number; });
    }
  }

  function fillWaveforms() {
    if (data.signals.length === 0 || data.signals.every(signal => signal.edges.length < 2)) return;
    show("waveforms");
    rebuildPlots();
    fillTraces();
    const canvas = element("timeline");
    const timeAt = event => {
      const box = canvas.getBoundingClientRect(), width = canvas.clientWidth - axisWidth - 16;
      return visible.min + (visible.max - visible.min) * (event.clientX - box.left - axisWidth) / width;
    };
    listen(canvas, timeAt);
    const ports = data.ports > data.lanes.length ? " The first " + data.lanes.length + " of " + data.ports + " ports are shown." : "";
    const ticks = data.marksTitle && data.marks.length ? "A line a run, with a tick where " + data.marksTitle + "; pale where ticks are too many to be told apart." : "";
    element("timeline-hint").textContent = data.lanes.length ? "Filled: the diode or switch conducts; a shade: for that share of the time." + ports : ticks;
    element("measurement-hint").textContent = "Exact, not of rows: hold the pointer over a number for all its digits." + (data.thinned
      ? " The run has more events than this page keeps. Before t = " + quantity(detailFrom, "s", 9) +
        " the curves show the extremes of each short piece of time, and windows begin and end between two of these."
      : "");
    element("whole").onclick = () => setRange(whole.min, whole.max);
    element("in").onclick = () => zoom(0.5);
    element("out").onclick = () => zoom(2);
    element("left").onclick = () => shift(-0.25);
    element("right").onclick = () => shift(0.25);
    element("clear").onclick = () => { setCursor("A", null); setCursor("B", null); };
    darkMode.addEventListener("change", () => { colours = darkMode.matches ? coloursOnDark : coloursOnLight; rebuildPlots(); });
    element("csv").onclick = () => download("csv", new Blob([viewAsCsv()], {type: "text/csv"}));
    element("svg").onclick = () => download("svg", new Blob([viewAsSvg()], {type: "image/svg+xml"}));
    element("png").onclick = () => viewAsPicture().toBlob(blob => download("png", blob));
    addEventListener("keydown", useKey);
    listenToOverview();
    addEventListener("resize", () => {
      drawOverview();
      for (const plot of plots) plot.setSize({width: element("panels").clientWidth, height: 240});
      drawTimeline();
    });
    showWanted();
  }

  // report.html#from=1e-3&to=2e-3&A=1.1e-3&B=1.5e-3 opens at that view.
  function showWanted() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const number = (name, otherwise) => wanted.has(name) && Number.isFinite(Number(wanted.get(name))) ? Number(wanted.get(name)) : otherwise;
    for (const text of wanted.getAll("expression")) addExpression(text);
    if (wanted.has("traces")) {
      const names = wanted.get("traces").split(";");
      showOnly(data.signals.map((signal, k) => k).filter(k => names.includes(data.signals[k].name)));
    }
    for (const name of ["A", "B"]) setCursor(name, number(name, null));
    setRange(number("from", whole.min), number("to", whole.max));
    isAddressKept = true;
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
