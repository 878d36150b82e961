// The page on which parts are marked: sends finished strokes. docs/curator.md has the messages.
import { loadSession, may } from "./api.js";
import { showAccount } from "./account.js";
import { keyOf } from "./browser.js";
import { Eye } from "./eye.js";
import { setUpPart, takeEnd, takeError, takeHello, takeParts, takeRegion } from "./marked_part.js";
import { Ruler } from "./measure.js";
import { setUpPublishing } from "./publish.js";

const byId = id => document.getElementById(id);
const stage = byId("stage"), picture = byId("picture"), strokes = byId("strokes");
const STROKE_POINTS_MAX = 20000;
const PEN_PX = { part: 10, rest: 10, heavy: 34, lasso: 3 };
const HINTS = {
  look: "Drag to turn, right button or two fingers to move, wheel to zoom; double-click sets the middle.",
  lasso: "Go around the part. The right button still turns the model.",
  heavy: "Go around the part with the broad pen: its border is found under the stroke.",
  part: "Draw over the part, then over what is not in it, then press Find part.",
  rest: "Draw over what is not in the part, then press Find part.",
};

let ruler = new Ruler(), picks = []; // picks: what each answer that is still to come is for
let tool = "look", take = false, through = false;
let kept = [], stroke = null; // strokes that wait for Find part; the one being drawn
let pen = null;               // where the keyboard's pen is, [x, y] in the picture's pixels; null: put away
const NOTHING = { triangles: 0, undo: 0, redo: 0, marks: false };
let region = NOTHING;

// ---- messages

const eye = new Eye(stage, [picture, strokes], byId("quality"), {
  text: onText,
  moved,
  tell,
  closed: (wasOpen, reason) => {
    byId("connection").textContent = reason ? `${reason} Load the page again.` : wasOpen ? "Connection lost. What was not saved is gone; reload the page." : "No connection: is gopura-curator running?";
    byId("connection").classList.add("lost");
    region = NOTHING;
    showRegion();
    takeEnd();
  },
  press: (event, fingers) => {
    if (fingers > 1) {
      stroke = null;
      drawStrokes();
    } else if (tool !== "look" && event.button === 0) startStroke(pixelOf(event));
  },
  // Returns whether the movement draws, and does not turn.
  drag: (event, button) => {
    if (stroke) extend(event);
    else if (tool === "look" || button === 1 || button === 2) return false;
    return true;
  },
  lift: event => {
    if (stroke && event.type === "pointerup") finishStroke();
    else if (stroke) { stroke = null; drawStrokes(); }
  },
});
const send = message => eye.send(message);

function onText(message) {
  switch (message.type) {
  case "hello": begin(message); break;
  case "region":
    region = message;
    showRegion();
    takeRegion(message);
    break;
  case "parts": takeParts(message); break;
  case "point": picked(message.at); break;
  case "error":
    if (message.of === "pick") picks.shift();
    tell(message.message);
    takeError(message);
    break;
  }
}

function tell(text, good = false) {
  byId("message").textContent = text;
  byId("message").classList.toggle("good", good);
}

function begin(message) {
  byId("connection").textContent = "Connected";
  byId("name").textContent = message.name;
  document.title = `${message.name} – Gopura curator`;
  takeHello(message);
  ruler = new Ruler(message.error);
  eye.begin(message);
}

// ---- places on the model: what is looked at, or measured

function pick(purpose, at) {
  picks.push(purpose);
  send({ type: "pick", view: eye.sharpView, points: at });
}

function picked(at) {
  const purpose = picks.shift();
  if (purpose === "look" && at) eye.lookAt(at);
  if (purpose !== "measure") return;
  if (at) ruler.add(at, 0.5 * Math.hypot(...eye.position.map((c, i) => c - at[i])) / eye.pixelsPerRadian);
  else tell("There is nothing: click on the model.");
  showHint();
  drawStrokes();
}

function moved() {
  if (kept.length) tell("The strokes were dropped: they belong to one view.");
  kept = [];
  stroke = null;
  drawStrokes();
}

// ---- strokes

const colourOf = name => getComputedStyle(document.documentElement).getPropertyValue(name);

function drawStrokes() {
  const ink = strokes.getContext("2d");
  ink.clearRect(0, 0, strokes.width, strokes.height);
  ink.lineCap = ink.lineJoin = "round";
  for (const one of stroke ? [...kept, stroke] : kept) {
    const closed = one.tool === "lasso" || one.tool === "heavy";
    ink.beginPath();
    for (let i = 0; i < one.points.length; i += 2) ink.lineTo(one.points[i], one.points[i + 1]);
    if (closed && one !== stroke) ink.closePath();
    ink.lineWidth = PEN_PX[one.tool];
    ink.globalAlpha = one.tool === "lasso" ? 1 : 0.6;
    ink.strokeStyle = one.tool === "rest" || (closed && one.take) ? colourOf("--no") : one.tool === "part" ? colourOf("--yes") : colourOf("--region");
    ink.stroke();
  }
  ink.globalAlpha = 1;
  if (tool === "measure") ruler.draw(ink, point => eye.pixelOf(point));
  if (pen) drawPen(ink);
}

function drawPen(ink) {
  for (const [width, colour] of [[5, "#000c"], [2, "#fff"]]) {
    ink.lineWidth = width;
    ink.strokeStyle = colour;
    ink.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      ink.moveTo(pen[0] + 5 * dx, pen[1] + 5 * dy);
      ink.lineTo(pen[0] + 16 * dx, pen[1] + 16 * dy);
    }
    ink.stroke();
  }
}

function pixelOf(event) {
  const box = stage.getBoundingClientRect();
  return [Math.round(10 * (event.clientX - box.left) * strokes.width / box.width) / 10,
    Math.round(10 * (event.clientY - box.top) * strokes.height / box.height) / 10];
}

function extend(event) {
  const between = event.getCoalescedEvents ? event.getCoalescedEvents() : [];
  for (const one of between.length ? between : [event]) {
    const [x, y] = pixelOf(one), last = stroke.points.length;
    if (Math.hypot(x - stroke.points[last - 2], y - stroke.points[last - 1]) < 1.5) continue;
    if (last < 2 * STROKE_POINTS_MAX) stroke.points.push(x, y);
  }
  drawStrokes();
}

function finishStroke() {
  const done = stroke;
  stroke = null;
  send({ type: "stroke", view: eye.sharpView, tool: done.tool, points: done.points, width: PEN_PX[done.tool], take, through });
  if (done.tool === "part" || done.tool === "rest") kept.push(done);
  drawStrokes();
}

function startStroke(at) {
  if (eye.sharpView < 0) {
    tell("Wait until the picture is sharp.");
    return;
  }
  tell("");
  if (tool === "measure") {
    pick("measure", at);
    return;
  }
  stroke = { tool, take, points: [...at] };
  drawStrokes();
}

function showHint() {
  const pens = tool === "measure" ? "Space measures there" : "Space lowers and lifts it", measured = tool === "measure" ? ruler.text() : "";
  byId("hint").textContent = pen ? `${measured} Pen: arrow keys move it, ${pens}, Escape puts it away.` : measured || HINTS[tool];
}

// ---- the keyboard's pen

const PEN_KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function takePen(taken) {
  pen = taken ? [strokes.width / 2, strokes.height / 2] : null;
  stroke = null;
  showHint();
  drawStrokes();
}

// Returns whether the key was the pen's.
function penKey(key, fine) {
  if (PEN_KEYS[key]) {
    const step = fine ? 2 : 12;
    pen = pen.map((at, i) => Math.max(0, Math.min((i ? strokes.height : strokes.width) - 1, at + step * PEN_KEYS[key][i])));
    if (stroke && stroke.points.length < 2 * STROKE_POINTS_MAX) stroke.points.push(...pen);
    drawStrokes();
  } else if (key === " ") stroke ? finishStroke() : startStroke(pen);
  else if (key === "Escape" && stroke) { stroke = null; drawStrokes(); }
  else if (key === "Escape" || key === "p") takePen(false);
  else return false;
  return true;
}

stage.addEventListener("dblclick", event => {
  if (tool === "look" && eye.sharpView >= 0) pick("look", pixelOf(event));
});

// ---- buttons

function choose(group, button) {
  for (const one of group.querySelectorAll("[role=radio]")) {
    one.setAttribute("aria-checked", String(one === button));
    one.tabIndex = one === button ? 0 : -1;
  }
}

function radio(id, chosen) {
  const group = byId(id), buttons = [...group.querySelectorAll("[role=radio]")];
  const pick = button => { choose(group, button); chosen(button.dataset); };
  choose(group, buttons[0]);
  for (const button of buttons) button.addEventListener("click", () => pick(button));
  group.addEventListener("keydown", event => {
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const next = buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length];
    next.focus();
    pick(next);
  });
  return n => pick(buttons[n]);
}

const chooseTool = radio("tools", data => {
  tool = data.tool;
  stage.className = tool === "look" ? "looks" : "draws";
  takePen(false);
  showMarks();
});
const chooseSign = radio("sign", data => { take = data.take === "yes"; });
const chooseDepth = radio("depth", data => { through = data.through === "yes"; });

function showMarks() {
  byId("marks").hidden = !(tool === "part" || tool === "rest" || region.marks);
  byId("apply").disabled = byId("clear").disabled = !region.marks;
}

function showRegion() {
  byId("count").textContent = region.triangles.toLocaleString();
  byId("undo").disabled = !region.undo;
  byId("redo").disabled = !region.redo;
  byId("grow").disabled = byId("shrink").disabled = byId("smooth").disabled = !region.triangles;
  if (!region.marks && kept.length) { kept = []; drawStrokes(); }
  showMarks();
}

function apply() { tell(""); send({ type: "apply", view: eye.sharpView, take, through }); }
function clearStrokes() { kept = []; drawStrokes(); send({ type: "clear" }); }
byId("apply").addEventListener("click", apply);
byId("clear").addEventListener("click", clearStrokes);
for (const type of ["undo", "redo", "grow", "shrink", "smooth"])
  byId(type).addEventListener("click", () => { tell(""); send({ type }); });

// ---- keys

const REGION_KEYS = { g: "grow", h: "shrink", m: "smooth" };
const ZOOM_KEYS = { "+": 0.8, "=": 0.8, "-": 1.25 };
const TURN_KEYS = { ArrowLeft: [-30, 0], ArrowRight: [30, 0], ArrowUp: [0, -30], ArrowDown: [0, 30] };
document.addEventListener("keydown", event => {
  if (!eye.camera || event.target.matches("input, select") || document.querySelector("dialog[open]")) return;
  const key = keyOf(event), control = event.ctrlKey || event.metaKey;
  let done = true;
  if (pen && !control && document.activeElement === stage && penKey(key, event.shiftKey)) { event.preventDefault(); return; }
  if (control && key === "z") send({ type: event.shiftKey ? "redo" : "undo" });
  else if (control && key === "y") send({ type: "redo" });
  else if (control) done = false;
  else if (TURN_KEYS[key] && document.activeElement === stage) event.shiftKey ? eye.pan(...TURN_KEYS[key]) : eye.turn(...TURN_KEYS[key]);
  else if (key === "p" && tool !== "look") { stage.focus(); takePen(true); }
  else if (key >= "1" && key <= "6") chooseTool(Number(key) - 1);
  else if (key === "a" || key === "t") chooseSign(key === "t" ? 1 : 0);
  else if (key === "s" || key === "d") chooseDepth(key === "d" ? 1 : 0);
  else if (key === "Enter" && region.marks && document.activeElement === stage) apply();
  else if (key === "Escape") { stroke = null; clearStrokes(); }
  else if (ZOOM_KEYS[key] && document.activeElement === stage) eye.zoom(ZOOM_KEYS[key]);
  else if (REGION_KEYS[key]) send({ type: REGION_KEYS[key] });
  else done = false;
  if (done) event.preventDefault();
});

chooseTool(0);
setUpPart(send, tell);
loadSession().then(session => {
  showAccount(session);
  setUpPublishing();
  byId("no-save").hidden = may("editor");
  eye.connect();
}).catch(failure => {
  byId("connection").textContent = failure.message;
  byId("connection").classList.add("lost");
});
