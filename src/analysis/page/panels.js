// Panels of traces by unit and size: outputs and currents of inductors first, gates last.
function panelsByKind(signals, numbers, sizeOf) {
  const mostCurves = 6, ratio = 20;
  const rank = signal => signal.isGate ? 3 : /out/i.test(signal.name) || signal.isDerived ? 0 : /^i\((.*[.:])?l/i.test(signal.name) ? 1 : 2;
  const sorted = [...numbers].sort((a, b) => rank(signals[a]) - rank(signals[b]) || a - b);
  const panels = [];
  for (const number of sorted) {
    const signal = signals[number], size = sizeOf(signal);
    const fits = panel => panel.unit === signal.unit && panel.isGate === !!signal.isGate && panel.members.length < mostCurves &&
      (size === 0 || panel.size === 0 || (size <= ratio * panel.size && panel.size <= ratio * size));
    const panel = panels.find(fits) ?? panels[panels.push({unit: signal.unit, isGate: !!signal.isGate, size, members: []}) - 1];
    panel.members.push(number);
    panel.size = Math.max(panel.size, size);
  }
  return panels.map(panel => panel.members);
}
