// The model as the program draws it: the socket, the camera, and what turns it. The pages that show the model use it.
import { ask, token } from "./api.js";

const FOV_DEG = 40, PIXELS_MAX = 1.4e6, SIDE_MAX = 2048, REST_MS = 150;

export class Eye {
  // canvases: the first gets the pictures, all get their size. on: text(message), moved(), tell(sentence),
  // closed(wasOpen, reason), where the reason is "" unless the program gave one; perhaps unsaved(), press(event, fingers),
  // drag(event, button), which returns true if it does not turn, and lift(event).
  constructor(stage, canvases, quality, on) {
    Object.assign(this, { stage, canvases, quality, on, view: 0, sharpView: -1, camera: null, decoding: Promise.resolve(), pointers: new Map() });
    this.listen();
    // A browser keeps a page that was left for the way back, and its socket with it, which is one of a few.
    addEventListener("pagehide", () => this.socket?.close());
    addEventListener("pageshow", event => { if (event.persisted && !this.on.unsaved?.()) location.reload(); });
  }

  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  connect() {
    this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket?token=${token()}`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = event => {
      if (typeof event.data !== "string") { this.show(event.data); return; }
      const message = JSON.parse(event.data);
      if (message.type === "error") message.message = message.message[0].toUpperCase() + message.message.slice(1);
      this.on.text(message);
    };
    this.socket.onclose = event => {
      this.on.closed(Boolean(this.camera), event.reason);
      // What is not saved yet stays with the role that it was begun with: the server judges when it is saved.
      ask("GET", "/api/session").then(({ role }) => { if (role === "nobody" && !this.on.unsaved?.()) location.assign("/sign-in"); }).catch(() => {});
    };
  }

  // Pictures are decoded in the order in which they came.
  show(data) {
    const head = new DataView(data), of = head.getUint32(0, true), sharp = (head.getUint32(4, true) & 1) !== 0;
    const blob = new Blob([new Uint8Array(data, 8)], { type: "image/jpeg" }), [picture] = this.canvases;
    // One that cannot be decoded has come too: the next ones would wait for it.
    this.decoding = this.decoding.then(() => createImageBitmap(blob)).finally(() => this.send({ type: "got" })).then(bitmap => {
      if (of === this.view || !sharp) {
        picture.getContext("2d").drawImage(bitmap, 0, 0, picture.width, picture.height);
        if (sharp) this.sharpView = of;
        this.quality.hidden = sharp || this.flies;
      }
      bitmap.close();
    }).catch(() => this.on.tell("A picture could not be shown."));
  }

  // ---- the camera: a point that it looks at, and angles and a distance from there

  get position() {
    const { target, yaw, pitch, distance } = this.camera;
    return [target[0] + distance * Math.cos(pitch) * Math.cos(yaw),
      target[1] + distance * Math.cos(pitch) * Math.sin(yaw), target[2] + distance * Math.sin(pitch)];
  }

  // The message "hello" has the model's size, and perhaps an eye.
  begin(hello) {
    const size = Math.hypot(...hello.high.map((high, i) => high - hello.low[i]));
    const middle = hello.low.map((low, i) => (low + hello.high[i]) / 2);
    this.camera = { size };
    this.place(hello.eye || [middle[0] + 0.9 * size, middle[1] - 0.9 * size, middle[2] + 0.5 * size], hello.target || middle);
    this.resize();
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  place(eye, target) {
    const d = eye.map((e, i) => e - target[i]), distance = Math.max(1e-6, Math.hypot(...d));
    Object.assign(this.camera, { target, distance, yaw: Math.atan2(d[1], d[0]), pitch: Math.asin(d[2] / distance) });
  }

  lookFrom(eye, target) {
    this.place(eye, target);
    this.moved();
  }

  lookAt(point) {
    this.lookFrom(this.position, point);
  }

  // How many pixels of the picture a metre covers at a metre from the eye.
  get pixelsPerRadian() {
    return this.canvases[0].height / (2 * Math.tan(FOV_DEG * Math.PI / 360));
  }

  // Where a point is in the picture, in its pixels; null: behind the eye.
  pixelOf(point) {
    const { yaw, pitch } = this.camera, eye = this.position, d = point.map((c, i) => c - eye[i]);
    const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
    const up = [-Math.sin(pitch) * Math.cos(yaw), -Math.sin(pitch) * Math.sin(yaw), Math.cos(pitch)];
    const dot = axis => axis.reduce((sum, c, i) => sum + c * d[i], 0);
    const far = -dot(back), [{ width, height }] = this.canvases;
    if (far <= 0) return null;
    const scale = this.pixelsPerRadian / far;
    return [width / 2 + scale * (Math.cos(yaw) * d[1] - Math.sin(yaw) * d[0]), height / 2 - scale * dot(up)];
  }

  sendCamera(moving) {
    const [picture] = this.canvases;
    this.view++;
    this.send({ type: "camera", view: this.view, eye: this.position, target: this.camera.target, fov: FOV_DEG,
      width: picture.width, height: picture.height, moving });
  }

  moved() {
    const camera = this.camera;
    if (!camera) return;
    camera.pitch = Math.max(-1.5, Math.min(1.5, camera.pitch));
    camera.distance = Math.max(camera.size / 2000, Math.min(camera.size * 5, camera.distance));
    this.sharpView = -1;
    this.quality.hidden = Boolean(this.flies);
    this.on.moved();
    if (!this.changed) {
      this.changed = true;
      requestAnimationFrame(() => { this.changed = false; this.sendCamera(true); });
    }
    clearTimeout(this.restTimer);
    this.restTimer = setTimeout(() => this.sendCamera(false), REST_MS);
  }

  turn(dx, dy) {
    this.camera.yaw -= dx * 0.006;
    this.camera.pitch += dy * 0.006;
    this.moved();
  }

  // By pixels of the page, as if the target were dragged.
  pan(dx, dy) {
    const { distance, yaw, pitch, target } = this.camera;
    const metres = 2 * distance * Math.tan(FOV_DEG * Math.PI / 360) / this.stage.clientHeight;
    const right = [-Math.sin(yaw), Math.cos(yaw), 0];
    const up = [-Math.sin(pitch) * Math.cos(yaw), -Math.sin(pitch) * Math.sin(yaw), Math.cos(pitch)];
    this.camera.target = target.map((c, i) => c - metres * dx * right[i] + metres * dy * up[i]);
    this.moved();
  }

  zoom(factor) {
    this.camera.distance *= factor;
    this.moved();
  }

  resize() {
    const wide = this.stage.clientWidth, high = this.stage.clientHeight;
    if (!wide || !high) return;
    const scale = Math.min(devicePixelRatio, Math.sqrt(PIXELS_MAX / (wide * high)), SIDE_MAX / Math.max(wide, high));
    const width = Math.max(64, Math.floor(wide * scale / 2) * 2), height = Math.max(64, Math.floor(high * scale / 2) * 2);
    for (const canvas of this.canvases)
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    this.moved();
  }

  // ---- pointers: one finger or button turns, or what the page makes of it; two fingers move and zoom

  spread() {
    const [a, b] = [...this.pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, d: Math.max(20, Math.hypot(a.x - b.x, a.y - b.y)) };
  }

  press(event) {
    if (!this.camera) return;
    this.stage.setPointerCapture(event.pointerId);
    this.stage.focus({ preventScroll: true });
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button });
    this.on.press?.(event, this.pointers.size);
  }

  drag(event) {
    const at = this.pointers.get(event.pointerId);
    if (!at) return;
    const dx = event.clientX - at.x, dy = event.clientY - at.y, before = this.pointers.size === 2 ? this.spread() : null;
    at.x = event.clientX;
    at.y = event.clientY;
    if (before) {
      const after = this.spread();
      this.pan(after.x - before.x, after.y - before.y);
      this.zoom(before.d / after.d);
    } else if (!this.on.drag?.(event, at.button)) {
      if (at.button === 1 || (at.button === 0 && event.shiftKey)) this.pan(dx, dy);
      else this.turn(dx, dy);
    }
  }

  listen() {
    const stage = this.stage, lift = event => { this.pointers.delete(event.pointerId); this.on.lift?.(event); };
    stage.addEventListener("pointerdown", event => this.press(event));
    stage.addEventListener("pointermove", event => this.drag(event));
    stage.addEventListener("pointerup", lift);
    stage.addEventListener("pointercancel", lift);
    stage.addEventListener("contextmenu", event => event.preventDefault());
    stage.addEventListener("wheel", event => {
      event.preventDefault();
      if (this.camera) this.zoom(Math.exp(Math.max(-240, Math.min(240, event.deltaY * (event.deltaMode ? 30 : 1))) * 0.0015));
    }, { passive: false });
  }
}
