// Puts the page together.
function redrawAll() {
  for (const plot of plots) plot.setSize({width: element("panels").clientWidth, height: plotHeight});
  for (const plot of plots) drawPlot(plot);
  tellChange();
  drawSweepCharts();
}

function fillHints() {
  const ports = data.ports > data.lanes.length ? " The first " + data.lanes.length + " of " + data.ports + " ports are shown." : "";
  const ticks = data.marksTitle && data.marks.length ? "One line per run, with a tick where " + data.marksTitle + "; a pale bar where ticks are too dense." : "";
  element("timeline-hint").textContent = data.lanes.length ? "Filled: the diode or switch conducts; a shade: its share of the time." + ports : ticks;
  element("measurement-hint").textContent = "Exact, independent of the rows; hold the pointer over a number to see all its digits." + (data.thinned
    ? " The run has more events than this page keeps. Before t = " + quantity(detailFrom, "s", 9) +
      " the curves show the extremes of short time intervals, and windows begin and end at interval boundaries. Expressions lie between the drawn bounds there; their statistics are of the time after it."
    : "");
}

function listenToButtons() {
  const acts = {
    whole: showWhole, in: () => zoom(0.5), out: () => zoom(2), left: () => shift(-0.25), right: () => shift(0.25), clear: clearCursors,
    csv: () => download("csv", new Blob([viewAsCsv()], {type: "text/csv"})),
    svg: () => download("svg", new Blob([viewAsSvg()], {type: "image/svg+xml"})),
    png: () => download("png", new Blob([bytesOf(viewAsPicture().toDataURL("image/png"))], {type: "image/png"})),
  };
  for (const [id, act] of Object.entries(acts)) element(id).onclick = act;
}

function fillWaveforms() {
  if (data.signals.length === 0 || data.signals.every(signal => signal.edges.length < 2)) return;
  show("waveforms");
  traces = new Set(tracesAtFirst());
  for (const act of [drawTimeline, drawOverview, fillMeasurements, keepInAddress]) whenViewChanges(act);
  rebuildPlots();
  fillTraces();
  fillHints();
  listenToTraces();
  element("internals-line").hidden = !data.lanes.some(isInternal);
  element("internals").onchange = drawTimeline;
  listenToTimeline(element("timeline"));
  listenToOverview();
  listenToButtons();
  listenToSpectrum();
  listenToXy();
  addEventListener("keydown", useKey);
  addEventListener("resize", () => soon(redrawAll));
  isNarrow.addEventListener("change", rebuildPlots);
  darkMode.addEventListener("change", () => {
    colours = darkMode.matches ? coloursOnDark : coloursOnLight;
    rebuildPlots();
    redrawAll();
  });
  showWanted();
}

function fillHeader() {
  element("title").textContent = document.title = run.title || run.deck;
  const parts = [run.deck];
  if (run.output) parts.push(run.output.rows + " rows to t = " + quantity(run.output.end, "s") + " in " + run.output.file);
  if (run.stats) parts.push(run.stats.engine + " engine", run.stats.events + " events", run.stats.modes_visited + " modes");
  element("summary").textContent = parts.join(" · ");
  const errors = run.notes.filter(note => note.includes("error["));
  if (errors.length === 0) return;
  element("failure").textContent = errors.join("\n");
  show("failure");
}

fillHeader();
fillSweepCharts();
fillWaveforms();
startSchematic();
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
