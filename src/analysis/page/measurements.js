// Statistics of the traces over the window or between the cursors, exact.
function fillMeasurements() {
  const {isBetween, from, to} = measuredWindow();
  const parts = [];
  for (const name of ["A", "B"]) if (cursors[name] !== null) parts.push(name + " = " + quantity(cursors[name], "s", 9));
  if (isBetween) parts.push("B − A = " + quantity(cursors.B - cursors.A, "s", 9), "1/|B − A| = " + quantity(1 / (to - from), "Hz"));
  parts.push((isBetween ? "between the cursors" : "visible") + ": " + quantity(from, "s", 9) + " to " + quantity(to, "s", 9));
  element("window").textContent = parts.join(";  ");
  const table = element("measurements");
  table.replaceChildren();
  row(table, ["signal", "at A", "at B", "B − A", "minimum", "maximum", "peak to peak", "mean", "RMS"], "th");
  if (to <= from) return;
  for (const signal of data.signals.filter((each, k) => traces.has(k))) {
    const at = name => cursors[name] === null ? null : valueAt(signal, cursors[name]);
    const a = at("A"), b = at("B");
    const own = {from: Math.max(from, signal.exactFrom), to: Math.min(to, signal.end)};
    if (own.to <= own.from) continue;
    const m = measure(signal, own.from, own.to);
    const numbers = [a, b, a === null || b === null ? null : b - a, m.low, m.high, m.high - m.low, m.mean, m.rms];
    const rounding = 1e-13 * extentOf(signal).size;  // below it a number is none
    const line = row(table, [signal.name, ...numbers.map(number => quantity(number !== null && Math.abs(number) < rounding ? 0 : number, signal.unit))]);
    numbers.forEach((number, k) => { if (number !== null) line.children[k + 1].title = number; });
  }
}
