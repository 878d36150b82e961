// A curator from the printed address to a release, in a real browser, with mouse and keys.
//
//     node tests/e2e/curating.mjs write|publish ADDRESS PASSWORD FOLDER_FOR_PICTURES
import assert from "node:assert/strict";
import { openBrowser } from "../tools/browser.mjs";

const [what, address, password, folder] = process.argv.slice(2), CONTROL = 2;
const browser = await openBrowser();

async function signIn() {
  await browser.go(address);
  await browser.until(`document.activeElement?.id === "name"`, "signing in");
  await browser.type("demo");
  await browser.evaluate(`document.querySelector("#password").focus()`);
  await browser.type(password);
  if (what === "write") await browser.picture(`${folder}/1-sign-in.png`);
  await browser.click("button[type=submit]");
  await browser.until(`location.pathname === "/" && document.querySelector("#connection")?.textContent === "Connected" && document.querySelector("#quality").hidden`, "the sharp picture");
}

// Draws with the left button, by shares of half the picture's height from its middle.
async function draw(points) {
  const [x, y, r] = await browser.evaluate(`(() => { const box = document.querySelector("#stage").getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2, box.height / 2]; })()`);
  const mouse = (type, [dx, dy]) => browser.send("Input.dispatchMouseEvent", { type, x: x + r * dx, y: y + r * dy, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
  await mouse("mousePressed", points[0]);
  for (const point of points.slice(1)) await mouse("mouseMoved", point);
  await mouse("mouseReleased", points[points.length - 1]);
}

// Pixels of the picture as blue as what is marked.
const blue = `(() => { const c = document.querySelector("#picture"), d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data; let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i + 2] > d[i] + 20; return n; })()`;

// Two places of the gallery, and the same length from another side.
async function measure() {
  const text = `document.querySelector("#hint").textContent`;
  await browser.key("6", 0, 54);
  await browser.until(`${text} === "Click two places on the model."`, "the ruler");
  await draw([[-0.1, 0]]);
  await browser.until(`${text} === "Click the second place."`, "the first end");
  await draw([[0.1, 0]]);
  await browser.until(`/^\\d[\\d.]* (m|cm) ± \\d+ (cm|mm)$/.test(${text})`, "a length");
  const length = await browser.evaluate(text);
  await browser.evaluate(`document.querySelector("#stage").focus()`);
  await browser.key("ArrowLeft", 0, 37);
  await browser.until(`document.querySelector("#quality").hidden`, "the sharp picture from another side");
  assert.equal(await browser.evaluate(text), length);
  await browser.picture(`${folder}/2-measured.png`);
  await browser.key("ArrowRight", 0, 39);
  await browser.until(`document.querySelector("#quality").hidden`, "the sharp picture");
  console.log(length);
}

async function mark() {
  await browser.key("4", 0, 52);
  await draw(Array.from({ length: 20 }, (_, n) => [-0.1 + n * 0.01, 0.03 * Math.sin(n)]));
  await browser.key("5", 0, 53);
  await draw(Array.from({ length: 41 }, (_, n) => [0.3 * Math.cos(n * Math.PI / 20), 0.3 * Math.sin(n * Math.PI / 20)]));
  await browser.until(`!document.querySelector("#apply").disabled`, "strokes");
  await browser.picture(`${folder}/3-strokes.png`);
  const before = await browser.evaluate(blue);
  await browser.click("#apply");
  await browser.until(`Number(document.querySelector("#count").textContent.replace(/\\D/g, "")) > 50`, "a region");
  await browser.until(`${blue} > ${before + 500}`, "the region in the picture");
  await browser.evaluate(`document.querySelector("#title").focus()`);
  await browser.type("Corner of the gallery");
  await browser.picture(`${folder}/4-marked.png`);
  await browser.click("#save");
  await browser.until(`document.querySelector("#message a")`, "the saved part");
}

async function write() {
  await browser.click("#message a");
  await browser.until(`location.pathname === "/information" && document.querySelector("#title")?.value === "Corner of the gallery"`, "the part's texts");
  await browser.click("#caption");
  await browser.type("Here the upper gallery turns to the south.");
  await browser.until(`document.querySelector("#page").isContentEditable`, "the page");
  // Changed, and still without a page: its name and its card are shown.
  await browser.click("#tab-preview");
  await browser.until(`[...document.querySelectorAll("#preview img")].filter(image => image.complete && image.naturalWidth === 1280).length === 2 && /no page yet/.test(document.querySelector("#preview").textContent)`, "two previews");
  await browser.evaluate(`document.querySelector("#page").focus()`);
  await browser.type("Written by a curator in a browser.");
  await browser.key("s", CONTROL, 83);
  await browser.until(`document.querySelector("#save").disabled && /Saved/.test(document.querySelector("#state").textContent)`, "saving");
  await browser.click("#tab-preview");
  await browser.until(`[...document.querySelectorAll("#preview img")].filter(image => image.complete && image.naturalWidth === 1280).length === 3`, "three previews");
  await browser.picture(`${folder}/5-written.png`);
}

async function publish() {
  await browser.click("#open-publish");
  await browser.until(`!document.querySelector("#publish-now").disabled`, "what would change");
  assert.match(await browser.evaluate(`document.querySelector("#changes").textContent`), /Corner of the gallery/);
  await browser.click("#publish-comment");
  await browser.type("Corner of the gallery");
  await browser.picture(`${folder}/6-publish.png`);
  await browser.click("#publish-now");
  await browser.until(`document.querySelector("#publish-state").className.includes("good")`, "the release", 100000);
}

try {
  await signIn();
  if (what === "publish") await publish();
  else {
    await measure();
    await mark();
    await write();
  }
  assert.deepEqual(browser.complaints, []);
} catch (failure) {
  await browser.picture(`${folder}/failed.png`);
  console.error(browser.complaints, await browser.evaluate(`document.body.innerText`));
  throw failure;
} finally {
  await browser.close();
}
