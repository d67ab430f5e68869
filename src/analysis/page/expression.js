// A signal made of others, "v(a)*i(R1)": + - * / ** ( ), numbers, abs, sqrt, min, max. Throws where the text is none.
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
  const functions = {
    abs: items => ({at: v => Math.abs(items[0].at(v)), unit: items[0].unit}),
    sqrt: items => ({at: v => Math.sqrt(items[0].at(v)), unit: ""}),
    min: items => ({at: v => Math.min(...items.map(item => item.at(v))), unit: same(items)}),
    max: items => ({at: v => Math.max(...items.map(item => item.at(v))), unit: same(items)}),
  };
  function atom() {
    const name = names.find(each => rest.toLowerCase().startsWith(each.toLowerCase()));
    if (name) {
      rest = rest.slice(name.length).trimStart();
      const signal = signals.find(each => each.name === name);
      if (!used.has(signal)) used.set(signal, used.size);
      const place = used.get(signal);
      return {at: v => v[place], unit: signal.unit};
    }
    const number = take(/^(\d+\.?\d*|\.\d+)(e[+-]?\d+)?/i);
    if (number !== null) return {at: () => Number(number), unit: "1"};
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
    if (rest.startsWith("-")) { expect("-"); const item = signed(); return {at: v => -item.at(v), unit: item.unit}; }
    const base = atom();
    if (!rest.startsWith("**")) return base;
    expect("*"); expect("*");
    const power = signed();
    return {at: v => base.at(v) ** power.at(v), unit: ""};
  }
  function product() {
    let left = signed();
    while (/^[*\/]/.test(rest)) {
      const times = rest[0] === "*";
      expect(rest[0]);
      const a = left, b = signed(), units = [a.unit, b.unit].sort().join();
      const plain = b.unit === "1" ? a.unit : times && a.unit === "1" ? b.unit : null;
      left = {at: times ? v => a.at(v) * b.at(v) : v => a.at(v) / b.at(v), unit: plain ?? (times && units === "A,V" ? "W" : !times && a.unit === b.unit ? "1" : "")};
    }
    return left;
  }
  function sum() {
    let left = product();
    while (/^[+-]/.test(rest)) {
      const plus = rest[0] === "+";
      expect(rest[0]);
      const a = left, b = product();
      left = {at: plus ? v => a.at(v) + b.at(v) : v => a.at(v) - b.at(v), unit: same([a, b])};
    }
    return left;
  }
  const {at, unit} = sum();
  if (rest) throw new Error("cannot read '" + rest + "'");
  if (!used.size) throw new Error("it holds no signal");
  return {at, unit: unit === "1" ? "" : unit, signals: [...used.keys()]};
}
