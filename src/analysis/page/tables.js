// What is known of the run besides its waveforms, as tables.
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
