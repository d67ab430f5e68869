// How symbols of schematics are drawn, in the coordinates of LTspice's own: y downwards, pins where lib/ltspice.symbols has them.
//   lines: strokes; solid: what is filled; valve: what is filled while it conducts, and body: likewise, of the diode within a transistor;
//   open, closed: one of them, by the state of a switch; signs: texts at places, upright whatever the orientation; box: the body, left, top, right, bottom;
//   path: terminals between which the current of the element flows.
const leads = (x, top, from, to, bottom) => `M${x} ${top}V${from}M${x} ${to}V${bottom}`;
const circle = (x, y, r) => `M${x - r} ${y}A${r} ${r} 0 1 1 ${x + r} ${y}A${r} ${r} 0 1 1 ${x - r} ${y}Z`;
const diamond = (y, r) => `M0 ${y - r}L${r} ${y}L0 ${y + r}L${-r} ${y}Z`;
const arrow = (x, from, to) => `M${x} ${from}V${to}M${x - 6} ${to - 9 * Math.sign(to - from)}L${x} ${to}L${x + 6} ${to - 9 * Math.sign(to - from)}`;
const coil = Array.from({length: 4}, (unused, k) => `A9 9 0 0 1 16 ${38 + 18 * k}`).join("");
const controls = "M-48 32H-34M-48 80H-34";
const controlSigns = (plus, minus) => [["+", -26, plus], ["−", -26, minus]];
const plusMinus = y => [["+", 0, y - 15], ["−", 0, y + 15]];

function diodeLike(bar, more = "", box = [0, 18, 32, 46]) {
  return {lines: `M16 0V20M16 44V64${bar}${more}`, valve: "M2 20H30L16 44Z", box};
}
function sourceLike(top, bottom, inner, more = {}) {
  const middle = (top + bottom) / 2, r = Math.min(32, (bottom - top) / 2 - 6);
  return {lines: leads(0, top, middle - r, middle + r, bottom) + circle(0, middle, r) + inner, box: [-r, middle - r, r, middle + r], ...more};
}
function controlled(top, bottom, inner, more = {}) {
  const middle = (top + bottom) / 2, r = 28;
  return {lines: leads(0, top, middle - r, middle + r, bottom) + diamond(middle, r) + inner, box: [-r, middle - r, r, middle + r], ...more};
}
function mosfet(isP, hasBulk) {
  const bulk = isP ? "M24 48H48" : "M24 48H48", tip = isP ? "M46 48L34 42V54Z" : "M25 48L37 42V54Z";
  const diode = isP ? "M60 44H72L66 54Z" : "M60 54H72L66 44Z", bar = isP ? "M60 54H72" : "M60 44H72";
  return {lines: "M0 80H14M14 18V80M22 14V32M22 40V56M22 64V82M22 23H48V0M22 73H48V96" + bulk +
      (hasBulk ? "" : (isP ? "M48 23V48" : "M48 48V73") + "M48 12H66V44M66 54V84H48" + bar),
    solid: tip, body: hasBulk ? "" : diode, channel: "M22 14V82", box: [10, 12, hasBulk ? 50 : 72, 84], path: [0, 2]};
}
function bipolar(isP, hasSubstrate) {
  return {lines: "M0 48H24M24 20V76M24 36L64 16V0M24 60L64 80V96" + (hasSubstrate ? "M64 48H30" : ""),
    solid: isP ? "M28 62L38.5 73L43 63.5Z" : "M60 78L45.5 76.5L49.8 67Z", channel: "M24 20V76", box: [18, 16, 66, 80], path: [0, 2]};
}
function junctionFet(isP) {
  return {lines: "M0 64H24M24 24V76M24 32H48V0M24 64H48V96", solid: isP ? "M6 64L16 58V70Z" : "M22 64L12 58V70Z", channel: "M24 24V76", box: [18, 22, 50, 78], path: [0, 2]};
}
// Of LTspice's gates: five inputs at the left, complement and output at the right, common below.
function gate(body, bubble, more) { return {lines: body + more + circle(...bubble, 4), box: [-32, 32, 32, 96]}; }
function buffer(ends, glyph = "") { return {lines: "M0 32V96L64 64Z" + ends + glyph, box: [0, 36, 60, 92]}; }
const bothOutputs = "M32 48H64M40 80H64" + circle(36, 80, 4), hysteresis = "M8 70H20V58M14 70V58H26";
function amplifier(middle, supplies) {
  const [plus, minus] = [middle + 16, middle - 16];
  return {lines: `M-32 ${middle - 32}L32 ${middle}L-32 ${middle + 32}Z` + (supplies ? `M0 ${middle - 32}V${middle - 16}M0 ${middle + 32}V${middle + 16}` : ""),
    signs: [["−", -23, minus], ["+", -23, plus]], box: [-32, middle - 32, 32, middle + 32]};
}

const wave = "M-14 56Q-7 40 0 56Q7 72 14 56";
const shapes = {
  res: {lines: "M16 16V26L26 31L6 41L26 51L6 61L26 71L16 76V96", box: [4, 26, 28, 80]},
  europeanresistor: {lines: "M16 16V28M16 84V96M8 28H24V84H8Z", box: [8, 28, 24, 84]},
  res2: {lines: "M16 0V8L26 12L6 20L26 28L6 36L26 44L6 52L16 56V64", box: [4, 8, 28, 56]},
  cap: {lines: "M16 0V28M0 28H32M0 36H32M16 36V64", box: [0, 24, 32, 40]},
  polcap: {lines: "M16 0V28M0 28H32M0 41Q16 31 32 41M16 36V64", signs: [["+", 3, 18]], box: [0, 12, 32, 42]},
  xtal: {lines: "M16 0V20M2 20H30M6 26H26V38H6ZM2 44H30M16 44V64", box: [2, 20, 30, 44]},
  ind: {lines: "M16 16V20" + coil + "V96", box: [14, 20, 26, 92]},
  ind2: {lines: "M16 16V20" + coil + "V96", solid: circle(30, 22, 3.5), box: [14, 18, 34, 92]},
  diode: diodeLike("M0 44H32"),
  schottky: diodeLike("M5 38H0V44H32V50H27"),
  zener: diodeLike("M-5 38L0 44H32L37 50"),
  led: diodeLike("M0 44H32", "M34 26L44 16M44 16H38M44 16V22M36 36L46 26M46 26H40M46 26V32", [0, 14, 48, 46]),
  varactor: diodeLike("M0 44H32M0 50H32"),
  voltage: sourceLike(16, 96, "", {signs: plusMinus(56)}),
  battery: {lines: leads(0, 16, 44, 68, 96) + "M-24 44H24M-12 52H12M-24 60H24M-12 68H12", signs: [["+", 14, 34]], box: [-24, 40, 24, 72]},
  signal: sourceLike(16, 96, wave, {signs: [["+", 0, 34]]}),
  cell: {lines: leads(0, 0, 28, 36, 64) + "M-20 28H20M-10 36H10", signs: [["+", 14, 18]], box: [-20, 24, 20, 40]},
  current: sourceLike(0, 80, arrow(0, 22, 58)),
  load: sourceLike(0, 64, arrow(0, 18, 46)),
  bv: controlled(16, 96, "", {signs: plusMinus(56)}),
  bi: controlled(0, 80, arrow(0, 22, 58)),
  bi2: controlled(0, 80, arrow(0, 58, 22)),
  e: controlled(16, 96, controls, {signs: [...plusMinus(56), ...controlSigns(32, 80)]}),
  e2: controlled(16, 96, controls, {signs: [...plusMinus(56), ...controlSigns(80, 32)]}),
  epoly: controlled(16, 96, "", {signs: plusMinus(56)}),
  f: controlled(0, 80, arrow(0, 22, 58)),
  g: controlled(16, 96, arrow(0, 74, 38) + controls, {signs: controlSigns(32, 80)}),
  g2: controlled(16, 96, arrow(0, 74, 38) + controls, {signs: controlSigns(80, 32)}),
  gpoly: controlled(16, 96, arrow(0, 74, 38)),
  h: controlled(16, 96, "", {signs: plusMinus(56)}),
  sw: {lines: "M0 16V32M0 80V96" + circle(0, 35, 3) + circle(0, 77, 3) + controls, open: "M0 74L18 40", closed: "M0 74V38", signs: controlSigns(80, 32), box: [-10, 30, 20, 82]},
  csw: {lines: "M0 0V16M0 64V80" + circle(0, 19, 3) + circle(0, 61, 3), open: "M0 58L18 24", closed: "M0 58V22", box: [-10, 14, 20, 66]},
  jumper: {lines: "M-32 64H32", box: [-32, 60, 32, 68]},
  tline: {lines: "M-48 -16H-36M48 -16H36M-48 16H-36M48 16H36M-36 -20H36V20H-36Z", box: [-36, -20, 36, 20]},
  npn: bipolar(false, false), npn4: bipolar(false, true), pnp: bipolar(true, false), pnp4: bipolar(true, true),
  njf: junctionFet(false), pjf: junctionFet(true),
  nmos: mosfet(false, false), nmos4: mosfet(false, true), pmos: mosfet(true, false), pmos4: mosfet(true, true),
  nigbt: {lines: "M0 80H14M14 20V80M22 16V80M22 30L48 14V0M22 66L48 82V96", solid: "M46 81L33.5 78L38.5 70.5Z", channel: "M22 16V80", box: [10, 12, 50, 84], path: [0, 2]},
  pigbt: {lines: "M0 80H14M14 20V80M22 16V80M22 30L48 14V0M22 66L48 82V96", solid: "M24 67L36.5 70L31.5 77.5Z", channel: "M22 16V80", box: [10, 12, 50, 84], path: [0, 2]},
  scr: diodeLike("M0 44H32", "M10 44L-10 64H-32"),
  triac: {lines: "M32 0V18M32 46V64M8 18H56M8 46H56M16 46L0 64H-16", valve: "M8 18H32L20 46ZM32 46H56L44 18Z", box: [8, 16, 56, 48]},
  diac: {lines: "M32 0V18M32 46V64M8 18H56M8 46H56", valve: "M8 18H32L20 46ZM32 46H56L44 18Z", box: [8, 16, 56, 48]},
  and: gate("M-32 32H0A32 32 0 0 1 0 96H-32Z", [28, 80], "M27.7 48H32"),
  or: gate("M-32 32Q-20 64 -32 96H-8Q24 92 36 64Q24 36 -8 32Z", [28, 80], "M-32 48H-27M-32 64H-26M-32 80H-27M25.8 48H32"),
  xor: {lines: "M-38 32Q-26 64 -38 96H-16Q16 92 28 64Q16 36 -16 32ZM-48 32Q-36 64 -48 96M-48 48H-43.5M-48 64H-42M-48 80H-43.5M17.8 80H24M-16 94.5V96" + circle(28, 80, 4), box: [-48, 32, 32, 96]},
  inv: buffer(circle(60, 64, 4)), buf: buffer(bothOutputs), buf1: buffer(""),
  schmitt: buffer(bothOutputs, hysteresis), schmtbuf: buffer("", hysteresis), schmtinv: buffer(circle(60, 64, 4), hysteresis),
  diffschmitt: buffer(bothOutputs, hysteresis), diffschmtbuf: buffer("", hysteresis), diffschmtinv: buffer(circle(60, 64, 4), hysteresis),
  dflop: {lines: "M-80 0H80V144H-80ZM-80 84L-66 96L-80 108" + circle(88, 96, 8),
    signs: [["D", -66, 48], ["Q", 66, 48], ["Q̄", 66, 96], ["PRE", 0, 14], ["CLR", 0, 130]], box: [-80, 0, 80, 144]},
  srflop: {lines: "M-48 24H48V128H-48Z" + circle(56, 96, 8), signs: [["S", -36, 48], ["R", -36, 96], ["Q", 36, 48], ["Q̄", 36, 96]], box: [-48, 24, 48, 128]},
  opamp: amplifier(64, false), opamp2: amplifier(64, true), universalopamp: amplifier(0, true),
};
for (const [name, drawn] of Object.entries({ind: "fixedind", cap: "europeancap", polcap: "europeanpolcap", zener: "tvsdiode", current: "load2", pnp4: "lpnp"})) shapes[drawn] = shapes[name];
for (const name of ["npn2", "npn3"]) shapes[name] = shapes.npn;
shapes.pnp2 = shapes.pnp;
shapes.load = {...shapes.load, lines: "M16 0V6M16 58V64" + circle(16, 32, 26) + arrow(16, 18, 46), box: [-10, 6, 42, 58]};
for (const number of ["", "1", "2", "3", "4"]) for (const name of ["universalopamp", "universalopamps"]) shapes[name + number] = shapes.universalopamp;

// A box about the terminals of anything else; strokes of its own file where there are some.
function shapeOf(part) {
  if (part.strokes.length) return shapeOfStrokes(part);
  if (Object.hasOwn(shapes, part.symbol)) return shapes[part.symbol];
  const own = ownTerminals(part), xs = own.map(([x]) => x), ys = own.map(([, y]) => y);
  let [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const least = 32, isColumn = left === right, isRow = top === bottom;
  if (isColumn) [left, right] = [left - least / 2, right + least / 2]; else if (right - left < least) right = left + least;
  if (isRow) [top, bottom] = [isColumn ? top : top - least / 2, bottom + least / 2]; else if (bottom - top < least) bottom = top + least;
  return {lines: `M${left} ${top}H${right}V${bottom}H${left}Z`, box: [left, top, right, bottom]};
}

function strokeAsPath({kind, points: [a, b, from, to]}) {
  if (kind === "line") return `M${a[0]} ${a[1]}L${b[0]} ${b[1]}`;
  if (kind === "rectangle") return `M${a[0]} ${a[1]}H${b[0]}V${b[1]}H${a[0]}Z`;
  const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], [rx, ry] = [Math.abs(b[0] - a[0]) / 2, Math.abs(b[1] - a[1]) / 2];
  if (kind === "circle") return `M${x - rx} ${y}A${rx} ${ry} 0 1 1 ${x + rx} ${y}A${rx} ${ry} 0 1 1 ${x - rx} ${y}Z`;
  const angle = point => Math.atan2((y - point[1]) / (ry || 1), (point[0] - x) / (rx || 1));
  const begin = angle(from), turn = (angle(to) - begin + 2 * Math.PI) % (2 * Math.PI);  // counterclockwise, as it is seen
  const place = at => `${(x + rx * Math.cos(at)).toFixed(2)} ${(y - ry * Math.sin(at)).toFixed(2)}`;
  return `M${place(begin)}A${rx} ${ry} 0 ${turn > Math.PI ? 1 : 0} 0 ${place(begin + turn)}`;
}

function shapeOfStrokes(part) {
  const points = [...part.strokes.flatMap(stroke => stroke.points.slice(0, 2)), ...ownTerminals(part)];
  const xs = points.map(([x]) => x), ys = points.map(([, y]) => y);
  return {lines: part.strokes.map(strokeAsPath).join(""), box: [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)]};
}

// A point of the symbol on the sheet, and back.
function onSheet(part, [x, y]) {
  for (let quarter = 0; quarter < part.quarters; ++quarter) [x, y] = [-y, x];
  return [part.at[0] + (part.mirrored ? -x : x), part.at[1] + y];
}
function ownTerminals(part) {
  return part.terminals.map(([x, y]) => {
    [x, y] = [x - part.at[0], y - part.at[1]];
    if (part.mirrored) x = -x;
    for (let quarter = 0; quarter < part.quarters; ++quarter) [x, y] = [y, -x];
    return [x, y];
  });
}
function transformOf(part) {
  const [ox, oy] = part.at, [ax, ay] = onSheet(part, [1, 0]), [bx, by] = onSheet(part, [0, 1]);
  return `matrix(${[ax - ox, ay - oy, bx - ox, by - oy, ox, oy].join(" ")})`;
}
