// What a function of values between bounds [low, high] lies between; without bound where that is not known.
const bounds = {
  unknown: [-Infinity, Infinity],
  negative: ([a, b]) => [-b, -a],
  sum: ([a, b], [c, d]) => [a + c, b + d],
  product: (one, other) => bounds.ofCorners(one, other, (x, y) => x * y),
  quotient: (one, [c, d]) => c <= 0 && d >= 0 ? bounds.unknown : bounds.product(one, [1 / d, 1 / c]),
  power([a, b], [c, d]) {
    if (a > 0 || (a === 0 && c > 0)) return bounds.ofCorners([a, b], [c, d], (x, y) => x ** y);
    if (c !== d || !Number.isInteger(c) || c < 0) return bounds.unknown;
    return c % 2 ? [a ** c, b ** c] : bounds.power(bounds.size([a, b]), [c, d]);
  },
  size: ([a, b]) => a <= 0 && b >= 0 ? [0, Math.max(-a, b)] : [Math.min(Math.abs(a), Math.abs(b)), Math.max(Math.abs(a), Math.abs(b))],
  ofCorners([a, b], [c, d], act) {
    const corners = [act(a, c), act(a, d), act(b, c), act(b, d)];
    return [Math.min(...corners), Math.max(...corners)];
  },
};

// A signal made of others, "v(a)*i(R1)": + - * / ** ( ), numbers, abs, sqrt, min, max. Throws where the text is none. `at` makes its value of values of
// `signals`, `within` its bounds of theirs.
function expressionOf(text, signals) {
  const names = signals.map(signal => signal.name).sort((a, b) => b.length - a.length);
  let rest = text.trim();
  const used = new Map();
  const take = pattern => {
    const found = rest.match(pattern);
    if (!found) return null;
    rest = rest.slice(found[0].length).trimStart();
    return found[0].trim();
  };
  const expect = mark => { if (!rest.startsWith(mark)) throw new Error("expected " + mark + " at '" + rest + "'"); rest = rest.slice(1).trimStart(); };
  const list = () => {
    const items = [sum()];
    while (rest.startsWith(",")) { expect(","); items.push(sum()); }
    return items;
  };
  const same = items => items.every(item => item.unit === items[0].unit) ? items[0].unit : "";
  const ends = (items, v, pick) => [0, 1].map(end => pick(...items.map(item => item.within(v)[end])));
  const functions = {
    abs: items => ({at: v => Math.abs(items[0].at(v)), within: v => bounds.size(items[0].within(v)), unit: items[0].unit}),
    sqrt: items => ({at: v => Math.sqrt(items[0].at(v)), within: v => items[0].within(v).map(bound => Math.sqrt(Math.max(bound, 0))), unit: ""}),
    min: items => ({at: v => Math.min(...items.map(item => item.at(v))), within: v => ends(items, v, Math.min), unit: same(items)}),
    max: items => ({at: v => Math.max(...items.map(item => item.at(v))), within: v => ends(items, v, Math.max), unit: same(items)}),
  };
  function atom() {
    const name = names.find(each => rest.toLowerCase().startsWith(each.toLowerCase()));
    if (name) {
      rest = rest.slice(name.length).trimStart();
      const signal = signals.find(each => each.name === name);
      if (!used.has(signal)) used.set(signal, used.size);
      const place = used.get(signal);
      return {at: v => v[place], within: v => v[place], unit: signal.unit};
    }
    const number = take(/^(\d+\.?\d*|\.\d+)(e[+-]?\d+)?/i);
    if (number !== null) return {at: () => Number(number), within: () => [Number(number), Number(number)], unit: "1"};
    const call = take(/^(abs|sqrt|min|max)\s*(?=\()/i);
    if (rest.startsWith("(")) {
      expect("(");
      const items = list();
      expect(")");
      return call ? functions[call.toLowerCase()](items) : items[0];
    }
    throw new Error("no signal or number at '" + rest + "'");
  }
  function signed() {
    if (rest.startsWith("-")) { expect("-"); const item = signed(); return {at: v => -item.at(v), within: v => bounds.negative(item.within(v)), unit: item.unit}; }
    const base = atom();
    if (!rest.startsWith("**")) return base;
    expect("*"); expect("*");
    const power = signed();
    return {at: v => base.at(v) ** power.at(v), within: v => bounds.power(base.within(v), power.within(v)), unit: ""};
  }
  function product() {
    let left = signed();
    while (/^[*\/]/.test(rest)) {
      const times = rest[0] === "*";
      expect(rest[0]);
      const a = left, b = signed(), units = [a.unit, b.unit].sort().join();
      const plain = b.unit === "1" ? a.unit : times && a.unit === "1" ? b.unit : null;
      left = {at: times ? v => a.at(v) * b.at(v) : v => a.at(v) / b.at(v), within: v => bounds[times ? "product" : "quotient"](a.within(v), b.within(v)),
        unit: plain ?? (times && units === "A,V" ? "W" : !times && a.unit === b.unit ? "1" : "")};
    }
    return left;
  }
  function sum() {
    let left = product();
    while (/^[+-]/.test(rest)) {
      const plus = rest[0] === "+";
      expect(rest[0]);
      const a = left, b = product();
      left = {at: plus ? v => a.at(v) + b.at(v) : v => a.at(v) - b.at(v), within: v => bounds.sum(a.within(v), plus ? b.within(v) : bounds.negative(b.within(v))),
        unit: same([a, b])};
    }
    return left;
  }
  const {at, within, unit} = sum();
  if (rest) throw new Error("cannot read '" + rest + "'");
  if (!used.size) throw new Error("it holds no signal");
  return {at, within, unit: unit === "1" ? "" : unit, signals: [...used.keys()]};
}
