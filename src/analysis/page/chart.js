// A chart on a canvas: frame, ticks with units, and what a function draws in it.

// At most so many round numbers from min to max.
function ticksOf(min, max, most) {
  const rough = (max - min) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(each => each >= rough * (1 - 1e-9));
  const ticks = [];
  for (let k = Math.ceil(min / step - 1e-9); k * step <= max + 1e-9 * step; ++k) ticks.push(k * step);
  return ticks;
}

// Room around the least and the largest of some values.
function scaleOf(values, unit, share = 0.06) {
  let min = Infinity, max = -Infinity;
  for (const value of values) if (Number.isFinite(value)) { min = Math.min(min, value); max = Math.max(max, value); }
  if (!(min <= max)) [min, max] = [0, 1];
  const room = max > min ? share * (max - min) : Math.abs(max) || 1;
  return {min: min - room, max: max + room, unit};
}

function drawGrid(context, box, x, y, xOf, yOf) {
  context.strokeStyle = styled("--grid");
  context.fillStyle = styled("--ink");
  context.font = axisFont();
  context.textAlign = "center";
  context.textBaseline = "top";
  const line = (fromX, fromY, toX, toY) => { context.beginPath(); context.moveTo(fromX, fromY); context.lineTo(toX, toY); context.stroke(); };
  const across = ticksOf(x.min, x.max, Math.max(2, Math.floor(box.width / 90))), acrossTexts = tickTexts(across, x.unit);
  across.forEach((tick, k) => {
    line(xOf(tick), box.top, xOf(tick), box.top + box.height);
    context.fillText(acrossTexts[k], xOf(tick), box.top + box.height + 6);
  });
  context.textAlign = "right";
  context.textBaseline = "middle";
  const upwards = ticksOf(y.min, y.max, 6), upwardsTexts = y.text ? upwards.map(y.text) : tickTexts(upwards, y.unit);
  upwards.forEach((tick, k) => {
    line(box.left, yOf(tick), box.left + box.width, yOf(tick));
    context.fillText(upwardsTexts[k], box.left - 6, yOf(tick));
  });
}

// draw(context, xOf, yOf) draws in the frame; x and y are {min, max, unit}.
function drawChart(canvas, x, y, draw) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (width <= axisWidth() + rightMargin()) return;
  canvas.width = width * devicePixelRatio;
  canvas.height = height * devicePixelRatio;
  const context = canvas.getContext("2d"), box = {left: axisWidth(), top: 10, width: width - axisWidth() - rightMargin(), height: height - 40};
  context.scale(devicePixelRatio, devicePixelRatio);
  const xOf = value => box.left + box.width * (value - x.min) / (x.max - x.min), yOf = value => box.top + box.height * (y.max - value) / (y.max - y.min);
  drawGrid(context, box, x, y, xOf, yOf);
  context.save();
  context.beginPath();
  context.rect(box.left, box.top, box.width, box.height);
  context.clip();
  draw(context, xOf, yOf);
  context.restore();
}

// A curve through points [x, y]; null ends a part of it.
function drawCurve(context, points, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  let isPenDown = false;
  for (const point of points) {
    if (!point) { isPenDown = false; continue; }
    if (isPenDown) context.lineTo(...point); else context.moveTo(...point);
    isPenDown = true;
  }
  context.stroke();
}

// Names in the colours of their curves.
function fillLegend(box, names) {
  box.replaceChildren(...names.map(([name, colour]) => {
    const text = document.createElement("span");
    text.textContent = name;
    text.style.color = colour;
    return text;
  }));
}
