// Which traces are drawn: a list to search, add, remove and isolate, and expressions of traces.

// Pulses at a node that is named like a gate.
for (const signal of data.signals) {
  const flat = Array.from(signal.lengths).filter(digit => digit === "0").length;
  signal.isGate = !isSweep && signal.unit === "V" && 2 * flat >= signal.lengths.length && signal.lengths.length > 4 &&
    /^v\((.*[.:])?(g|gate|vg|clk|pwm|ctl|ctrl|drive)_?[a-z]?\d*[a-z]?\)$/i.test(signal.name);
}

const everyTrace = () => data.signals.map((signal, k) => k);

// Without gate signals and those that only the schematic needs; of a sweep the first few signals, each of all its runs.
function tracesAtFirst() {
  const mostPanels = 4;
  if (isSweep) return data.panels.slice(0, mostPanels).flat();
  const found = everyTrace().filter(k => k < data.saved && !data.signals[k].isGate && !data.signals[k].isDerived);
  return found.length ? found : everyTrace();
}

function showOnly(numbers) {
  traces = new Set(numbers);
  rebuildPlots();
  fillTraces();
  tellChange();
}

function traceLine(text, members) {
  const label = document.createElement("label"), check = document.createElement("input"), line = document.createElement("span");
  const shown = members.filter(member => traces.has(member)).length;
  check.type = "checkbox";
  check.checked = shown > 0;
  check.indeterminate = shown > 0 && shown < members.length;
  check.onchange = () => showOnly(check.checked ? [...traces, ...members] : [...traces].filter(each => !members.includes(each)));
  label.append(check, " " + text);
  const only = button("only", () => showOnly(members));
  only.setAttribute("aria-label", "only " + text);
  line.append(label, only);
  return line;
}

// What the list offers, as names and the traces they stand for: signals; of a sweep signals of all runs, and runs.
function listedTraces() {
  if (!isSweep) return [data.signals.map((signal, k) => [signal.name, [k]])];
  const shownSignals = data.panels.filter(members => members.some(member => traces.has(member)));
  const runs = data.runNames.map((name, r) => [name, (shownSignals.length ? shownSignals : data.panels).map(members => members[r])]);
  return [data.panels.map((members, k) => [data.quantities[k], members]), runs];
}

function fillTraces() {
  const wanted = element("trace-search").value.toLowerCase(), box = element("trace-list");
  box.replaceChildren();
  for (const group of listedTraces()) {
    const part = document.createElement("div");
    for (const [name, members] of group) if (name.toLowerCase().includes(wanted)) part.append(traceLine(name, members));
    box.append(part);
  }
  const folded = data.signals.filter((signal, k) => signal.isGate && !traces.has(k)).length;
  element("trace-count").textContent = traces.size + " of " + data.signals.length + (folded ? ", gate signals folded away" : "");
}

function addExpression(text) {
  try {
    const made = expressionOf(text, data.signals.filter(signal => !signal.isDerived));
    if (made.signals.some(signal => signal.record !== made.signals[0].record)) throw new Error("its signals are of different runs");
    data.signals.push(derived(text, made.unit, made.signals, made));
    showOnly([...traces, data.signals.length - 1]);
    element("expression-error").textContent = "";
    return true;
  } catch (error) {
    element("expression-error").textContent = error.message;
    return false;
  }
}

function listenToTraces() {
  element("trace-search").oninput = fillTraces;
  element("all-traces").onclick = () => showOnly(everyTrace());
  element("no-traces").onclick = () => showOnly([]);
  element("expression-form").hidden = isSweep;
  element("expression-form").onsubmit = event => {
    event.preventDefault();
    addExpression(element("expression").value);
  };
}
