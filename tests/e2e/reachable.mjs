// A curator with nothing but a keyboard, in a real browser; on the way each view is judged by axe and its picture is kept.
//
//     node tests/e2e/reachable.mjs ADDRESS PASSWORD FOLDER_FOR_PICTURES [AXE_SCRIPT]
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { openBrowser } from "../tools/browser.mjs";

const [address, password, folder, axe] = process.argv.slice(2);
const ALT = 1, CONTROL = 2, SHIFT = 8;
const CODES = { Tab: 9, Enter: 13, Escape: 27, " ": 32, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40 };
const DESK = { width: 1280, height: 800 }, TABLET = { width: 1024, height: 768, dark: true, touch: true };
const browser = await openBrowser(DESK), faults = [];
const press = (key, modifiers = 0) => browser.key(key, modifiers, CODES[key] || key.toUpperCase().charCodeAt(0));

// ---- views

const JUDGE = `axe.run(document, { resultTypes: ["violations"] }).then(found => found.violations.flatMap(rule => rule.nodes.map(node => rule.id + ": " + node.target.join(" ") + ": " + node.failureSummary.split("\\n").slice(1).join(" ").trim())))`;

// Columns that are wider inside than outside.
const CUT = `[...document.querySelectorAll("aside, main, form, dialog[open], header, section")].filter(e => e.checkVisibility() && e.scrollWidth > e.clientWidth + 1).map(e => e.tagName + "." + e.className)`;

async function judge(view) {
  if (axe && !await browser.evaluate(`Boolean(window.axe)`)) await browser.evaluate(`${readFileSync(axe, "utf8")};0`);
  for (const [name, look] of [["desk", DESK], ["dark", { ...DESK, dark: true }], ["tablet", TABLET]]) {
    await browser.look(look);
    await browser.until(`!document.querySelector("#quality") || document.querySelector("#quality").hidden`, "the sharp picture");
    await browser.sleep(100);
    const wide = await browser.evaluate(`document.documentElement.scrollWidth`);
    if (wide > look.width) faults.push(`${view}, ${name}: ${wide} px wide on ${look.width}`);
    faults.push(...(await browser.evaluate(CUT)).map(fault => `${view}, ${name}: ${fault} is cut off`));
    if (axe) faults.push(...(await browser.evaluate(JUDGE)).map(fault => `${view}, ${name}: ${fault}`));
    await browser.picture(`${folder}/view-${view}-${name}.png`);
  }
  await browser.look(DESK);
  await browser.until(`!document.querySelector("#quality") || document.querySelector("#quality").hidden`, "the sharp picture");
}

// ---- the keyboard

// What has the focus, and whether one sees that.
const focused = () => browser.evaluate(`(() => { const e = document.activeElement, s = getComputedStyle(e); return { body: e === document.body, name: e.id ? "#" + e.id : e.tagName.toLowerCase() + "." + e.className + " " + (e.textContent || "").trim().slice(0, 30), seen: s.outlineStyle !== "none" && parseFloat(s.outlineWidth) >= 2 }; })()`);

async function tabTo(selector, modifiers = 0) {
  for (let n = 0; n < 120; n++) {
    await press("Tab", modifiers);
    if (await browser.evaluate(`document.activeElement.matches(${JSON.stringify(selector)})`)) return;
  }
  assert.fail(`the Tab key does not lead to ${selector}`);
}

// Everything that can be used is met on one way round; a group with arrow keys, once.
async function goRound(view) {
  await browser.evaluate(`(() => {
    document.activeElement.blur();
    window.unmet = new Set([...document.querySelectorAll("button, a[href], input, select, textarea, summary, [tabindex], [contenteditable=true]")].filter(e => !e.disabled && e.tabIndex >= 0 && e.checkVisibility({ visibilityProperty: true })));
  })()`);
  const count = await browser.evaluate(`unmet.size`);
  for (let n = 0; n < count + 3; n++) {
    await press("Tab");
    const now = await focused();
    if (!now.body && !now.seen) faults.push(`${view}: the focus is not seen on ${now.name}`);
    await browser.evaluate(`unmet.delete(document.activeElement)`);
  }
  const unmet = await browser.evaluate(`[...unmet].map(e => e.outerHTML.slice(0, 100))`);
  assert.deepEqual(unmet, [], `${view}: the Tab key does not lead to`);
  return count;
}

async function signIn() {
  await browser.go(address);
  await browser.until(`document.activeElement?.id === "name"`, "signing in");
  await judge("sign-in");
  await browser.type("demo");
  await press("Tab");
  await browser.type(password);
  await press("Enter");
  await browser.until(`location.pathname === "/" && document.querySelector("#connection")?.textContent === "Connected" && document.querySelector("#quality").hidden`, "the sharp picture");
}

// The lasso by the pen of the keyboard: a square in the middle.
async function mark() {
  assert.ok(await goRound("mark") > 20);
  await tabTo("#tools [role=radio]");
  await press("ArrowDown");
  assert.equal(await browser.evaluate(`document.activeElement.dataset.tool`), "lasso");
  await tabTo("#stage");
  await press("p");
  const go = async (key, count) => { for (let n = 0; n < count; n++) await press(key); };
  await go("ArrowUp", 6);
  await go("ArrowLeft", 6);
  await press(" ");
  for (const key of ["ArrowRight", "ArrowDown", "ArrowLeft", "ArrowUp"]) await go(key, 12);
  await press("ArrowUp", SHIFT);
  await press(" ");
  await browser.until(`Number(document.querySelector("#count").textContent.replace(/\\D/g, "")) > 50`, "a region");
  await browser.until(`document.querySelector("#quality").hidden`, "the sharp picture");
  await press("Escape");
  await press("g");
  await tabTo("#title");
  await browser.type("Marked by keys");
  await press("Enter");
  await browser.until(`document.querySelector("#message a")`, "the saved part");
  await judge("part");
}

async function write() {
  await tabTo("#message a");
  await press("Enter");
  await browser.until(`location.pathname === "/information" && document.querySelector("#title")?.value === "Marked by keys"`, "the part's texts");
  await browser.until(`document.querySelector("#page").isContentEditable`, "the page");
  await goRound("write");
  await tabTo("#caption");
  await browser.type("Without a mouse.");
  await tabTo("#page");
  await browser.type("Written without a mouse, beside ");
  await press("k", CONTROL);
  await browser.until(`document.querySelector("#link-dialog").open`, "links");
  await judge("link");
  await tabTo("#link-target");
  await press("ArrowDown");
  await press("Enter");
  await browser.until(`document.querySelector("#page a")`, "a link");
  await press("s", CONTROL);
  await browser.until(`document.querySelector("#save").disabled && /Saved/.test(document.querySelector("#state").textContent)`, "saving");
  await tabTo("#picture", SHIFT);
  await press("Enter");
  await browser.until(`document.querySelector("#picture-dialog").open && [...document.querySelectorAll("#picture-choices img")].every(one => one.complete || one.loading === "lazy")`, "pictures");
  await judge("pictures");
  await press("Escape");
  await tabTo("#tab-preview");
  await browser.until(`[...document.querySelectorAll("#preview img")].filter(image => image.complete && image.naturalWidth === 1280).length === 3`, "three previews");
  await judge("write");
  for (const panel of ["history", "documents", "sound", "about"]) {
    await press("ArrowRight");
    await browser.until(`!document.querySelector("#${panel}").hidden && document.querySelector("#${panel}").children.length > 1`, panel);
    if (panel === "history") {
      for (const list of [1, 2]) { // of the page, and of its card
        await tabTo(`#history .versions:nth-of-type(${list}) button`);
        await press("Enter");
      }
      await browser.until(`[...document.querySelectorAll("#history .difference")].filter(one => one.checkVisibility()).length === 2`, "two differences");
    }
    await judge(panel);
    if (panel === "history") await tabTo("#tab-history", SHIFT);
  }
}

async function tours() {
  await tabTo(".places a[href='/tours']");
  await press("Enter");
  await browser.until(`location.pathname === "/tours" && document.querySelectorAll("#stops li").length > 2 && !document.querySelector("#play").disabled && document.querySelector("#quality").hidden`, "a tour");
  await goRound("tours");
  await tabTo("#stop-1");
  await press("ArrowDown", ALT);
  assert.equal(await browser.evaluate(`document.activeElement.id`), "stop-2");
  await press("Enter");
  await browser.until(`document.querySelector(".stop textarea")`, "a stop");
  await tabTo("#history-box summary");
  await press("Enter");
  await browser.until(`document.querySelector("#versions").textContent`, "the history");
  await judge("tours");
  await press("s", CONTROL);
  await browser.until(`document.querySelector("#save").disabled && /Saved/.test(document.querySelector("#state").textContent)`, "saving");
}

async function publish() {
  await tabTo("a[href='/#publish']");
  await press("Enter");
  await browser.until(`document.querySelector("#publish")?.open && !document.querySelector("#publish-now").disabled`, "what would change");
  await judge("publish");
  await tabTo("#publish-comment");
  await browser.type("Without a mouse");
  await press("Enter");
  await browser.until(`document.querySelector("#publish-state").className.includes("good")`, "the release", 100000);
  await tabTo(".release button");
  await press("Enter");
  await browser.until(`document.querySelector("#back").open`, "the question");
  await judge("back");
  await press("Escape");
  await press("Escape");
  assert.equal(await browser.evaluate(`document.querySelector("#publish").open`), false);
}

try {
  for (const step of [signIn, mark, write, tours, publish]) {
    const start = Date.now();
    await step();
    console.log(`${step.name}: ${((Date.now() - start) / 1000).toFixed(1)} s`);
  }
  assert.deepEqual(faults, []);
  assert.deepEqual(browser.complaints, []);
} catch (failure) {
  for (const fault of faults) console.error(fault);
  await browser.picture(`${folder}/view-failed.png`);
  throw failure;
} finally {
  await browser.close();
}
