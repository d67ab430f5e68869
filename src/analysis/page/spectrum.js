// The spectrum of the traces: exact harmonics over the last whole periods of the window, or of the time between the cursors.
const mostSpectra = 6;

function frequencyAtFirst(from, to) {
  const declared = run.fourier?.find(result => result.harmonics.length > 1)?.harmonics[1].frequency;
  const period = repeatOfEvents(from, to);
  return declared ?? (period ? Number((1 / period).toPrecision(9)) : Number((1 / (to - from)).toPrecision(9)));
}

// The window, its frequency and the signals; a text where there is none.
function spectrumRequest() {
  const shown = measuredWindow(), from = Math.max(shown.from, detailFrom), to = shown.to;
  const text = element("fundamental").value.trim(), frequency = text ? Number(text) : frequencyAtFirst(from, to);
  const count = Math.max(1, Math.min(1000, Math.round(Number(element("harmonics").value)) || 40));
  if (!(frequency > 0)) return "The fundamental frequency is a positive number of Hz.";
  const periods = Math.floor((to - from) * frequency * (1 + 1e-9));
  if (periods < 1) return "The window is shorter than one period of " + quantity(frequency, "Hz") + ".";
  const signals = data.signals.filter((signal, k) => traces.has(k) && signal.end >= to).slice(0, mostSpectra);
  return signals.length ? {frequency, count, periods, from: Math.max(to - periods / frequency, from), to, signals} : "No trace is shown over this window.";
}

function drawSpectrum(request, spectra) {
  const isDecibel = element("decibel").checked, floor = 1e-6;
  const largest = Math.max(...spectra.flat().map(each => Math.abs(each.magnitude)), 1e-300);
  const heightOf = value => isDecibel ? 20 * Math.log10(Math.max(Math.abs(value), floor * largest)) : Math.abs(value);
  const units = new Set(request.signals.map(signal => signal.unit)), unit = isDecibel ? "dB" : units.size === 1 ? [...units][0] : "";
  const top = heightOf(largest), y = isDecibel ? {min: top - 120, max: top + 6, text: tick => tick + " dB"} : {min: 0, max: 1.06 * top, unit};
  const x = {min: -request.frequency / 2, max: (request.count + 0.5) * request.frequency, unit: "Hz"};
  drawChart(element("spectrum-chart"), x, y, (context, xOf, yOf) => {
    const slot = (xOf(request.frequency) - xOf(0)) * 0.8, width = slot / spectra.length;
    spectra.forEach((harmonics, s) => {
      context.fillStyle = colours[s % colours.length];
      harmonics.forEach((each, k) => {
        const height = yOf(y.min) - yOf(heightOf(each.magnitude));
        context.fillRect(xOf(k * request.frequency) - slot / 2 + s * width, yOf(y.min) - height, Math.max(width, 1), height);
      });
    });
  });
  fillLegend(element("spectrum-legend"), request.signals.map((signal, s) => [signal.name, colours[s % colours.length]]));
}

function fillSpectrumTable(request, spectra) {
  const table = element("spectrum-table"), distortion = harmonics => Math.sqrt(harmonics.slice(2).reduce((sum, each) => sum + each.magnitude ** 2, 0));
  table.replaceChildren();
  row(table, ["frequency", ...request.signals.flatMap(signal => [signal.name, "phase"])], "th");
  for (let k = 0; k <= request.count; ++k) {
    const line = row(table, [quantity(k * request.frequency, "Hz", 9), ...spectra.flatMap((harmonics, s) =>
      [quantity(harmonics[k].magnitude, request.signals[s].unit), k ? quantity(harmonics[k].phase, "") + "°" : "–"])]);
    spectra.forEach((harmonics, s) => { line.children[1 + 2 * s].title = harmonics[k].magnitude; line.children[2 + 2 * s].title = harmonics[k].phase; });
  }
  row(table, ["THD of these", ...spectra.flatMap(harmonics => [quantity(100 * distortion(harmonics) / harmonics[1].magnitude, "%"), ""])]);
}

function fillSpectrum() {
  if (!element("spectrum").open) return;
  const request = spectrumRequest(), isPossible = typeof request !== "string";
  for (const id of ["spectrum-chart", "spectrum-table", "spectrum-legend"]) element(id).hidden = !isPossible;
  element("spectrum-hint").textContent = isPossible
    ? "Exact Fourier coefficients over " + request.periods + (request.periods === 1 ? " period" : " periods") + " of " + quantity(request.frequency, "Hz", 9) + ", " +
      quantity(request.from, "s", 9) + " to " + quantity(request.to, "s", 9) + "; phases are those of A sin(ωt + φ) from its begin."
    : request;
  if (!isPossible) return;
  const spectra = request.signals.map(signal => harmonicsOf(signal, request.from, request.to, request.frequency, request.count));
  drawSpectrum(request, spectra);
  fillSpectrumTable(request, spectra);
}

function listenToSpectrum() {
  element("spectrum").addEventListener("toggle", () => { fillSpectrum(); keepInAddress(); });
  for (const id of ["fundamental", "harmonics", "decibel"]) element(id).addEventListener("change", () => { fillSpectrum(); keepInAddress(); });
  whenViewChanges(() => soon(fillSpectrum));
}

function keepSpectrum(kept) {
  if (!element("spectrum").open) return;
  kept.set("spectrum", element("fundamental").value);
  kept.set("harmonics", element("harmonics").value);
  if (element("decibel").checked) kept.set("dB", "1");
}

function showWantedSpectrum(wanted) {
  if (!wanted.has("spectrum")) return;
  element("fundamental").value = wanted.get("spectrum");
  if (wanted.has("harmonics")) element("harmonics").value = wanted.get("harmonics");
  element("decibel").checked = wanted.has("dB");
  element("spectrum").open = true;
  fillSpectrum();
}
