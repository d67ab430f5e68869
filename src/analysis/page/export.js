// The view as files.
function download(kind, blob, what = "view") {
  const link = document.createElement("a");
  link.download = run.deck.replace(/.*\//, "").replace(/\.[^.]*$/, "") + "-" + what + "." + kind;
  link.href = URL.createObjectURL(blob);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// What an address "data:…;base64,…" holds.
const bytesOf = address => Uint8Array.from(atob(address.slice(address.indexOf(",") + 1)), letter => letter.charCodeAt(0));

// The shown traces at the edges of pieces, twice where one may jump, and at places between.
function viewAsCsv() {
  const shown = [...traces].map(k => data.signals[k]);
  const places = new Set(), count = columns();
  for (let k = 0; k <= count; ++k) places.add(visible.min + (visible.max - visible.min) * k / count);
  for (const signal of shown) for (const edge of signal.edges) if (edge >= visible.min && edge <= visible.max) places.add(edge);
  const quoted = text => /[",]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
  const lines = [["time", ...shown.map(signal => quoted(signal.name))].join(",")];
  const line = (time, isBefore) => [time, ...shown.map(signal => valueAt(signal, time, isBefore) ?? "")].join(",");
  for (const time of [...places].sort((a, b) => a - b)) lines.push(...new Set([line(time, true), line(time, false)]));
  return lines.join("\n") + "\n";
}

// The plots one above the other, as they are drawn, each below the names of its curves.
function viewAsPicture() {
  const line = 20 * devicePixelRatio, hasTimeline = data.marks.length + data.lanes.length > 0;
  const parts = plots.map(plot => ({canvas: plot.root.querySelector("canvas"), members: plot.members}));
  if (hasTimeline) parts.push({canvas: element("timeline"), members: []});
  const picture = document.createElement("canvas"), context = picture.getContext("2d");
  picture.width = Math.max(...parts.map(part => part.canvas.width), 1);
  picture.height = parts.reduce((sum, part) => sum + part.canvas.height + line, 0);
  context.fillStyle = styled("--paper");
  context.fillRect(0, 0, picture.width, picture.height);
  context.font = 12 * devicePixelRatio + "px sans-serif";
  let y = 0;
  for (const {canvas, members} of parts) {
    let x = axisWidth() * devicePixelRatio;
    members.forEach((member, k) => {
      context.fillStyle = colourOf(member, k);
      context.fillText(data.signals[member].name, x, y + 0.7 * line);
      x += context.measureText(data.signals[member].name).width + line;
    });
    context.drawImage(canvas, 0, y + line);
    y += canvas.height + line;
  }
  return picture;
}

const svgSize = {width: 900, height: 200, left: 104, right: 10, gap: 40};
const escaped = text => text.replace(/[&<>"]/g, c => "&#" + c.charCodeAt(0) + ";");

// One plot as SVG, on white: as it is printed.
function plotAsSvg(plot, number) {
  const {width, height, left, right, gap} = svgSize, inner = width - left - right;
  const {min, max} = plot.scales.y, top = number * (height + gap) + 20, unit = data.signals[plot.members[0]].unit;
  const xOf = time => left + inner * (time - visible.min) / (visible.max - visible.min), yOf = value => top + height * (max - value) / (max - min);
  const frame = `x="${left}" y="${top}" width="${inner}" height="${height}"`;
  const labels = ticksOf(min, max, 5).map(tick =>
    `<line x1="${left}" x2="${width - right}" y1="${yOf(tick).toFixed(1)}" y2="${yOf(tick).toFixed(1)}" stroke="#ddd"/>` +
    `<text x="${left - 6}" y="${(yOf(tick) + 4).toFixed(1)}" text-anchor="end">${escaped(quantity(tick, unit))}</text>`);
  let place = left + 8;
  const curves = plot.members.map((member, k) => {
    const signal = data.signals[member], colour = signal.colour || coloursOnLight[k % coloursOnLight.length];
    const points = plot.data[0].map((time, i) => plot.data[k + 1][i] === null ? "" : xOf(time).toFixed(1) + "," + yOf(plot.data[k + 1][i]).toFixed(1)).join(" ");
    const name = `<text x="${place}" y="${top - 5}" fill="${colour}">${escaped(signal.name)}</text>`;
    place += 7 * signal.name.length + 20;
    return `<svg ${frame} viewBox="${left} ${top} ${inner} ${height}"><polyline fill="none" stroke="${colour}" stroke-width="1.5" points="${points.trim()}"/></svg>` + name;
  });
  return `<rect ${frame} fill="none" stroke="#999"/>` + labels.join("") + curves.join("");
}

function viewAsSvg() {
  const {width, height, left, right, gap} = svgSize, bottom = plots.length * (height + gap);
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${bottom + 20}" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="#fff"/>` +
    plots.map(plotAsSvg).join("") + `<text x="${left}" y="${bottom + 10}">${quantity(visible.min, "s", 9)}</text>` +
    `<text x="${width - right}" y="${bottom + 10}" text-anchor="end">${quantity(visible.max, "s", 9)}</text></svg>\n`;
}

// A drawing of the page as a file of its own, with the colours that it has now.
function drawingAsSvg(drawn) {
  const kept = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-linecap", "stroke-linejoin", "stroke-dasharray", "opacity", "font-size", "font-weight", "font-family"];
  const copy = drawn.cloneNode(true), originals = [...drawn.querySelectorAll("*")], copies = [...copy.querySelectorAll("*")];
  originals.forEach((original, k) => {
    const style = getComputedStyle(original), made = copies[k];
    if (style.display === "none" || original.matches(".reach, title")) return made.remove();
    for (const name of ["class", "style", "tabindex", "role", "aria-label", "data-state"]) made.removeAttribute(name);
    if (original.tagName !== "g") for (const name of kept) made.setAttribute(name, style.getPropertyValue(name));
  });
  const [x, y, width, height] = copy.getAttribute("viewBox").split(" "), paper = svgPart(null, "rect", {x, y, width, height, fill: styled("--paper")});
  copy.prepend(paper);
  return new XMLSerializer().serializeToString(copy) + "\n";
}
