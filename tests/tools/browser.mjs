// A headless Chromium for tests of pages, over the DevTools protocol on a pipe; Node.js alone, no packages.
//
//     import { openBrowser } from "../tools/browser.mjs";
//     const browser = await openBrowser({ width: 1280, height: 800 });
//     await browser.go("http://127.0.0.1:8780/");
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export async function openBrowser({ width = 1280, height = 800, dark = false, touch = false } = {}) {
  const profile = mkdtempSync(join(tmpdir(), "gopura-browser-"));
  const child = spawn("chromium", ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", `--user-data-dir=${profile}`, `--window-size=${width},${height}`, "--remote-debugging-pipe", "about:blank"],
    { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  const waiting = new Map(), complaints = [], dialogs = Object.assign([], { accept: true });
  let last = 0, input = "", session;

  child.stdio[4].on("data", data => {
    const pieces = (input + data).split("\0");
    input = pieces.pop();
    for (const piece of pieces) hear(JSON.parse(piece));
  });
  function hear(message) {
    if (message.id && waiting.has(message.id)) {
      const { resolve, reject } = waiting.get(message.id);
      waiting.delete(message.id);
      if (message.error) reject(new Error(message.error.message));
      else resolve(message.result);
    }
    if (message.method === "Runtime.exceptionThrown") complaints.push(message.params.exceptionDetails.exception?.description || message.params.exceptionDetails.text);
    if (message.method === "Log.entryAdded" && message.params.entry.level === "error") complaints.push(`${message.params.entry.text} ${message.params.entry.url || ""}`);
    if (message.method === "Page.javascriptDialogOpening") {
      dialogs.push(message.params.message);
      send("Page.handleJavaScriptDialog", { accept: dialogs.accept });
    }
  }
  function send(method, params = {}, own = session) {
    const id = ++last;
    child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId: own || undefined })}\0`);
    return new Promise((resolve, reject) => waiting.set(id, { resolve, reject }));
  }

  const { targetInfos } = await send("Target.getTargets");
  const target = targetInfos.find(one => one.type === "page");
  ({ sessionId: session } = await send("Target.attachToTarget", { targetId: target.targetId, flatten: true }));
  for (const domain of ["Page", "Runtime", "Log"]) await send(`${domain}.enable`);
  // May be changed while a page is shown.
  async function look({ width, height, dark = false, touch = false }) {
    await send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    await send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }, { name: "pointer", value: touch ? "coarse" : "fine" }] });
    await send("Emulation.setTouchEmulationEnabled", { enabled: touch });
  }
  await look({ width, height, dark, touch });

  const sleep = ms => new Promise(resolve => setTimeout(resolve, ms));
  async function evaluate(expression) {
    const answer = await send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description || answer.exceptionDetails.text);
    return answer.result.value;
  }
  return {
    dialogs, // what was asked; dialogs.accept is the answer
    complaints, // what the page's scripts threw, and what it could not load
    send, evaluate, sleep, look,
    go: async url => { await send("Page.navigate", { url }); await sleep(300); },
    // Waits until an expression is true.
    until: async (expression, what = expression, ms = 60000) => {
      for (const end = Date.now() + ms; !(await evaluate(`Boolean(${expression})`).catch(() => false)); await sleep(50))
        if (Date.now() > end) throw new Error(`not within ${ms} ms: ${what}`);
    },
    click: async selector => {
      const [x, y] = await evaluate(`(() => { const e = document.querySelector(${JSON.stringify(selector)}); e.scrollIntoView({ block: "nearest" }); const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()`);
      for (const type of ["mousePressed", "mouseReleased"]) await send("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1 });
    },
    type: text => send("Input.insertText", { text }),
    key: async (key, modifiers = 0, code = 0) => {
      const text = { Enter: "\r", " ": " " }[key]; // what presses a button
      for (const type of ["keyDown", "keyUp"]) await send("Input.dispatchKeyEvent", { type, key, code: key, modifiers, windowsVirtualKeyCode: code, ...(type === "keyDown" && text ? { text } : {}) });
    },
    picture: async path => writeFileSync(path, Buffer.from((await send("Page.captureScreenshot", { format: "png" })).data, "base64")),
    close: async () => {
      const ended = new Promise(resolve => child.once("exit", resolve));
      send("Browser.close", {}, null).catch(() => {});
      await Promise.race([ended, sleep(5000)]);
      child.kill("SIGKILL");
      rmSync(profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
    },
  };
}
