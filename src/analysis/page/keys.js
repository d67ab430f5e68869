// The keyboard.
function stepCursor(name, forwards) {
  const time = nextEvent(cursors[name] ?? visible.min, forwards);
  setCursor(name, time);
  if (time < visible.min || time > visible.max) moveTo(time - (visible.max - visible.min) / 2);
}

const keys = {
  ArrowLeft: () => shift(-0.25), ArrowRight: () => shift(0.25), "+": () => zoom(0.5), "-": () => zoom(2), Home: showWhole,
  n: () => stepCursor("A", true), p: () => stepCursor("A", false), N: () => stepCursor("B", true), P: () => stepCursor("B", false),
  Escape: clearCursors,
};

function useKey(event) {
  if (/^(INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
}
