// A curator at the page on which texts are written, in a real browser: pages.sh's claims, seen from the other side.
//
//     node tests/e2e/writing.mjs PORT FOLDER_FOR_PICTURES
import assert from "node:assert/strict";
import { openBrowser } from "../tools/browser.mjs";

const [port, folder] = process.argv.slice(2), home = `http://127.0.0.1:${port}`;
const CONTROL = 2;

async function signIn(browser, name) {
  await browser.go(`${home}/sign-in`);
  const status = await browser.evaluate(`fetch("/api/session", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ name: "${name}", password: "password of ${name}" }) }).then(answer => answer.status)`);
  assert.equal(status, 200);
}

async function open(browser, part) {
  await browser.go(`${home}/information#${part}`);
  await browser.until(`document.querySelector("#page h1")`, "the page of a part");
}

const saved = browser => browser.until(`document.querySelector("#save").disabled && /Saved/.test(document.querySelector("#state").textContent + document.querySelector("#message").textContent)`, "saving");
const html = browser => browser.evaluate(`fetch("/api/pages/lions.en").then(answer => answer.json()).then(page => page.html)`);
// Puts the caret at the end of the n-th paragraph.
const caret = (browser, n) => browser.evaluate(`(() => { const p = document.querySelectorAll("#page p")[${n}]; document.querySelector("#page").focus(); const range = document.createRange(); range.selectNodeContents(p); range.collapse(false); getSelection().removeAllRanges(); getSelection().addRange(range); })()`);
const paste = (browser, text) => browser.evaluate(`(() => { const data = new DataTransfer(); data.setData("text/html", ${JSON.stringify(text)}); document.querySelector("#page").dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true })); })()`);

async function writes(browser) {
  await open(browser, "lions.en");
  const before = await html(browser);
  assert.equal(await browser.evaluate(`document.querySelector("#save").disabled`), true, "nothing was changed");
  await caret(browser, 0);
  await browser.type(" Written in a browser & <seen>.");
  await browser.key("s", CONTROL, 83);
  await saved(browser);
  const after = await html(browser);
  assert.match(after, /wrestler's\. Written in a browser &amp; &lt;seen&gt;\.<\/p>/);
  // Nothing else of the file has changed.
  assert.equal(after.replace(" Written in a browser &amp; &lt;seen&gt;.", ""), before);
}

async function pastes(browser) {
  await caret(browser, 1);
  await paste(browser, `<h2 style="color:red" onclick="x()">From elsewhere</h2><p class="MsoNormal">With <b>weight</b>, <span style="font-style:italic">slope</span>, <a href="https://x.example">a link</a><script>alert(1)</script><img src="https://x.example/x.png"></p>`);
  await browser.click("#save");
  await saved(browser);
  const text = await html(browser);
  assert.match(text, /<h2>From elsewhere<\/h2>/);
  assert.match(text, /<strong>weight<\/strong>, <em>slope<\/em>, a link/);
  assert.doesNotMatch(text, /script|onclick|x\.example|Mso|color/);
}

async function changesCaption(browser) {
  await browser.evaluate(`(() => { const field = document.querySelector("#caption"); field.value = "A caption from the browser."; field.dispatchEvent(new Event("input")); })()`);
  await browser.click("#save");
  await saved(browser);
  await browser.click("#tab-history");
  await browser.until(`document.querySelector("#history li")`, "the history");
  assert.match(await browser.evaluate(`document.querySelector("#history li").textContent`), /^ana/);
}

// A recording is chosen as with the file dialog; the caption goes back to an older text by itself.
async function speaksAndGoesBack(browser) {
  await browser.click("#tab-sound");
  await browser.until(`document.querySelector("#sound input")`, "the panel");
  const { root } = await browser.send("DOM.getDocument"), { nodeId } = await browser.send("DOM.querySelector", { nodeId: root.nodeId, selector: "#sound input" });
  await browser.send("DOM.setFileInputFiles", { nodeId, files: [`${process.cwd()}/demo/content/pages/central-tower.en.opus`] });
  await browser.until(`document.querySelector("#sound audio")?.duration > 20`, "the recording");
  await browser.picture(`${folder}/sound.png`);
  const before = await browser.evaluate(`fetch("/api/parts/lions/history").then(answer => answer.json()).then(all => all.changes[0])`);
  assert.equal(before.to, "A caption from the browser.");
  await browser.click("#tab-history");
  await browser.until(`document.querySelectorAll("#history .versions").length === 3`, "the history");
  await browser.evaluate(`[...document.querySelectorAll("#history .versions:nth-of-type(2) > li > button")].filter(one => one.textContent.startsWith("Caption")).forEach(one => one.click())`);
  await browser.picture(`${folder}/history.png`);
  await browser.click("#history .versions:nth-of-type(2) .difference button");
  await browser.until(`document.querySelector("#caption").value === ${JSON.stringify(before.from)}`, "the older caption");
  assert.equal(await browser.evaluate(`document.querySelector("#save").disabled`), true, "it is saved");
}

// A new document at one part, then at two; a page of another part beside it; their order; back to the part's own page.
async function assigns(browser) {
  const listed = id => browser.evaluate(`fetch("/api/information").then(answer => answer.json()).then(all => all.parts.find(one => one.id === "${id}").documents)`);
  await browser.click("#tab-documents");
  await browser.until(`document.querySelector("#documents li")`, "the panel");
  await browser.evaluate(`document.querySelector("#documents input[maxlength]").focus()`);
  await browser.type("Works of restoration");
  await browser.click("#documents > .line:last-child button");
  await browser.until(`document.querySelector("#page h2")?.textContent === "Works of restoration" && document.querySelectorAll("#documents li").length === 2`, "a new document");
  assert.match(await browser.evaluate(`document.querySelector("#document").textContent`), /works-of-restoration.*The guardian lions/);
  await browser.evaluate(`(() => { const page = document.querySelector("#page"); page.focus(); getSelection().selectAllChildren(page); getSelection().collapseToEnd(); })()`);
  await browser.type(", begun in 1998");
  await browser.key("s", CONTROL, 83);
  await saved(browser);
  await browser.evaluate(`[...document.querySelectorAll("#documents li:nth-child(2) .check")].find(one => one.textContent === "The eastern stairs").querySelector("input").click()`);
  await browser.until(`/At 2 parts/.test(document.querySelector("#documents li:nth-child(2) summary").textContent)`, "two parts");
  await browser.evaluate(`document.querySelector("#documents select").value = "naga"; document.querySelector("#documents > .line button").click()`);
  await browser.until(`document.querySelectorAll("#documents li").length === 3`, "another part's page");
  await browser.click("#documents li:nth-child(3) button[aria-label*=before]");
  await browser.until(`/naga/i.test(document.querySelector("#documents li:nth-child(2) strong").textContent)`, "the order");
  assert.deepEqual(await listed("lions"), ["naga", "works-of-restoration"]);
  assert.deepEqual(await listed("stairs"), ["works-of-restoration"]);
  await browser.picture(`${folder}/documents.png`);
  await browser.click("#documents li:nth-child(1) button");
  await browser.until(`document.querySelector("#document").hidden && document.querySelector("#page h1")`, "the part's own page");
}

async function meets(ana, petra) {
  await open(petra, "lions.en");
  await caret(petra, 0);
  await petra.type(" Petra's end.");
  await caret(ana, 0);
  await ana.type(" Ana's end.");
  await ana.click("#save");
  await saved(ana);
  await petra.click("#save");
  await petra.until(`document.querySelectorAll("#page [data-overlap]").length === 2`, "both texts");
  await petra.picture(`${folder}/overlap.png`);
  const shown = await petra.evaluate(`document.querySelector("#page").textContent`);
  assert.match(shown, /Ana's end/);
  assert.match(shown, /Petra's end/);
  await petra.click("#page [data-overlap=mine] .choice button");
  await petra.click("#save");
  await saved(petra);
  const text = await html(petra);
  assert.match(text, /Petra's end/);
  assert.doesNotMatch(text, /Ana's end|&lt;&lt;|overlap|choice/);
}

async function previews(browser) {
  await browser.click("#tab-preview");
  await browser.until(`[...document.querySelectorAll("#preview img")].filter(image => image.complete && image.naturalWidth === 1280).length === 3`, "three previews", 60000);
}

const ana = await openBrowser(), petra = await openBrowser({ width: 1024, height: 768, dark: true });
try {
  await signIn(ana, "ana");
  await signIn(petra, "petra");
  await writes(ana);
  await pastes(ana);
  await changesCaption(ana);
  await speaksAndGoesBack(ana);
  await assigns(ana);
  await meets(ana, petra);
  await previews(ana);
  await ana.picture(`${folder}/writing.png`);
  await petra.picture(`${folder}/tablet.png`);
  // The browser remarks on the answer 409 of the overlap, and on the foreign style and script that were pasted, which the
  // policy forbids.
  const thrown = [...ana.complaints, ...petra.complaints].filter(text => !/status of 409|Content Security Policy/.test(text));
  assert.deepEqual(thrown, []);
} finally {
  await ana.close();
  await petra.close();
}
