// Runs inside the page of a report under test: does with it what a user would, and looks at it. A test's own acts are in the function that it hands
// to play; what they store in `seen` is sent as JSON to the page around it.
"use strict";
const seen = {};
const wait = milliseconds => new Promise(done => setTimeout(done, milliseconds));
const byId = id => document.getElementById(id);
const view = () => Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
const plotArea = number => document.querySelectorAll(".u-over")[number];

// A place in an element, as shares of its width and height.
function send(target, type, [x, y], more = {}) {
  const box = target.getBoundingClientRect();
  target.dispatchEvent(new PointerEvent(type, {bubbles: true, cancelable: true, clientX: box.left + x * box.width, clientY: box.top + y * box.height,
    pointerId: 1, pointerType: "mouse", button: 0, buttons: 1, ...more}));
}

async function drag(target, from, to, more = {}) {
  send(target, "pointerdown", from, more);
  for (const share of [0.3, 0.7, 1]) {
    send(target, "pointermove", [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])], more);
    await wait(30);
  }
  send(target, "pointerup", to, more);
  await wait(30);
}

async function press(key, more = {}) {
  document.body.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, cancelable: true, ...more}));
  await wait(30);
}

async function clickAt(target, place, more = {}) {
  send(target, "pointerdown", place, more);
  send(target, "pointerup", place, more);
  await wait(30);
}

// What a click on a button would have the browser save: the file's name and its content.
function saved(id) {
  const {createObjectURL} = URL, {Blob} = window, {click} = HTMLAnchorElement.prototype;
  const file = {};
  window.Blob = class { constructor(parts) { file.content = parts[0]; } };
  URL.createObjectURL = () => "data:,";
  HTMLAnchorElement.prototype.click = function () { file.name = this.download; };
  byId(id).click();
  URL.createObjectURL = createObjectURL;
  window.Blob = Blob;
  HTMLAnchorElement.prototype.click = click;
  return [file.name, file.content];
}

// Relative luminance and contrast as WCAG 2.2 defines them.
function luminance([r, g, b]) {
  const [red, green, blue] = [r, g, b].map(value => value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}
const colourParts = text => (text.match(/[\d.]+/g) ?? []).map(Number);
function contrast(one, other) {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}
function backgroundOf(box) {
  for (let each = box; each; each = each.parentElement) {
    const parts = colourParts(getComputedStyle(each).backgroundColor);
    if (parts.length === 3 || parts[3] === 1) return parts;
  }
  return matchMedia("(prefers-color-scheme: dark)").matches ? [18, 18, 18] : [255, 255, 255];
}

const isShown = box => box.getClientRects().length > 0 && getComputedStyle(box).visibility !== "hidden";

// Text with less contrast than 4.5 (WCAG 1.4.3, level AA).
function paleTexts() {
  const pale = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const box = walk.currentNode.parentElement;
    if (!walk.currentNode.textContent.trim() || /SCRIPT|STYLE/.test(box.tagName) || !isShown(box)) continue;
    const ratio = contrast(colourParts(getComputedStyle(box).color), backgroundOf(box));
    if (ratio < 4.5) pale.push(box.tagName + " " + walk.currentNode.textContent.trim().slice(0, 30) + " " + ratio.toFixed(2));
  }
  return pale;
}

// Controls and pictures without a name (WCAG 4.1.2 and 1.1.1), ids that stand twice, a page without language or title.
function unnamed() {
  const faults = [];
  for (const box of document.querySelectorAll("button, input, select, textarea, canvas, [role=img]")) {
    if (!isShown(box) || box.closest("[role=img]") !== (box.matches("[role=img]") ? box : null)) continue;
    const name = box.getAttribute("aria-label") || box.labels?.[0]?.textContent.trim() || (box.tagName === "BUTTON" && box.textContent.trim());
    if (!name) faults.push(box.outerHTML.slice(0, 80));
  }
  const ids = [...document.querySelectorAll("[id]")].map(box => box.id);
  faults.push(...ids.filter((id, k) => ids.indexOf(id) !== k).map(id => "twice: " + id));
  if (!document.documentElement.lang) faults.push("no language");
  if (!document.title) faults.push("no title");
  return faults;
}

// Texts on canvases that begin or end outside of them.
const clipped = [];
const fillText = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  const width = this.measureText(text).width, place = this.getTransform();
  const before = {left: 0, start: 0, center: width / 2, right: width, end: width}[this.textAlign];
  const left = place.a * (x - before) + place.e, right = left + place.a * width;
  if (place.b === 0 && (left < -0.5 || right > this.canvas.width + 0.5)) clipped.push(text);
  fillText.call(this, text, x, y);
};

function play(acts) {
  addEventListener("load", async () => {
    await wait(200);
    try {
      await acts();
    } catch (error) {
      seen.error = String(error.stack ?? error);
    }
    parent.postMessage(JSON.stringify(seen), "*");
  });
}
