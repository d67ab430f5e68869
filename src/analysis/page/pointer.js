// What mouse and fingers do on the plots and the time line.
// Mouse: drag a box to zoom, shift-drag or middle button to move, wheel to zoom in time, shift-wheel in value, click for cursor A, shift-click for B.
// Touch: one finger moves, two zoom, a tap sets cursor A, a long one B. A cursor that is near the pointer is dragged.
const leastMove = 4;         // pixels below which a drag is a click
const leastBoxHeight = 30;   // below it a box zooms time only, and one less wide zooms values only
const longPress = 500;       // milliseconds
const isTouch = event => event.pointerType === "touch";

// An area is an element with a scale of times (timeAt, xOf, begin and width in pixels) and its plot, null for the time line.
function cursorNear(area, place, reach) {
  const distance = name => cursors[name] === null ? Infinity : Math.abs(area.xOf(cursors[name]) - place.x);
  const nearest = distance("A") <= distance("B") ? "A" : "B";
  return distance(nearest) <= reach ? nearest : null;
}

function selectionOf(area, from, to) {
  const box = {left: Math.min(from.x, to.x), width: Math.abs(to.x - from.x), top: Math.min(from.y, to.y), height: Math.abs(to.y - from.y)};
  const full = {width: area.element.clientWidth, height: area.element.clientHeight};
  const inTime = box.height < leastBoxHeight || box.width >= leastBoxHeight, inValue = box.height >= leastBoxHeight;
  if (!inValue) Object.assign(box, {top: 0, height: full.height});
  if (!inTime) Object.assign(box, {left: 0, width: full.width});
  return {...box, inTime, inValue};
}

// What a drag of each kind does when the pointer moves, and when it ends.
const drags = {
  cursor: {
    move: (area, drag, place) => setCursor(drag.cursor, snapped(area.timeAt(place.x))),
  },
  pan: {
    move(area, drag, place) {
      const {min, max} = drag.visible;
      if (drag.yWindow) {
        const shift = (place.y - drag.from.y) / area.element.clientHeight * (drag.yWindow.max - drag.yWindow.min);
        area.plot.yWindow = {min: drag.yWindow.min + shift, max: drag.yWindow.max + shift};
      }
      moveTo(min + (drag.from.x - place.x) / area.width() * (max - min), max - min);
    },
  },
  box: {
    move: (area, drag, place) => area.plot.setSelect(selectionOf(area, drag.from, place), false),
    end(area, drag, place) {
      const box = selectionOf(area, drag.from, place), plot = area.plot;
      const times = [area.timeAt(box.left), area.timeAt(box.left + box.width)];
      const values = [plot.posToVal(box.top + box.height, "y"), plot.posToVal(box.top, "y")];
      plot.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
      if (box.inValue) plot.yWindow = {min: values[0], max: values[1]};
      if (box.inTime) setRange(...times); else setYWindow(plot, plot.yWindow);
    },
  },
  pinch: {
    move(area, drag) {
      const [one, other] = [...drag.fingers.values()];
      if (Math.abs(other.x - one.x) < 10) return;
      const scale = (drag.times[1] - drag.times[0]) / (other.x - one.x);
      if (scale <= 0) return;
      const min = drag.times[0] - scale * (one.x - area.begin());
      setRange(min, min + scale * area.width());
    },
  },
};

function beginDrag(area, event, place, fingers) {
  const drag = {from: place, fingers, visible: {...visible}, yWindow: area.plot?.yWindow ? {...area.plot.yWindow} : null, hasMoved: false, at: event.timeStamp};
  drag.cursor = cursorNear(area, place, isTouch(event) ? 20 : 5);
  drag.kind = drag.cursor ? "cursor" : isTouch(event) || event.shiftKey || event.button === 1 || !area.plot ? "pan" : "box";
  return drag;
}

function click(area, event, drag, place) {
  const isSecond = event.shiftKey || (isTouch(event) && event.timeStamp - drag.at >= longPress);
  setCursor(isSecond ? "B" : "A", snapped(area.timeAt(place.x)));
}

function listenToArea(area) {
  const fingers = new Map();
  let drag = null;
  const placeOf = event => {
    const box = area.element.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  };
  const move = event => {
    if (!drag || !fingers.has(event.pointerId)) return;
    const place = placeOf(event);
    fingers.set(event.pointerId, place);
    if (!drag.hasMoved && Math.hypot(place.x - drag.from.x, place.y - drag.from.y) < leastMove) return;
    drag.hasMoved = true;
    const moving = drag;
    drag.last = place;
    moving.act ??= () => { if (drag === moving) drags[moving.kind].move(area, moving, moving.last); };
    soon(moving.act);
  };
  const end = event => {
    if (!fingers.has(event.pointerId)) return;
    const ended = drag, place = placeOf(event), last = new Map(fingers).set(event.pointerId, place);
    fingers.delete(event.pointerId);
    drag = null;
    if (!ended || event.type === "pointercancel") return;
    if (!ended.hasMoved) click(area, event, ended, place);
    else if (ended.kind === "box") drags.box.end(area, ended, place);
    else drags[ended.kind].move(area, {...ended, fingers: last}, place);
  };
  area.element.addEventListener("pointerdown", event => {
    if (event.button > 1) return;
    const place = placeOf(event);
    fingers.set(event.pointerId, place);
    if (fingers.size === 2) drag = {...drag, kind: "pinch", fingers, times: [...fingers.values()].map(finger => area.timeAt(finger.x)), hasMoved: true, act: undefined};
    else if (fingers.size === 1) drag = beginDrag(area, event, place, fingers);
    if (event.button === 1) event.preventDefault();
  });
  for (const type of ["pointermove", "pointerup", "pointercancel"]) document.addEventListener(type, type === "pointermove" ? move : end, {signal: area.until});
  area.element.addEventListener("pointermove", event => {
    if (!drag && !isTouch(event)) area.element.style.cursor = cursorNear(area, placeOf(event), 5) ? "col-resize" : "";
  });
  area.element.addEventListener("wheel", event => {
    event.preventDefault();
    const factor = event.deltaY + event.deltaX > 0 ? 1.25 : 0.8, place = placeOf(event);
    if (event.shiftKey && area.plot) zoomValues(area.plot, factor, area.plot.posToVal(place.y, "y"));
    else zoom(factor, area.timeAt(place.x));
  }, {passive: false});
  area.element.addEventListener("dblclick", showWhole);
}

function zoomValues(plot, factor, about) {
  const {min, max} = plot.scales.y;
  setYWindow(plot, {min: about - (about - min) * factor, max: about + (max - about) * factor});
}

function listenToPlot(plot) {
  const over = plot.over, listening = new AbortController(), width = () => over.clientWidth;
  plot.hooks.destroy = [() => listening.abort()];
  listenToArea({element: over, plot, begin: () => 0, width, until: listening.signal,
    timeAt: x => visible.min + (visible.max - visible.min) * x / width(), xOf: time => width() * (time - visible.min) / (visible.max - visible.min)});
}

function listenToTimeline(canvas) {
  const width = () => canvas.clientWidth - axisWidth() - rightMargin();
  listenToArea({element: canvas, plot: null, begin: axisWidth, width, timeAt: x => visible.min + (visible.max - visible.min) * (x - axisWidth()) / width(),
    xOf: time => timelineX(canvas)(time), until: undefined});
}
