/* The curator's page: sends the camera and finished strokes, shows the pictures that come back.
 * docs/curator.md has the messages. */
import { loadSession, may, token } from "./api.js";
import { showAccount } from "./account.js";
import { setUpPublishing } from "./publish.js";

const byId = id => document.getElementById(id);
const stage = byId("stage"), picture = byId("picture"), strokes = byId("strokes");
const FOV_DEG = 40, PIXELS_MAX = 1.4e6, SIDE_MAX = 2048, REST_MS = 150, STROKE_POINTS_MAX = 20000;
const PEN_PX = { part: 10, rest: 10, heavy: 34, lasso: 3 };
const HINTS = {
  look: "Drag to turn, right button or two fingers to move, wheel to zoom; double-click sets the middle.",
  lasso: "Go around the part. The right button still turns the model.",
  heavy: "Go around the part with the broad pen: its border is found under the stroke.",
  part: "Draw over the part, then over what is not in it, then press Find part.",
  rest: "Draw over what is not in the part, then press Find part.",
};

let socket, hello, tool = "look", take = false, through = false;
let view = 0, sharpView = -1, camera, restTimer, cameraChanged = false, openedId = "", parts = [];
let kept = [], stroke = null; // strokes that wait for Find part; the one being drawn
let region = { triangles: 0, undo: 0, redo: 0, marks: false };

// ---- messages

function send(message) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

function connect() {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket?token=${token()}`);
  socket.binaryType = "arraybuffer";
  socket.onmessage = event => typeof event.data === "string" ? onText(JSON.parse(event.data)) : onPicture(event.data);
  socket.onclose = () => {
    byId("connection").textContent = hello ? "Connection lost. What was not saved is gone; reload the page." : "No connection: is gopura-curator running?";
    byId("connection").classList.add("lost");
    loadSession().then(session => { if (session.role === "nobody") location.assign("/sign-in"); }).catch(() => {});
  };
}

function onText(message) {
  switch (message.type) {
  case "hello": begin(message); break;
  case "region": region = message; showRegion(); break;
  case "parts":
    parts = message.parts;
    if (message.saved) {
      openedId = message.saved;
      tell(`Saved. The next build of the content takes it up.`, true);
    }
    showParts();
    break;
  case "point": if (message.at) lookAt(message.at); break;
  case "error": tell(message.message); break;
  }
}

// Pictures are decoded in the order in which they came.
let decoding = Promise.resolve();
function onPicture(data) {
  const head = new DataView(data), of = head.getUint32(0, true), sharp = (head.getUint32(4, true) & 1) !== 0;
  const blob = new Blob([new Uint8Array(data, 8)], { type: "image/jpeg" });
  decoding = decoding.then(() => createImageBitmap(blob)).then(bitmap => {
    send({ type: "got" });
    if (of === view || !sharp) {
      picture.getContext("2d").drawImage(bitmap, 0, 0, picture.width, picture.height);
      if (sharp) sharpView = of;
      byId("quality").hidden = sharp;
    }
    bitmap.close();
  }).catch(() => tell("A picture could not be shown."));
}

function tell(text, good = false) {
  byId("message").textContent = text;
  byId("message").classList.toggle("good", good);
}

// ---- the camera: a point that it looks at, and angles and a distance from there

function eyeOf({ target, yaw, pitch, distance }) {
  return [target[0] + distance * Math.cos(pitch) * Math.cos(yaw),
    target[1] + distance * Math.cos(pitch) * Math.sin(yaw), target[2] + distance * Math.sin(pitch)];
}

function begin(message) {
  hello = message;
  byId("connection").textContent = "Connected";
  byId("name").textContent = message.name;
  document.title = `${message.name} – Gopura curator`;
  byId("language").replaceChildren(...message.languages.map(code => new Option(code, code)));
  const size = Math.hypot(...message.high.map((high, i) => high - message.low[i]));
  const middle = message.low.map((low, i) => (low + message.high[i]) / 2);
  const target = message.target || middle;
  const eye = message.eye || [middle[0] + 0.9 * size, middle[1] - 0.9 * size, middle[2] + 0.5 * size];
  const d = eye.map((e, i) => e - target[i]);
  const distance = Math.hypot(...d);
  camera = { target, distance, size, yaw: Math.atan2(d[1], d[0]), pitch: Math.asin(d[2] / distance) };
  resize();
}

function lookAt(point) {
  const eye = eyeOf(camera), d = eye.map((e, i) => e - point[i]);
  camera.target = point;
  camera.distance = Math.hypot(...d);
  camera.yaw = Math.atan2(d[1], d[0]);
  camera.pitch = Math.asin(d[2] / camera.distance);
  moved();
}

function sendCamera(moving) {
  view++;
  send({ type: "camera", view, eye: eyeOf(camera), target: camera.target, fov: FOV_DEG,
    width: picture.width, height: picture.height, moving });
}

function moved() {
  if (!camera) return;
  camera.pitch = Math.max(-1.5, Math.min(1.5, camera.pitch));
  camera.distance = Math.max(camera.size / 2000, Math.min(camera.size * 5, camera.distance));
  if (kept.length) tell("The strokes were dropped: they belong to one view.");
  kept = [];
  stroke = null;
  sharpView = -1;
  byId("quality").hidden = false;
  drawStrokes();
  if (!cameraChanged) {
    cameraChanged = true;
    requestAnimationFrame(() => { cameraChanged = false; sendCamera(true); });
  }
  clearTimeout(restTimer);
  restTimer = setTimeout(() => sendCamera(false), REST_MS);
}

function turn(dx, dy) {
  camera.yaw -= dx * 0.006;
  camera.pitch += dy * 0.006;
  moved();
}

// By pixels of the page, as if the target were dragged.
function pan(dx, dy) {
  const metres = 2 * camera.distance * Math.tan(FOV_DEG * Math.PI / 360) / stage.clientHeight;
  const right = [-Math.sin(camera.yaw), Math.cos(camera.yaw), 0];
  const up = [-Math.sin(camera.pitch) * Math.cos(camera.yaw), -Math.sin(camera.pitch) * Math.sin(camera.yaw), Math.cos(camera.pitch)];
  camera.target = camera.target.map((c, i) => c - metres * dx * right[i] + metres * dy * up[i]);
  moved();
}

function zoom(factor) {
  camera.distance *= factor;
  moved();
}

function resize() {
  const wide = stage.clientWidth, high = stage.clientHeight;
  if (!wide || !high) return;
  const scale = Math.min(devicePixelRatio, Math.sqrt(PIXELS_MAX / (wide * high)), SIDE_MAX / Math.max(wide, high));
  const width = Math.max(64, Math.floor(wide * scale / 2) * 2), height = Math.max(64, Math.floor(high * scale / 2) * 2);
  if (picture.width !== width || picture.height !== height) {
    picture.width = strokes.width = width;
    picture.height = strokes.height = height;
  }
  moved();
}

// ---- strokes

const colourOf = name => getComputedStyle(document.documentElement).getPropertyValue(name);

function drawStrokes() {
  const pen = strokes.getContext("2d");
  pen.clearRect(0, 0, strokes.width, strokes.height);
  pen.lineCap = pen.lineJoin = "round";
  for (const one of stroke ? [...kept, stroke] : kept) {
    const closed = one.tool === "lasso" || one.tool === "heavy";
    pen.beginPath();
    for (let i = 0; i < one.points.length; i += 2) pen.lineTo(one.points[i], one.points[i + 1]);
    if (closed && one !== stroke) pen.closePath();
    pen.lineWidth = PEN_PX[one.tool];
    pen.globalAlpha = one.tool === "lasso" ? 1 : 0.6;
    pen.strokeStyle = one.tool === "rest" || (closed && one.take) ? colourOf("--no") : one.tool === "part" ? colourOf("--yes") : colourOf("--region");
    pen.stroke();
  }
  pen.globalAlpha = 1;
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
  send({ type: "stroke", view: sharpView, tool: done.tool, points: done.points, width: PEN_PX[done.tool], take, through });
  if (done.tool === "part" || done.tool === "rest") kept.push(done);
  drawStrokes();
}

function startStroke(event) {
  if (sharpView < 0) {
    tell("Wait until the picture is sharp.");
    return;
  }
  tell("");
  stroke = { tool, take, points: pixelOf(event) };
  drawStrokes();
}

// ---- pointers: one finger or button draws or turns, two fingers move and zoom

const pointers = new Map();

function spread() {
  const [a, b] = [...pointers.values()];
  return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, d: Math.max(20, Math.hypot(a.x - b.x, a.y - b.y)) };
}

stage.addEventListener("pointerdown", event => {
  if (!camera) return;
  stage.setPointerCapture(event.pointerId);
  stage.focus({ preventScroll: true });
  pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button });
  if (pointers.size > 1) {
    stroke = null;
    drawStrokes();
  } else if (tool !== "look" && event.button === 0) {
    startStroke(event);
  }
});

stage.addEventListener("pointermove", event => {
  const at = pointers.get(event.pointerId);
  if (!at) return;
  const dx = event.clientX - at.x, dy = event.clientY - at.y;
  if (pointers.size === 2) {
    const before = spread();
    at.x = event.clientX;
    at.y = event.clientY;
    const after = spread();
    pan(after.x - before.x, after.y - before.y);
    zoom(before.d / after.d);
    return;
  }
  at.x = event.clientX;
  at.y = event.clientY;
  if (stroke) extend(event);
  else if (tool === "look" ? at.button === 0 && !event.shiftKey : at.button === 2) turn(dx, dy);
  else if (tool === "look" || at.button === 1) pan(dx, dy);
});

function lift(event) {
  pointers.delete(event.pointerId);
  if (stroke && event.type === "pointerup") finishStroke();
  else if (stroke) { stroke = null; drawStrokes(); }
}
stage.addEventListener("pointerup", lift);
stage.addEventListener("pointercancel", lift);
stage.addEventListener("contextmenu", event => event.preventDefault());
stage.addEventListener("wheel", event => {
  event.preventDefault();
  if (camera) zoom(Math.exp(Math.max(-240, Math.min(240, event.deltaY * (event.deltaMode ? 30 : 1))) * 0.0015));
}, { passive: false });
stage.addEventListener("dblclick", event => {
  if (tool === "look" && sharpView >= 0) send({ type: "pick", view: sharpView, points: pixelOf(event) });
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
  byId("hint").textContent = HINTS[tool];
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
  byId("grow").disabled = byId("shrink").disabled = byId("save").disabled = !region.triangles;
  if (!may("editor")) byId("save").disabled = true;
  if (!region.marks && kept.length) { kept = []; drawStrokes(); }
  showMarks();
}

function apply() { tell(""); send({ type: "apply", view: sharpView, take, through }); }
function clearStrokes() { kept = []; drawStrokes(); send({ type: "clear" }); }
byId("apply").addEventListener("click", apply);
byId("clear").addEventListener("click", clearStrokes);
for (const type of ["undo", "redo", "grow", "shrink"])
  byId(type).addEventListener("click", () => { tell(""); send({ type }); });

// ---- parts

function showParts() {
  const opened = parts.find(part => part.id === openedId);
  byId("heading").textContent = opened ? `Part: ${opened.title || opened.id}` : "New part";
  byId("parts").replaceChildren(...parts.map(part => {
    const item = document.createElement("li"), button = document.createElement("button"), small = document.createElement("small");
    button.type = "button";
    button.textContent = part.title || part.id;
    small.textContent = part.faces ? part.id : `${part.id} – a shape, not marked faces`;
    button.disabled = !part.faces;
    button.setAttribute("aria-current", String(part.id === openedId));
    button.append(small);
    button.addEventListener("click", () => {
      openedId = part.id;
      byId("title").value = part.title;
      tell("");
      send({ type: "open", id: part.id });
      showParts();
    });
    item.append(button);
    return item;
  }));
}

// A new part's id comes from its title, if that has Latin letters.
function idFor(title) {
  const base = title.normalize("NFD").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 56) || "part";
  let id = base;
  for (let n = 2; parts.some(part => part.id === id); n++) id = `${base}-${n}`;
  return id;
}

byId("part").addEventListener("submit", event => {
  event.preventDefault();
  const title = byId("title").value.trim();
  tell("");
  send({ type: "save", id: openedId || idFor(title), title, language: byId("language").value });
});
byId("fresh").addEventListener("click", () => {
  openedId = "";
  byId("title").value = "";
  tell("");
  send({ type: "empty" });
  showParts();
  byId("title").focus();
});

// ---- keys

const ZOOM_KEYS = { "+": 0.8, "=": 0.8, "-": 1.25 };
const TURN_KEYS = { ArrowLeft: [-30, 0], ArrowRight: [30, 0], ArrowUp: [0, -30], ArrowDown: [0, 30] };
document.addEventListener("keydown", event => {
  if (!camera || event.target.matches("input, select") || document.querySelector("dialog[open]")) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, control = event.ctrlKey || event.metaKey;
  let done = true;
  if (control && key === "z") send({ type: event.shiftKey ? "redo" : "undo" });
  else if (control && key === "y") send({ type: "redo" });
  else if (control) done = false;
  else if (TURN_KEYS[key] && document.activeElement === stage) event.shiftKey ? pan(...TURN_KEYS[key]) : turn(...TURN_KEYS[key]);
  else if (key >= "1" && key <= "5") chooseTool(Number(key) - 1);
  else if (key === "a" || key === "t") chooseSign(key === "t" ? 1 : 0);
  else if (key === "s" || key === "d") chooseDepth(key === "d" ? 1 : 0);
  else if (key === "Enter" && region.marks && document.activeElement === stage) apply();
  else if (key === "Escape") { stroke = null; clearStrokes(); }
  else if (ZOOM_KEYS[key] && document.activeElement === stage) zoom(ZOOM_KEYS[key]);
  else if (key === "g" || key === "h") send({ type: key === "g" ? "grow" : "shrink" });
  else done = false;
  if (done) event.preventDefault();
});

chooseTool(0);
new ResizeObserver(() => { if (camera) resize(); }).observe(stage);
loadSession().then(session => {
  showAccount(session);
  setUpPublishing();
  byId("no-save").hidden = may("editor");
  connect();
}).catch(failure => {
  byId("connection").textContent = failure.message;
  byId("connection").classList.add("lost");
});
