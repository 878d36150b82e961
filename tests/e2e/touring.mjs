// A curator at the page on which tours are made, in a real browser.
//
//     node tests/e2e/touring.mjs PORT FOLDER_FOR_PICTURES
import assert from "node:assert/strict";
import { openBrowser } from "../tools/browser.mjs";

const [port, folder] = process.argv.slice(2), home = `http://127.0.0.1:${port}`;
const ALT = 1, CONTROL = 2;

async function signIn(browser, name) {
  const status = await browser.evaluate(`fetch("/api/session", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ name: "${name}", password: "password of ${name}" }) }).then(answer => answer.status)`);
  assert.equal(status, 200);
}

async function open(browser, tour) {
  await browser.go("about:blank"); // else only the address' end changes
  await browser.go(`${home}/tours#${tour}`);
  await browser.until(`document.querySelectorAll("#stops li").length > 2 && !document.querySelector("#play").disabled`, "the stops of a tour");
}

const text = (browser, selector) => browser.evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);
const words = browser => browser.evaluate(`[...document.querySelectorAll("#stops .words")].map(one => one.textContent)`);
const tours = browser => browser.evaluate(`fetch("/api/tours").then(answer => answer.json()).then(all => all.tours)`);
const saved = browser => browser.until(`document.querySelector("#save").disabled && /Saved/.test(document.querySelector("#state").textContent)`, "saving");
const fill = (browser, selector, value) => browser.evaluate(`(() => { const field = document.querySelector(${JSON.stringify(selector)}); field.value = ${JSON.stringify(value)}; field.dispatchEvent(new Event("input")); })()`);

// The events that a browser makes of a drag, because headless Chromium makes none of a mouse's.
async function drags(browser, from, to) {
  const before = await words(browser);
  await browser.evaluate(`(() => { const data = new DataTransfer(), fire = (n, type) => document.querySelector("#stop-" + n).dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, dataTransfer: data })); fire(${from}, "dragstart"); fire(${to}, "dragover"); fire(${to}, "drop"); })()`);
  const wanted = [...before];
  wanted.splice(from < to ? to - 1 : to, 0, ...wanted.splice(from, 1));
  assert.deepEqual(await words(browser), wanted, "the order after dragging");
}

// Everything by keys: a stop is moved and moved back.
async function moves(browser) {
  const before = await words(browser);
  await browser.evaluate(`document.querySelector("#stop-1").focus()`);
  await browser.key("ArrowDown", ALT, 40);
  const after = await words(browser);
  assert.deepEqual([after[1], after[2]], [before[2], before[1]]);
  assert.equal(await browser.evaluate(`document.activeElement.id`), "stop-2", "the focus goes with the stop");
  await browser.key("ArrowUp", ALT, 38);
  assert.deepEqual(await words(browser), before);
}

// A stop is chosen, and the eye goes there; from elsewhere it is kept as the next stop, with words in two languages.
async function keeps(browser) {
  const count = (await words(browser)).length;
  await browser.click("#stop-0");
  await browser.until(`document.querySelector(".chosen .stop")`, "the form of a stop");
  await browser.evaluate(`document.querySelector("#stage").focus()`);
  for (let n = 0; n < 3; n++) await browser.key("ArrowRight", 0, 39);
  await browser.key("k", 0, 75);
  await browser.until(`document.querySelectorAll("#stops > li").length === ${count + 1} && document.querySelector("#stops > li:nth-child(2).chosen")`, "the new stop");
  await browser.type("Seen in a browser.");
  await fill(browser, "[data-key=stay]", "3");
  await browser.evaluate(`document.querySelectorAll("#languages button")[1].click()`);
  await fill(browser, ".chosen [data-key=caption]", "Vu dans un navigateur.");
  await browser.evaluate(`document.querySelectorAll("#languages button")[0].click()`);
  await browser.key("s", CONTROL, 83);
  await saved(browser);
  const [tour] = await tours(browser), [first, stop] = tour.stops;
  assert.deepEqual(stop.caption, { en: "Seen in a browser.", fr: "Vu dans un navigateur." });
  assert.equal(stop.stay, 3);
  const distance = (a, b) => Math.hypot(...a.map((n, i) => n - b[i]));
  assert.ok(distance(stop.eye, first.eye) > 1, "the eye has moved");
  assert.ok(Math.abs(distance(stop.eye, stop.target) - distance(first.eye, first.target)) < 0.1, "it has turned about its target");
  assert.equal(tour.attract, true, "what the page does not show of the tour is kept");
}

// The words are shown where the camera stays, and the picture changes.
async function plays(browser) {
  await browser.until(`!document.querySelector("#play").disabled && Number(document.querySelector("#when").max) > 10000`, "the path");
  await browser.click("#play");
  await browser.until(`!document.querySelector("#said").hidden && Number(document.querySelector("#when").value) > 400`, "what is said");
  assert.match(await text(browser, "#said"), /mountain of stone/);
  await browser.sleep(600);
  await browser.picture(`${folder}/playing.png`);
  await browser.click("#play");
  assert.equal(await text(browser, "#play"), "Play");
  const at = await browser.evaluate(`document.querySelector("#when").value`);
  await browser.sleep(300);
  assert.equal(await browser.evaluate(`document.querySelector("#when").value`), at, "it halts");
}

// A stop inside the temple: the page says that the way leads through the scan, before anything is published.
async function warns(browser) {
  const { tours: all, tag } = await browser.evaluate(`fetch("/api/tours").then(answer => answer.json())`);
  const flight = await browser.evaluate(`(async () => {
    const { token } = await fetch("/api/session").then(answer => answer.json()), tours = ${JSON.stringify(all)};
    tours[0].stops.splice(1, 0, { eye: [0, 0, 4], target: [5, 0, 4] });
    const answer = await fetch("/api/tours/" + tours[0].id + "/flight", { method: "POST", headers: { "Content-Type": "application/json", "X-Gopura-Token": token }, body: JSON.stringify({ tours }) });
    return answer.json();
  })()`);
  assert.ok(tag);
  assert.ok(flight.problems.some(one => /leads through the scan/.test(one.text) && one.file === "tours.json"), JSON.stringify(flight.problems));
  assert.equal(flight.poses.length, 6 * flight.at.length);
  assert.deepEqual(flight.stops[1], { eye: [0, 0, 4], target: [5, 0, 4] });
}

// Two at once: different tours are merged, the same line is for somebody to decide.
async function meets(ana, petra) {
  await open(petra, "guardians");
  await fill(petra, "#caption", "Petra's lion and serpent.");
  await fill(ana, "#title", "Ana's round");
  await ana.click("#save");
  await saved(ana);
  await petra.click("#save");
  await saved(petra);
  let all = await tours(ana);
  assert.equal(all[0].title.en, "Ana's round");
  assert.equal(all[1].caption.en, "Petra's lion and serpent.");
  await fill(petra, "#title", "Petra's title");
  await open(ana, "guardians");
  await fill(ana, "#title", "Ana's title");
  await ana.click("#save");
  await saved(ana);
  await petra.click("#save");
  await petra.until(`document.querySelector("#message button")`, "the choice");
  assert.equal((await tours(ana))[1].title.en, "Ana's title", "nothing is overwritten unasked");
  await petra.click("#message button");
  assert.equal(await petra.evaluate(`document.querySelector("#title").value`), "Ana's title");
}

// A new tour with one stop cannot be published, so it is not saved; with two it is; the history goes back, and forth.
async function begins(browser) {
  await browser.click("#new-tour");
  await fill(browser, "#title", "A short way");
  await browser.click("#stage");
  await browser.key("k", 0, 75);
  await browser.click("#save");
  await browser.until(`/Not saved/.test(document.querySelector("#message").textContent)`, "the refusal");
  assert.match(await text(browser, "#problems"), /needs 2 to 64/);
  await browser.evaluate(`document.querySelector("#stage").focus()`);
  await browser.key("ArrowLeft", 0, 37);
  await browser.key("k", 0, 75);
  await browser.click("#save");
  await saved(browser);
  const before = await tours(browser);
  assert.equal(before[before.length - 1].title.en, "A short way");
  await browser.evaluate(`document.querySelector("#history-box").open = true`);
  await browser.until(`document.querySelectorAll("#versions li").length > 1`, "the history");
  assert.match(await text(browser, "#versions li"), /^ana.*tours/);
  await browser.picture(`${folder}/new.png`);
  for (const count of [before.length - 1, before.length]) {
    const versions = await browser.evaluate(`document.querySelectorAll("#versions .versions > li").length`);
    await browser.evaluate(`document.querySelectorAll("#versions .versions > li > button")[1].click()`);
    await browser.until(`document.querySelector("#versions .difference button")`, "the button that goes back");
    await browser.evaluate(`document.querySelector("#versions .difference button").click()`);
    await browser.until(`document.querySelectorAll("#tour-list li").length === ${count} && document.querySelectorAll("#versions .versions > li").length === ${versions + 1}`, "the older tours");
  }
}

// A reader may look and play, and change nothing.
async function reads(browser) {
  await signIn(browser, "rolf");
  await open(browser, "round");
  assert.deepEqual(await browser.evaluate(`["#keep", "#new-tour", "#remove", "#save"].map(one => document.querySelector(one).disabled)`), [true, true, true, true]);
  const status = await browser.evaluate(`(async () => {
    const { token } = await fetch("/api/session").then(answer => answer.json());
    return (await fetch("/api/tours", { method: "PUT", headers: { "Content-Type": "application/json", "X-Gopura-Token": token, "If-None-Match": "*" }, body: '{"tours": []}' })).status;
  })()`);
  assert.equal(status, 403);
}

const ana = await openBrowser(), petra = await openBrowser({ width: 1024, height: 768, dark: true });
try {
  for (const [browser, name] of [[ana, "ana"], [petra, "petra"]]) {
    await browser.go(`${home}/sign-in`);
    await signIn(browser, name);
  }
  await open(ana, "round");
  await moves(ana);
  await drags(ana, 3, 1);
  await drags(ana, 1, 4);
  await keeps(ana);
  await ana.sleep(1500);
  await ana.picture(`${folder}/touring.png`);
  await plays(ana);
  await warns(ana);
  await open(petra, "guardians");
  await petra.sleep(1500);
  await petra.picture(`${folder}/tablet.png`);
  await meets(ana, petra);
  await begins(ana);
  await reads(petra);
  // The browser remarks on answers that the test provokes: 409 of the overlap, 422 of one stop, 403 of a reader.
  const thrown = [...ana.complaints, ...petra.complaints].filter(one => !/status of (409|422|403)/.test(one));
  assert.deepEqual(thrown, []);
} finally {
  await ana.close();
  await petra.close();
}
