// The view in the address, so that it can be shared: report.html#from=1e-3&to=2e-3&A=1.1e-3&B=1.5e-3 opens there.
let isAddressKept = false;  // not before the one that the page was opened with is read

function keepInAddress() {
  if (!isAddressKept) return;
  const kept = new URLSearchParams();
  if (visible.min !== whole.min || visible.max !== whole.max) { kept.set("from", visible.min); kept.set("to", visible.max); }
  plots.forEach((plot, k) => { if (plot.yWindow) kept.append("y", [k, plot.yWindow.min, plot.yWindow.max].join(":")); });
  for (const name of ["A", "B"]) if (cursors[name] !== null) kept.set(name, cursors[name]);
  for (const signal of data.signals) if (signal.isDerived) kept.append("expression", signal.name);
  const first = tracesAtFirst();
  if (traces.size !== first.length || first.some(k => !traces.has(k))) kept.set("traces", [...traces].map(k => data.signals[k].name).join(";"));
  keepSpectrum(kept);
  keepXy(kept);
  history.replaceState(null, "", "#" + kept);
}

function showWanted() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const number = (name, otherwise) => wanted.has(name) && Number.isFinite(Number(wanted.get(name))) ? Number(wanted.get(name)) : otherwise;
  for (const text of wanted.getAll("expression")) addExpression(text);
  if (wanted.has("traces")) {
    const names = wanted.get("traces").split(";");
    showOnly(data.signals.map((signal, k) => k).filter(k => names.includes(data.signals[k].name)));
  }
  for (const text of wanted.getAll("y")) {
    const [place, min, max] = text.split(":").map(Number);
    if (plots[place] && min < max) plots[place].yWindow = {min, max};
  }
  for (const name of ["A", "B"]) setCursor(name, number(name, null));
  setRange(number("from", whole.min), number("to", whole.max));
  showWantedSpectrum(wanted);
  showWantedXy(wanted);
  isAddressKept = true;
}
