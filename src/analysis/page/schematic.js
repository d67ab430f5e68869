// The schematic that the deck was drawn as: wires, symbols, names, and room for what is measured.
const drawing = data.schematic;
const mostLetters = 22;
const widestVoltage = "−000.0 mV", widestCurrent = "−000.0 mA";

function svgPart(parent, tag, attributes = {}, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text) made.textContent = text;
  parent?.append(made);
  return made;
}

const cut = text => text.length > mostLetters ? text.slice(0, mostLetters - 1) + "…" : text;

// Lines of text below each other; returns their elements.
function writeLines(parent, lines, placed) {
  return lines.map(([text, name], k) =>
    svgPart(parent, "text", {class: name, x: placed.x, y: placed.y + (k + 0.8) * letterHeight, "text-anchor": placed.anchor}, text));
}

function boxOnSheet(part, [left, top, right, bottom]) {
  const [a, b] = [onSheet(part, [left, top]), onSheet(part, [right, bottom])];
  return [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[0], b[0]), Math.max(a[1], b[1])];
}

const terminalsOfCurrent = (part, shape) => (shape.path ?? [0, 1]).map(k => part.terminals[k]);

// The symbol; what changes with time is kept in `view`.
function drawSymbol(group, part, shape, view) {
  const own = svgPart(group, "g", {transform: transformOf(part), class: "symbol"});
  svgPart(own, "path", {class: "stroke", d: shape.lines});
  if (shape.solid) svgPart(own, "path", {class: "solid", d: shape.solid});
  for (const name of ["valve", "body", "channel", "open", "closed"]) if (shape[name]) view[name] = svgPart(own, "path", {class: name, d: shape[name]});
  for (const [sign, x, y] of shape.signs ?? []) {
    const [sx, sy] = onSheet(part, [x, y]);
    svgPart(group, "text", {class: "sign", x: sx, y: sy + 5, "text-anchor": "middle"}, sign);
  }
  if (shape.box && (part.block || !Object.hasOwn(shapes, part.symbol))) drawTerminalNames(group, part, shape.box);
}

// Within the box, beside the terminals.
function drawTerminalNames(group, part, box) {
  const [left, top, right, bottom] = boxOnSheet(part, box), inset = 5;
  for (const [x, y, , name] of part.terminals) {
    if (!name) continue;
    const distances = [x - left, right - x, y - top, bottom - y], side = distances.indexOf(Math.min(...distances));
    const anchor = ["start", "end", "middle", "middle"][side];
    svgPart(group, "text", {class: "terminal", x: x + [inset, -inset, 0, 0][side], y: y + [4, 4, inset + 9, -inset][side], "text-anchor": anchor}, name);
  }
}

// An arrow head on the lead of the first terminal of the current, and where to it points when the current is positive.
function drawArrow(group, part, shape) {
  const [from, to] = terminalsOfCurrent(part, shape);
  if (!from || !to) return null;
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]) * 180 / Math.PI, inward = 5;
  const [x, y] = [from[0] + inward * Math.cos(angle * Math.PI / 180), from[1] + inward * Math.sin(angle * Math.PI / 180)];
  return {element: svgPart(group, "path", {class: "arrow", d: "M-6 -6L7 0L-6 6Z"}), x, y, angle};
}

function turnArrow(arrow, value) {
  arrow.element.style.display = value ? "" : "none";
  if (value) arrow.element.setAttribute("transform", `translate(${arrow.x} ${arrow.y}) rotate(${arrow.angle + (value < 0 ? 180 : 0)})`);
}

// One sheet with the names that it has at one place of the hierarchy: a picture, and the parts and nets of it.
class SheetPicture {
  constructor(place) {
    this.place = place;
    this.sheet = drawing.sheets[place.sheet];
    this.svg = svgPart(null, "svg", {role: "group", "aria-label": place.path ? "Schematic of " + place.path : "Schematic"});
    this.lettering = new Lettering();
    this.nets = this.sheet.nets.map((name, k) => ({name, node: place.nodes[k], key: keyOf(`v(${place.nodes[k]})`), texts: [], group: svgPart(this.svg, "g", {class: "net"})}));
    this.drawWires();
    this.parts = this.sheet.parts.map((part, k) => this.drawPart(part, place.elements[k]));
    for (const [x, y, net] of this.sheet.labels) if (this.sheet.nets[net] === "0") this.drawGround(x, y, net);
    this.writeCouplings();
    this.writeLabels();
    this.parts.forEach(view => this.namePart(view));
    this.nets.forEach((net, k) => this.writeVoltage(net, k));
    const margin = 14, [left, top, right, bottom] = this.lettering.extent;
    [this.width, this.height] = [right - left + 2 * margin, bottom - top + 2 * margin];
    this.svg.setAttribute("viewBox", [left - margin, top - margin, this.width, this.height].join(" "));
  }

  drawWires() {
    const reach = 3;
    for (const [x1, y1, x2, y2, net] of this.sheet.wires) {
      const group = this.nets[net].group, d = `M${x1} ${y1}L${x2} ${y2}`;
      svgPart(group, "path", {class: "wire", d});
      svgPart(group, "path", {class: "reach", d});
      this.lettering.draw([Math.min(x1, x2) - reach, Math.min(y1, y2) - reach, Math.max(x1, x2) + reach, Math.max(y1, y2) + reach]);
    }
    for (const [x, y] of this.sheet.dots) svgPart(this.svg, "circle", {class: "dot", cx: x, cy: y, r: 4});
  }

  drawPart(part, element) {
    const group = svgPart(this.svg, "g", {class: "part"}), shape = shapeOf(part);
    const view = {part, element, shape, group, key: keyOf(`i(${element})`), box: boxOnSheet(part, shape.box)};
    drawSymbol(group, part, shape, view);
    if (!shape.valve && !shape.channel && !shape.closed) group.classList.add("plain");
    if (!shape.solid && this.isCoupled(part) && part.symbol.startsWith("ind")) svgPart(group.firstChild, "path", {class: "solid", d: shapes.ind2.solid});
    view.arrow = drawArrow(group, part, shape);
    if (view.arrow) {
      turnArrow(view.arrow, 0);
      this.lettering.draw([view.arrow.x - 8, view.arrow.y - 8, view.arrow.x + 8, view.arrow.y + 8]);
    }
    const [left, top, right, bottom] = view.box;
    svgPart(group, "rect", {class: "reach", x: left - 4, y: top - 4, width: right - left + 8, height: bottom - top + 8});
    this.lettering.draw(view.box);
    for (const [x, y] of part.terminals) this.lettering.draw([Math.min(x, left), Math.min(y, top), Math.max(x, right), Math.max(y, bottom)].map((at, k) =>
      k % 2 ? Math.min(Math.max(at, Math.min(y, (top + bottom) / 2)), Math.max(y, (top + bottom) / 2)) : Math.min(Math.max(at, x - 3), x + 3)));
    return view;
  }

  isCoupled(part) { return this.sheet.couplings.some(([, , text]) => text.toLowerCase().split(/\s+/).includes(part.element.toLowerCase())); }

  drawGround(x, y, net) {
    svgPart(this.nets[net].group, "path", {class: "ground", d: `M${x - 12} ${y}H${x + 12}L${x} ${y + 13}Z`});
    this.lettering.draw([x - 12, y, x + 12, y + 13]);
  }

  writeCouplings() {
    for (const [x, y, text] of this.sheet.couplings) {
      const placed = {x, y: y - letterHeight / 2, anchor: "start"};
      writeLines(this.svg, [[text, "value"]], placed);
      this.lettering.texts.push([x, placed.y, x + letterWidth * text.length, placed.y + letterHeight]);
    }
  }

  namePart(view) {
    const {part} = view, lines = part.element ? [[part.name, "name"]] : [];
    if (part.value) lines.push([cut(part.value), "value"]);
    const isMeasured = part.element && hasSignal(view.key);
    if (isMeasured) lines.push([widestCurrent, "current"]);
    if (!lines.length) return;
    const height = lines.length * letterHeight, width = letterWidth * Math.max(...lines.map(([text]) => text.length));
    const isUpright = view.box[3] - view.box[1] >= view.box[2] - view.box[0] || part.terminals.length > 2;
    const written = writeLines(view.group, lines, this.lettering.place(placesAround(view.box, height, isUpright), width, height));
    if (isMeasured) view.text = written[written.length - 1];
  }

  writeLabels() {
    for (const [x, y, number, name] of this.sheet.labels) {
      const net = this.nets[number];
      if (net.name === "0") continue;
      const lines = [[name, "label"], ...(hasSignal(net.key) ? [[widestVoltage, "voltage"]] : [])], height = lines.length * letterHeight;
      const written = writeLines(net.group, lines, this.lettering.place(placesAt(x, y, height), letterWidth * Math.max(name.length, lines.length > 1 ? widestVoltage.length : 0), height));
      if (lines.length > 1) net.texts.push(written[1]);
    }
  }

  // Of a net without a label at one of its wires.
  writeVoltage(net, number) {
    if (net.name === "0" || net.texts.length || !hasSignal(net.key)) return;
    const wires = this.sheet.wires.filter(wire => wire[4] === number), length = ([x1, y1, x2, y2]) => Math.abs(x2 - x1) + Math.abs(y2 - y1);
    const longest = 4;  // are tried
    const places = wires.sort((a, b) => length(b) - length(a)).slice(0, longest).flatMap(([x1, y1, x2, y2]) => [0.5, 0.25, 0.75].flatMap(share =>
      placesAt(x1 + share * (x2 - x1), y1 + share * (y2 - y1), letterHeight)));
    if (places.length) net.texts = writeLines(net.group, [[widestVoltage, "voltage"]], this.lettering.place(places, widestVoltage.length * letterWidth, letterHeight));
  }
}
