// The whole run as a strip, with what is visible of it.
function drawOverview() {
  const canvas = element("overview"), width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * devicePixelRatio;
  canvas.height = height * devicePixelRatio;
  const first = plots.length ? data.signals[plots[0].members[0]] : null;
  if (!first || width <= axisWidth()) return;
  const context = canvas.getContext("2d"), inner = width - axisWidth() - rightMargin(), values = columnsOf(first, whole.min, whole.max, inner);
  const known = values.filter(value => value !== null), low = known.reduce((a, b) => Math.min(a, b), Infinity), high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  context.scale(devicePixelRatio, devicePixelRatio);
  context.strokeStyle = styled("--grey");
  context.beginPath();
  values.forEach((value, k) => { if (value !== null) context.lineTo(axisWidth() + k / 4, 3 + (height - 6) * (high === low ? 0.5 : (high - value) / (high - low))); });
  context.stroke();
  const xOf = time => axisWidth() + inner * (time - whole.min) / (whole.max - whole.min);
  context.fillStyle = styled("--window");
  context.fillRect(xOf(visible.min), 0, Math.max(2, xOf(visible.max) - xOf(visible.min)), height);
}

function listenToOverview() {
  const canvas = element("overview");
  const go = event => {
    const box = canvas.getBoundingClientRect(), half = (visible.max - visible.min) / 2;
    const time = whole.min + (whole.max - whole.min) * (event.clientX - box.left - axisWidth()) / (canvas.clientWidth - axisWidth() - rightMargin());
    const middle = Math.min(Math.max(time, whole.min + half), whole.max - half);
    setRange(middle - half, middle + half);
  };
  canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); go(event); });
  canvas.addEventListener("pointermove", event => { if (event.buttons) go(event); });
}
