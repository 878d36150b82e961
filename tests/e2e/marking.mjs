// Curators who mark parts at the same time, in real browsers.
//
//     node tests/e2e/marking.mjs PORT PROCESS_OF_THE_PROGRAM FOLDER
//
// FOLDER gets pictures, and has the content.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { openBrowser } from "../tools/browser.mjs";

const [port, program, folder] = process.argv.slice(2), home = `http://127.0.0.1:${port}`;
const CONTROL = 2;

// ---- one curator

async function signIn(browser, name) {
  await browser.go(`${home}/sign-in`);
  const status = await browser.evaluate(`fetch("/api/session", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ name: "${name}", password: "password of ${name}" }) }).then(answer => answer.status)`);
  assert.equal(status, 200);
}

async function come(browser) {
  await browser.go(home);
  await browser.until(`document.querySelector("#connection")?.textContent === "Connected" && document.querySelector("#quality").hidden && document.querySelectorAll("#parts li").length > 0`, "the sharp picture");
}

const text = (browser, selector) => browser.evaluate(`document.querySelector("${selector}").textContent`);
const heading = browser => text(browser, "#heading");
const count = browser => browser.evaluate(`Number(document.querySelector("#count").textContent.replace(/\\D/g, ""))`);
const value = browser => browser.evaluate(`document.querySelector("#title").value`);
const write = (browser, words) => browser.evaluate(`(() => { const field = document.querySelector("#title"); field.value = ${JSON.stringify(words)}; field.dispatchEvent(new Event("input")); })()`);
const language = (browser, code) => browser.evaluate(`(() => { const field = document.querySelector("#language"); field.value = "${code}"; field.dispatchEvent(new Event("change")); })()`);
const saved = browser => browser.until(`/^Saved/.test(document.querySelector("#message").textContent)`, "saving");
const press = (browser, words) => browser.evaluate(`[...document.querySelectorAll("#message button")].find(one => one.textContent === "${words}").click()`);
const listed = (browser, id) => `[...document.querySelectorAll("#parts li > button")].find(one => one.querySelector("small").textContent === "${id}")`;

// Draws a lasso around the middle; radius: a share of half the picture's height.
async function mark(browser, radius) {
  const before = await count(browser);
  await browser.evaluate(`document.querySelector("[data-tool=lasso]").click()`);
  await browser.until(`document.querySelector("#quality").hidden`, "the sharp picture");
  const [x, y, r] = await browser.evaluate(`(() => { const box = document.querySelector("#stage").getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2, box.height / 2]; })()`);
  for (let n = 0; n <= 40; n++)
    await browser.send("Input.dispatchMouseEvent", { type: n === 0 ? "mousePressed" : n === 40 ? "mouseReleased" : "mouseMoved", x: x + radius * r * Math.cos(n * Math.PI / 20), y: y + radius * r * Math.sin(n * Math.PI / 20), button: "left", buttons: n === 40 ? 0 : 1, clickCount: 1 });
  await browser.until(`Number(document.querySelector("#count").textContent.replace(/\\D/g, "")) !== ${before}`, "a region");
  return count(browser);
}

async function begin(browser) {
  await browser.click("#fresh");
  await browser.until(`document.querySelector("#heading").textContent === "New part" && document.querySelector("#count").textContent === "0"`, "a new part");
}

async function open(browser, id) {
  await browser.evaluate(`${listed(browser, id)}.click()`);
  await browser.until(`${listed(browser, id)}?.getAttribute("aria-current") === "true"`, id);
}

// Saves a new part and returns its id.
async function saveNew(browser, words, radius) {
  await begin(browser);
  await mark(browser, radius);
  await write(browser, words);
  await browser.click("#save");
  await saved(browser);
  return browser.evaluate(`document.querySelector("#message a").hash.slice(1)`);
}

// ---- what is saved

const parts = () => JSON.parse(readFileSync(`${folder}/content/parts.json`, "utf8")).parts;
const part = id => parts().find(one => one.id === id);
const faces = id => readFileSync(`${folder}/content/regions/${id}.faces`, "utf8");

async function change(browser, method, path, body) {
  const status = await browser.evaluate(`fetch("/api/session").then(answer => answer.json()).then(session => fetch("${path}", { method: "${method}", headers: { "Content-Type": "application/json", "X-Gopura-Token": session.token }, body: ${body ? JSON.stringify(JSON.stringify(body)) : "undefined"} })).then(answer => answer.status)`);
  assert.equal(status, 200, path);
}

// ---- claims

// Titles without Latin letters want one id.
async function twoNewParts(ana, petra) {
  assert.deepEqual([await saveNew(ana, "ទ្វារ", 0.1), await saveNew(petra, "ប៉ម", 0.2)], ["part", "part-2"]);
  assert.deepEqual(["part", "part-2"].map(id => part(id).title), [{ en: "ទ្វារ" }, { en: "ប៉ម" }]);
  assert.notEqual(faces("part"), faces("part-2"));
}

async function onePart(ana, petra) {
  await open(ana, "part");
  await come(petra);
  await open(petra, "part");
  await mark(petra, 0.3);
  await petra.click("#save");
  await saved(petra);
  const theirs = faces("part");
  const mine = await mark(ana, 0.25);
  await ana.click("#save");
  await ana.until(`/meanwhile/.test(document.querySelector("#message").textContent)`, "the conflict");
  await ana.picture(`${folder}/conflict.png`);
  assert.equal(faces("part"), theirs);
  assert.equal(await count(ana), mine, "what was marked is still there");
  await press(ana, "Save as a new part");
  await saved(ana);
  assert.equal(faces("part"), theirs);
  assert.notEqual(faces("part-3"), theirs);
  // Or knowingly.
  await open(ana, "part");
  await mark(petra, 0.4);
  await petra.click("#save");
  await saved(petra);
  await mark(ana, 0.5);
  await ana.click("#save");
  await ana.until(`/meanwhile/.test(document.querySelector("#message").textContent)`, "the conflict");
  await press(ana, "Replace theirs");
  await saved(ana);
  assert.notEqual(faces("part"), theirs);
}

async function removedPart(ana, petra) {
  const before = part("part-3");
  await open(ana, "part-2");
  await change(petra, "DELETE", "/api/parts/part-2");
  await mark(ana, 0.45);
  await ana.click("#save");
  await ana.until(`/removed/.test(document.querySelector("#message").textContent) && !${listed(ana, "part-2")}`, "that it is gone");
  assert.equal(part("part-2"), undefined);
  await press(ana, "Save as a new part");
  await saved(ana);
  assert.deepEqual(part("part-2").title, { en: "ប៉ម" });
  // What cannot be opened is not open.
  await open(ana, "part-3");
  await mark(ana, 0.35);
  await change(petra, "DELETE", "/api/parts/part");
  await ana.evaluate(`${listed(ana, "part")}.click()`);
  await ana.until(`/removed/.test(document.querySelector("#message").textContent) && !${listed(ana, "part")}`, "that it is gone");
  assert.match(await heading(ana), /ទ្វារ/);
  await ana.click("#save");
  await saved(ana);
  assert.equal(part("part"), undefined);
  assert.deepEqual(part("part-3"), before);
}

async function lateAnswers(ana) {
  const gate = await saveNew(ana, "Gate", 0.3), before = faces(gate);
  await mark(ana, 0.4);
  await ana.evaluate(`document.querySelector("#save").click(); document.querySelector("#fresh").click(); document.querySelector("#title").value = "Door";`);
  await ana.until(`document.querySelector("#heading").textContent === "New part" && document.querySelector("#count").textContent === "0" && /^Saved/.test(document.querySelector("#message").textContent)`, "both answers");
  assert.equal(await value(ana), "Door", "what is typed before an answer comes");
  const after = faces(gate);
  assert.notEqual(after, before);
  await mark(ana, 0.15);
  await ana.click("#save");
  await saved(ana);
  assert.deepEqual([part("gate").title, part("door").title], [{ en: "Gate" }, { en: "Door" }]);
  assert.equal(faces(gate), after);
  // Undoing does not lead to what another part has.
  await open(ana, "gate");
  const opened = await count(ana);
  assert.ok(await ana.evaluate(`document.querySelector("#undo").disabled`));
  await ana.key("z", CONTROL, 90);
  await ana.evaluate(`document.querySelector("#grow").click()`);
  await ana.until(`!document.querySelector("#undo").disabled`, "growing");
  await ana.click("#undo");
  await ana.until(`document.querySelector("#undo").disabled`, "undoing");
  assert.equal(await count(ana), opened);
}

async function titles(ana, petra) {
  const before = part("lotus-crown").title, long = "ទ".repeat(200), box = "a box or ball so far, not marked";
  await language(ana, "fr");
  await ana.evaluate(`[...document.querySelectorAll("#parts li > button")].find(one => one.firstChild.textContent === ${JSON.stringify(before.en)}).click()`);
  await ana.until(`document.querySelector("#title").value === ${JSON.stringify(before.fr)}`, "the title in the chosen language");
  assert.equal(await count(ana), 0, box);
  await language(ana, "en");
  assert.equal(await value(ana), before.en);
  await language(ana, "fr");
  // A colleague corrects a title meanwhile, and makes another one as long as the pages let him.
  await change(petra, "POST", "/api/parts/lotus-crown/texts", { changes: [{ field: "title", language: "fr", from: before.fr, to: "Le lotus" }, { field: "title", language: "km", from: before.km, to: long }] });
  await mark(ana, 0.2);
  await ana.click("#save");
  await saved(ana);
  assert.equal(part("lotus-crown").region.kind, "faces");
  assert.deepEqual(part("lotus-crown").title, { ...before, fr: "Le lotus", km: long });
  await language(ana, "km");
  assert.equal(await value(ana), long);
  await mark(ana, 0.3);
  await ana.click("#save");
  await saved(ana);
  // What is typed is written in its language, but not over a title that nobody here has seen.
  await language(ana, "fr");
  await write(ana, "La fleur");
  await ana.click("#save");
  await saved(ana);
  assert.deepEqual(part("lotus-crown").title, { ...before, fr: "La fleur", km: long });
  await change(petra, "POST", "/api/parts/lotus-crown/texts", { changes: [{ field: "title", language: "fr", from: "La fleur", to: "Le lotus" }] });
  await write(ana, "Une fleur");
  await ana.click("#save");
  await ana.until(`/Le lotus/.test(document.querySelector("#message").textContent)`, "the conflict");
  assert.equal(part("lotus-crown").title.fr, "Le lotus");
  await press(ana, "Replace theirs");
  await saved(ana);
  assert.equal(part("lotus-crown").title.fr, "Une fleur");
  await language(ana, "en");
}

async function questions(petra) {
  const asks = () => petra.dialogs.splice(0), leave = "What you marked is not saved. Leave it?";
  const publishLine = async () => {
    await petra.click("#open-publish");
    const shown = await petra.evaluate(`document.querySelector("#publish-unsaved").checkVisibility()`);
    await petra.picture(`${folder}/publish.png`);
    await petra.click("#close-publish");
    return shown;
  };
  await come(petra);
  await saveNew(petra, "Asked", 0.2);
  asks();
  assert.equal(await publishLine(), false);
  await open(petra, "door");
  assert.deepEqual(asks(), [], "nothing would be lost");
  const marked = await mark(petra, 0.5);
  assert.equal(await publishLine(), true);
  petra.dialogs.accept = false;
  await petra.click(".places a[href='/information']");
  await petra.until(`location.pathname === "/"`);
  assert.deepEqual(asks(), [""]); // the browser's own question
  await petra.evaluate(`${listed(petra, "asked")}.click()`);
  await petra.click("#fresh");
  assert.deepEqual(asks(), [leave, leave]);
  assert.equal(await count(petra), marked);
  assert.equal(await heading(petra), "Part: Door");
  await petra.click("#sign-out");
  assert.deepEqual(asks(), ["What is not saved is lost. Sign out all the same?"]);
  await petra.sleep(500);
  assert.equal(await text(petra, "#connection"), "Connected");
  petra.dialogs.accept = true;
  await petra.click("#save");
  await saved(petra);
  await petra.click(".places a[href='/information']");
  await petra.until(`location.pathname === "/information"`, "the other page");
  assert.deepEqual(asks(), []);
  // The way back leads to a page that works.
  await petra.evaluate(`history.back()`);
  await petra.until(`location.pathname === "/" && document.querySelector("#connection").textContent === "Connected" && document.querySelector("#quality").hidden`, "the page again");
}

// Pictures that cannot be decoded hold no other ones up.
async function badPictures(ana) {
  await come(ana);
  await ana.evaluate(`(() => { const real = createImageBitmap; let bad = 3; window.createImageBitmap = (...all) => bad-- > 0 ? Promise.reject(new Error("no memory")) : real(...all); })()`);
  await ana.evaluate(`document.querySelector("[data-tool=look]").click()`);
  for (let n = 0; n < 12; n++) {
    await ana.evaluate(`document.querySelector("#stage").focus()`);
    await ana.key("ArrowLeft", 0, 37);
    await ana.sleep(100);
  }
  await ana.until(`document.querySelector("#quality").hidden`, "a sharp picture");
}

// The program takes eight; then it ends.
async function noRoom(ana, petra) {
  await mark(petra, 0.3);
  await ana.go(`${home}/information`);
  for (let n = 0; !/ 1 are\n$/.test(readFileSync(`${folder}/curator.log`, "utf8")); n++) {
    assert.ok(n < 600, "petra's browser is not the only one that shows the model");
    await ana.sleep(100);
  }
  await petra.evaluate(`fetch("/api/session").then(answer => answer.json()).then(session => Promise.all(Array.from({ length: 7 }, () => new Promise(done => { const socket = new WebSocket("ws://" + location.host + "/socket?token=" + session.token); socket.onmessage = done; (window.sockets ||= []).push(socket); }))))`);
  await ana.go(home);
  await ana.until(`/close one/.test(document.querySelector("#connection").textContent)`, "why there is no picture");
  assert.ok(await ana.evaluate(`document.querySelector("#save").disabled`));
  process.kill(Number(program));
  await petra.until(`/Connection lost/.test(document.querySelector("#connection").textContent)`, "the end");
  assert.deepEqual(await petra.evaluate(`["save", "fresh", "undo", "grow"].map(id => document.querySelector("#" + id).disabled)`), [true, true, true, true]);
  await petra.picture(`${folder}/lost.png`);
}

const ana = await openBrowser(), petra = await openBrowser({ width: 1024, height: 768, dark: true });
try {
  await signIn(ana, "ana");
  await signIn(petra, "petra");
  await come(ana);
  await come(petra);
  for (const claim of [twoNewParts, onePart, removedPart, lateAnswers, titles]) await claim(ana, petra);
  await questions(petra);
  await badPictures(ana);
  assert.ok(!existsSync(`${folder}/content/regions/part.faces`));
  // The browser remarks on the answer 409 to what would change, as there is no release.
  assert.deepEqual([...ana.complaints, ...petra.complaints].filter(complaint => !/status of 409/.test(complaint)), []);
  await noRoom(ana, petra);
} catch (failure) {
  for (const [name, browser] of [["ana", ana], ["petra", petra]]) {
    await browser.picture(`${folder}/failed-${name}.png`);
    console.error(name, browser.complaints, await browser.evaluate(`document.body.innerText`));
  }
  throw failure;
} finally {
  await ana.close();
  await petra.close();
}
