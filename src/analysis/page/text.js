// Numbers as text, and small parts of the page.
const element = id => document.getElementById(id);
const show = id => { element(id).hidden = false; };
const styled = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

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

// Labels of ticks that lie so close that six digits do not tell them apart count from the first.
function tickTexts(ticks, unit) {
  const mostDigits = 6, step = ticks.length > 1 ? ticks[1] - ticks[0] : 0;
  const largest = Math.max(...ticks.map(Math.abs));
  const isClose = step > 0 && Math.floor(Math.log10(largest)) - Math.floor(Math.log10(step)) >= mostDigits;
  return ticks.map((tick, k) => isClose && k > 0 ? "+" + quantity(tick - ticks[0], unit, 3) : quantity(tick, unit, mostDigits));
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
