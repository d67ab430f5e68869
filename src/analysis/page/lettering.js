// Where the texts of a schematic stand: each at the place of a few that covers least of what is drawn already.
const letterHeight = 15, letterWidth = 7;

const overlap = (a, b) => Math.max(0, Math.min(a[2], b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[3], b[3]) - Math.max(a[1], b[1]));
const joined = (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[2], b[2]), Math.max(a[3], b[3])];

// Boxes are left, top, right, bottom; `texts` counts apart, as text on text is worse than text on a wire.
class Lettering {
  constructor() { this.drawn = []; this.texts = []; }

  draw(box) { this.drawn.push(box); }

  // The best of places {x, y, anchor}, of which those that come first are better; x and y are those of the first line's top.
  place(places, width, height) {
    let best = null;
    places.forEach((place, order) => {
      const left = {start: place.x, middle: place.x - width / 2, end: place.x - width}[place.anchor];
      const box = [left, place.y, left + width, place.y + height];
      const cost = sumOf(this.drawn, box) + 3 * sumOf(this.texts, box) + 4 * order;
      if (!best || cost < best.cost) best = {...place, box, cost};
    });
    this.texts.push(best.box);
    return best;
  }

  get extent() { return [...this.drawn, ...this.texts].reduce(joined, [Infinity, Infinity, -Infinity, -Infinity]); }
}
function sumOf(boxes, box) { return boxes.reduce((sum, each) => sum + overlap(each, box), 0); }

// Around a box: right, left, above, below, and the corners; then the same farther away.
function placesAround([left, top, right, bottom], height, isUpright) {
  const x = (left + right) / 2, y = (top + bottom) / 2 - height / 2;
  return [5, 16, 28].flatMap(gap => {
    const sides = [{x: right + gap, y, anchor: "start"}, {x: left - gap, y, anchor: "end"}];
    const ends = [{x, y: top - height - gap, anchor: "middle"}, {x, y: bottom + gap, anchor: "middle"}];
    const corners = [[right + gap, "start"], [left - gap, "end"]].flatMap(([at, anchor]) =>
      [top - height - gap, bottom + gap, top, bottom - height].map(begin => ({x: at, y: begin, anchor})));
    return [...(isUpright ? sides : ends), ...(isUpright ? ends : sides), ...corners];
  });
}

// Beside a point of a wire, and farther away.
function placesAt(x, y, height) {
  return [4, 16, 28].flatMap(gap => {
    const above = y - height - gap, below = y + gap, beside = y - height / 2;
    return [{x, y: above, anchor: "middle"}, {x: x + gap, y: above, anchor: "start"}, {x: x - gap, y: above, anchor: "end"}, {x, y: below, anchor: "middle"},
      {x: x + gap, y: below, anchor: "start"}, {x: x - gap, y: below, anchor: "end"}, {x: x + 2 * gap, y: beside, anchor: "start"}, {x: x - 2 * gap, y: beside, anchor: "end"}];
  });
}
