// The time line of events and modes below the plots.
const rowHeight = 16;

// Switches within LTspice's gates, "A1.Sb1", show only when asked for.
const isInternal = lane => /(^|[.:])A[^.:]*\.[^.:]+$/i.test(lane.name);
const shownLanes = () => element("internals").checked ? data.lanes : data.lanes.filter(lane => !isInternal(lane));

function timelineX(canvas) {
  const width = canvas.clientWidth - axisWidth() - rightMargin();
  return time => axisWidth() + width * (time - visible.min) / (visible.max - visible.min);
}

// As much of a name as its place holds.
function shortened(name) {
  const most = isNarrow.matches ? 11 : 16;
  return name.length > most ? "…" + name.slice(1 - most) : name;
}

// Those that could not be told apart become a pale bar.
function drawTicks(context, places, y) {
  const leastCrowd = 4;
  for (let k = 0; k < places.length;) {
    let end = k + 1;
    while (end < places.length && places[end] <= places[end - 1] + 1) ++end;
    const length = places[end - 1] - places[k] + 1;
    context.globalAlpha = length < leastCrowd ? 1 : 0.4;
    context.fillRect(places[k], y, length, rowHeight - 5);
    k = end;
  }
  context.globalAlpha = 1;
}

function drawTimeline() {
  const canvas = element("timeline");
  const lanes = shownLanes(), rows = data.marks.length + lanes.length;
  canvas.style.display = rows === 0 ? "none" : "block";
  if (rows === 0) return;
  const width = canvas.clientWidth, height = rows * rowHeight + 4;
  canvas.style.height = height + "px";
  canvas.width = width * devicePixelRatio;
  canvas.height = height * devicePixelRatio;
  const context = canvas.getContext("2d");
  context.scale(devicePixelRatio, devicePixelRatio);
  const xOf = timelineX(canvas), right = width - rightMargin();
  context.font = "11px sans-serif";
  context.textAlign = "right";
  context.textBaseline = "middle";
  let y = 2;
  const label = (name, colour) => {
    context.fillStyle = colour || styled("--ink");
    context.fillText(shortened(name), axisWidth() - 6, y + rowHeight / 2);
  };
  for (const marks of data.marks) {
    label(marks.name, marks.colour);
    context.fillStyle = marks.colour || colours[1];
    drawTicks(context, marks.x.filter(time => time >= visible.min && time <= visible.max).map(time => Math.round(xOf(time))), y + 2);
    y += rowHeight;
  }
  for (const lane of lanes) {
    label(lane.name);
    context.fillStyle = colours[0];
    for (let k = 0; k < lane.times.length; ++k) {
      const begin = Math.max(lane.times[k], visible.min);
      const end = Math.min(k + 1 < lane.times.length ? lane.times[k + 1] : whole.max, visible.max);
      if (lane.shares[k] === 0 || end <= begin) continue;
      context.globalAlpha = Math.max(lane.shares[k], 0.1);
      context.fillRect(xOf(begin), y + 2, Math.max(xOf(end) - xOf(begin), 0.5), rowHeight - 5);
    }
    context.globalAlpha = 1;
    y += rowHeight;
  }
  context.strokeStyle = styled("--grid");
  context.strokeRect(axisWidth(), 0.5, right - axisWidth(), height - 1);
  drawCursors(context, xOf, 0, height, 1);
  document.documentElement.dataset.lanes = lanes.length;
  document.documentElement.dataset.marks = data.marks.length;
}
