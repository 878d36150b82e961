// A curator at the page on which texts are written, in a real browser: pages.sh's claims, seen from the other side.
//
//     node tests/e2e/writing.mjs PORT FOLDER_FOR_PICTURES
import assert from "node:assert/strict";
import { openBrowser } from "../tools/browser.mjs";

const [port, folder] = process.argv.slice(2), home = `http://127.0.0.1:${port}`;
const ALT = 1, CONTROL = 2;

async function signIn(browser, name) {
  await browser.go(`${home}/sign-in`);
  const status = await browser.evaluate(`fetch("/api/session", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ name: "${name}", password: "password of ${name}" }) }).then(answer => answer.status)`);
  assert.equal(status, 200);
}

async function open(browser, part) {
  await browser.go("about:blank"); // another place on the same page would not load it
  await browser.go(`${home}/information#${part}`);
  await browser.until(`document.querySelector("#page h1")`, "the page of a part");
}

const saved = browser => browser.until(`document.querySelector("#save").disabled && /Saved/.test(document.querySelector("#state").textContent + document.querySelector("#message").textContent)`, "saving");
const html = (browser, part = "lions") => browser.evaluate(`fetch("/api/pages/${part}.en").then(answer => answer.json()).then(page => page.html)`);
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

// A caption of two lines is one text, and stays one.
async function writesLines(browser) {
  const caption = () => browser.evaluate(`fetch("/api/information").then(answer => answer.json()).then(all => all.parts.find(one => one.id === "lions").caption.en)`);
  await open(browser, "lions.en");
  const before = await caption();
  for (const text of ["One line.\nAnother one.", before]) {
    await browser.evaluate(`(() => { const field = document.querySelector("#caption"); field.value = ${JSON.stringify(text)}; field.dispatchEvent(new Event("input")); })()`);
    await browser.click("#save");
    await saved(browser);
    assert.equal(await caption(), text);
    await open(browser, "lions.en");
    assert.equal(await browser.evaluate(`document.querySelector("#caption").value`), text);
    assert.equal(await browser.evaluate(`document.querySelector("#save").disabled`), true, "nothing was changed");
  }
}

// On a keyboard of another script the keys are where they are on a Latin one. A browser that asks only for returnValue asks.
async function savesByAnyKeyboard(browser) {
  const asks = () => browser.evaluate(`(() => { const event = document.createEvent("BeforeUnloadEvent"); event.initEvent("beforeunload", false, true); window.dispatchEvent(event); return event.returnValue; })()`);
  await open(browser, "naga.en");
  assert.equal(await asks(), "");
  await caret(browser, 0);
  await browser.type(" ភាសាខ្មែរ");
  assert.notEqual(await asks(), "");
  const press = async (key, modifiers) => { for (const type of ["keyDown", "keyUp"]) await browser.send("Input.dispatchKeyEvent", { type, key, code: "KeyS", modifiers, windowsVirtualKeyCode: 83 }); };
  await press("ś", CONTROL | ALT); // AltGr: a letter
  await browser.sleep(500);
  assert.match(await says(browser), /Not saved yet/);
  await press("ស", CONTROL);
  await saved(browser);
  assert.match(await html(browser, "naga"), /ភាសាខ្មែរ/);
}

// While the next page is on its way, what was left is not sent to its address; and its history stays its own.
async function waitsForThePage(browser) {
  const before = await html(browser, "stairs");
  await open(browser, "lions.en");
  await caret(browser, 0);
  await browser.type(" Left.");
  await browser.evaluate(`(() => { window.line ??= fetch; window.sent = []; window.fetch = async (path, options) => { if (options?.method === "PUT") window.sent.push(path); if (path.startsWith("/api/pages")) await new Promise(done => setTimeout(done, 1000)); return line(path, options); }; })()`);
  browser.dialogs.accept = true;
  await browser.click("#part-stairs");
  await browser.until(`document.querySelector("#part-stairs").getAttribute("aria-current") === "true"`, "the other part");
  await browser.key("s", CONTROL, 83);
  await browser.until(`location.hash === "#stairs.en"`, "its page");
  await browser.sleep(300);
  assert.deepEqual(await browser.evaluate(`window.sent`), []);
  assert.equal(await html(browser, "stairs"), before);
  await release(browser);
  await browser.click("#tab-history");
  await browser.until(`document.querySelector("#history .versions")`, "its history");
  await hold(browser, "GET", "lions.en.html", 1500);
  await browser.click("#part-lions");
  await browser.until(`location.hash === "#lions.en"`, "another part");
  await browser.click("#part-stairs");
  await browser.until(`location.hash === "#stairs.en" && document.querySelector("#history .versions")`, "the first one again");
  await browser.sleep(2500);
  assert.doesNotMatch(await browser.evaluate(`document.querySelector("#history .versions").textContent`), /lions in en/);
  await release(browser);
}

// A picture that is copied elsewhere comes with the address of where it was.
async function pastesAPicture(browser) {
  await open(browser, "naga.en");
  const figures = () => browser.evaluate(`document.querySelectorAll("#page figure").length`), before = await figures();
  await caret(browser, 0);
  await browser.evaluate(`(async () => {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 8;
    const data = new DataTransfer(), blob = await new Promise(done => canvas.toBlob(done));
    data.setData("text/html", "<meta charset='utf-8'><img src='https://x.example/y.png'>");
    data.items.add(new File([blob], "copied.png", { type: "image/png" }));
    document.querySelector("#page").dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true }));
  })()`);
  await browser.until(`document.querySelectorAll("#page figure").length === ${before + 1}`, "the picture");
  await browser.evaluate(`(() => { const data = new DataTransfer(); data.setData("text/plain", "From Windows.\\r\\n\\r\\nTwo."); document.querySelector("#page").dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true })); })()`);
  assert.match(await shown(browser), /From Windows\./);
  assert.doesNotMatch(await shown(browser), /From Windows\. Two/);
  await browser.click("#save");
  await saved(browser);
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
  const both = await shown(petra);
  assert.match(both, /Ana's end/);
  assert.match(both, /Petra's end/);
  await petra.click("#page [data-overlap=mine] .choice button");
  await petra.click("#save");
  await saved(petra);
  const text = await html(petra);
  assert.match(text, /Petra's end/);
  assert.doesNotMatch(text, /Ana's end|&lt;&lt;|overlap|choice/);
}

const shown = browser => browser.evaluate(`document.querySelector("#page").textContent`);
const says = browser => browser.evaluate(`document.querySelector("#state").textContent + document.querySelector("#message").textContent`);
// What the page asks of addresses like this from now on is delayed, or fails as where there is no line.
const hold = (browser, method, pattern, ms, fails = false) => browser.evaluate(`(() => { window.line ??= fetch; window.fetch = async (path, options) => { if ((options?.method || "GET") === "${method}" && path.includes("${pattern}")) { await new Promise(done => setTimeout(done, ${ms})); if (${fails}) throw new TypeError("no line"); } return line(path, options); }; })()`);
const release = browser => browser.evaluate(`void (window.fetch = line)`);

async function asked(browser, times) {
  for (let n = 0; browser.dialogs.length < times && n < 100; n++) await browser.sleep(50);
  assert.equal(browser.dialogs.length, times);
}

// A click on what is open changes nothing; going back and leaving ask first.
async function keepsWhatIsNotSaved(browser) {
  await open(browser, "lions.en");
  await caret(browser, 0);
  await browser.type(" Not saved.");
  browser.dialogs.length = 0;
  browser.dialogs.accept = false;
  await browser.click("#part-lions");
  await browser.click("#languages [aria-selected=true]");
  await browser.sleep(300);
  assert.match(await shown(browser), /Not saved\./);
  assert.equal(browser.dialogs.length, 0);
  await browser.click("#tab-history");
  await browser.until(`document.querySelector("#history .versions")?.children.length > 1`, "the history");
  await browser.evaluate(`document.querySelector("#history .versions").children[1].firstElementChild.click()`);
  await browser.until(`document.querySelector("#history .versions").querySelector(".difference button")`, "a version");
  await browser.evaluate(`document.querySelector("#history .versions").querySelector(".difference button").click()`);
  await asked(browser, 1);
  await browser.click("#part-stairs");
  await asked(browser, 2);
  assert.match(await shown(browser), /Not saved\./);
  browser.dialogs.accept = true;
  await browser.click("#part-stairs");
  await browser.until(`location.hash === "#stairs.en" && !/Not saved/.test(document.querySelector("#page").textContent)`, "another part");
}

// What is written while a save is under way is not in it, stays, and can be saved; also where somebody else has written.
async function writesWhileItSaves(ana, petra) {
  await open(petra, "lions.en");
  await open(ana, "lions.en");
  await caret(ana, 0);
  await ana.type(" First.");
  await hold(ana, "PUT", "api/pages", 700);
  await ana.key("s", CONTROL, 83);
  await ana.type(" Second.");
  await ana.until(`fetch("/api/pages/lions.en").then(answer => answer.json()).then(page => /First/.test(page.html))`, "the first save");
  await ana.sleep(500);
  assert.doesNotMatch(await html(ana), /Second\./);
  assert.match(await shown(ana), /First\. Second\./);
  assert.match(await says(ana), /Not saved yet/);
  await ana.key("s", CONTROL, 83);
  await saved(ana);
  assert.match(await html(ana), /First\. Second\./);
  await caret(petra, 1);
  await petra.type(" Third.");
  await hold(petra, "PUT", "api/pages", 700);
  await petra.key("s", CONTROL, 83);
  await petra.type(" Fourth.");
  await saved(petra);
  await release(ana);
  await release(petra);
  assert.match(await html(petra), /First\. Second\.[^]*Third\. Fourth\./);
  assert.match(await shown(petra), /First\. Second\.[^]*Third\. Fourth\./);
}

// The page outlives its session.
async function signsInAgain(browser) {
  await open(browser, "lions.en");
  await caret(browser, 0);
  await browser.type(" After a restart.");
  assert.equal(await browser.evaluate(`import("/api.js").then(api => fetch("/api/session", { method: "DELETE", headers: { "X-Gopura-Token": api.token() } })).then(answer => answer.ok)`), true);
  await browser.click("#save");
  await browser.until(`/Sign in as ana in another tab/.test(document.querySelector("#message").textContent)`, "what to do");
  assert.match(await shown(browser), /After a restart\./);
  await browser.evaluate(`fetch("/api/session", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ name: "ana", password: "password of ana" }) }).then(answer => answer.status)`);
  await browser.click("#save");
  await saved(browser);
  assert.match(await html(browser), /After a restart\./);
}

// Somebody else removes the page: it is brought back. A removal meets what they have written.
async function meetsARemoval(ana, petra) {
  const empty = browser => browser.evaluate(`(() => { const page = document.querySelector("#page"); page.innerHTML = "<p><br></p>"; page.dispatchEvent(new Event("input")); })()`);
  await open(petra, "pediment.en");
  await empty(petra);
  await petra.click("#save");
  await petra.until(`/See below/.test(document.querySelector("#message").textContent)`, "why not");
  await petra.picture(`${folder}/problems.png`);
  assert.match(await petra.evaluate(`(() => { const list = document.querySelector("#problems"), box = list.getBoundingClientRect(); return document.elementFromPoint(box.x + 20, box.y + box.height / 2)?.closest("#problems")?.innerText || ""; })()`), /^The page is missing: write it$/);
  for (const language of ["ja", "km", "fr"]) // the last page of a part may go, before that it would be half translated
    assert.equal(await petra.evaluate(`Promise.all([import("/api.js"), fetch("/api/pages/pediment.${language}").then(answer => answer.json())]).then(([api, page]) => fetch("/api/pages/pediment.${language}", { method: "DELETE", headers: { "X-Gopura-Token": api.token(), "If-Match": '"' + page.tag + '"' } })).then(answer => answer.text())`).then(text => JSON.parse(text).tag), "");
  await open(ana, "pediment.en");
  await open(petra, "pediment.en");
  const text = await html(ana, "pediment");
  await empty(petra);
  await petra.click("#save");
  await saved(petra);
  assert.equal(await html(ana, "pediment"), "");
  await caret(ana, 0);
  await ana.type(" Back again.");
  await ana.click("#save");
  await ana.until(`/removed this page/.test(document.querySelector("#message").textContent)`, "the removal");
  await ana.click("#save");
  await saved(ana);
  assert.match(await html(ana, "pediment"), /Back again\./);
  assert.equal((await html(ana, "pediment")).replace(" Back again.", "").replace(/\s/g, ""), text.replace(/\s/g, ""));
  await open(petra, "pediment.en");
  await caret(ana, 0);
  await ana.type(" Once more.");
  await ana.click("#save");
  await saved(ana);
  await empty(petra);
  await petra.click("#save");
  await petra.until(`/Once more/.test(document.querySelector("#page").textContent) && /look at it/.test(document.querySelector("#message").textContent)`, "what they have");
}

// Both change one item of a list: both lists are shown whole, and nothing is saved before somebody decides.
async function meetsInAList(ana, petra) {
  await open(ana, "lions.en");
  await caret(ana, 1);
  await paste(ana, "<ul><li>one</li><li>two</li><li>three</li></ul>");
  await ana.click("#save");
  await saved(ana);
  await open(petra, "lions.en");
  for (const [browser, word] of [[ana, "deux"], [petra, "zwei"]])
    await browser.evaluate(`(() => { const page = document.querySelector("#page"), item = [...page.querySelectorAll("li")].find(one => one.textContent === "two"); item.textContent = "${word}"; page.dispatchEvent(new Event("input")); })()`);
  await ana.click("#save");
  await saved(ana);
  await petra.click("#save");
  await petra.until(`document.querySelectorAll("#page [data-overlap]").length === 2`, "both lists");
  assert.deepEqual(await petra.evaluate(`[...document.querySelectorAll("#page [data-overlap]")].map(box => [...box.querySelectorAll("ul li")].map(item => item.textContent).join())`), ["one,zwei,three", "one,deux,three"]);
  await petra.key("s", CONTROL, 83);
  assert.match(await says(petra), /Keep one of them first/);
  assert.match(await html(petra), /deux/);
  await petra.click("#page [data-overlap=mine] .choice button");
  await petra.click("#save");
  await saved(petra);
  assert.match(await html(petra), /<li>one<\/li>\s*<li>zwei<\/li>\s*<li>three<\/li>/);
}

// A page that does not come leaves no other part's text in the editor, and can be asked for again.
async function losesTheLine(browser) {
  await open(browser, "lions.en");
  await hold(browser, "GET", "api/pages", 0, true);
  await browser.click("#part-stairs");
  await browser.until(`/could not be loaded/.test(document.querySelector("#message").textContent)`, "why");
  assert.equal(await browser.evaluate(`document.querySelector("#page").textContent + document.querySelector("#page").contentEditable`), "false");
  await release(browser);
  await browser.click("#part-stairs");
  await browser.until(`document.querySelector("#page h1") && document.querySelector("#page").contentEditable === "true"`, "the page");
}

// A page that was written by hand and has what the editor lacks is not changed by it; every other one can be edited.
async function leavesWhatItCannotShow(browser) {
  assert.deepEqual(await browser.evaluate(`(async () => {
    const { isKept } = await import("/clean.js"), all = await (await fetch("/api/information")).json(), wrong = [];
    for (const part of all.parts) for (const language of all.languages) {
      const page = await (await fetch("/api/pages/" + part.id + "." + language)).json();
      if (!isKept(page.html)) wrong.push(part.id + "." + language);
    }
    return [wrong, isKept("<ul><li>a<img src='pictures/x.jpg' alt=''></li></ul>"), isKept("<figure>words</figure>")];
  })()`), [[], false, false]);
}

// What is dropped comes to the page, but not to one that cannot be edited.
async function takesADrop(browser) {
  const drop = `(() => { const data = new DataTransfer(); data.items.add(new File(["Dropped.\\n\\nTwice."], "words.txt", { type: "text/plain" })); document.querySelector("#page").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true })); })()`;
  await open(browser, "naga.en");
  await browser.evaluate(drop);
  await browser.until(`/Dropped\\.\\s*Twice\\./.test(document.querySelector("#page").innerText)`, "the text");
  await browser.click("#save");
  await saved(browser);
  assert.match(await html(browser, "naga"), /<p>Dropped\.<\/p>\s*<p>Twice\.<\/p>/);
  await browser.evaluate(`import("/editor.js").then(editor => editor.allowEditing(false))`);
  await browser.evaluate(drop);
  await browser.until(`/cannot be edited/.test(document.querySelector("#message").textContent)`, "why not");
  assert.equal(await browser.evaluate(`document.querySelector("#save").disabled`), true);
}

// Two credits one after the other, without waiting for the first to be saved; then one that somebody else has changed.
async function writesCredits(browser) {
  await open(browser, "lions.en");
  await browser.click("#tab-about");
  await browser.until(`document.querySelector("#about textarea")`, "the panel");
  await hold(browser, "POST", "/texts", 300);
  const area = n => `document.querySelectorAll("#about textarea")[${n}]`;
  await browser.evaluate(`${area(1)}.focus()`);
  await browser.type("Bopha");
  await browser.evaluate(`${area(2)}.focus()`);
  await browser.type("The mu");
  await browser.until(`fetch("/api/information").then(answer => answer.json()).then(all => all.parts.find(one => one.id === "lions").credits?.contributor === "Bopha")`, "the first credit");
  await browser.sleep(300);
  await browser.type("seum");
  await browser.key("s", CONTROL, 83);
  await browser.until(`fetch("/api/information").then(answer => answer.json()).then(all => all.parts.find(one => one.id === "lions").credits?.publisher === "The museum")`, "the second credit");
  await release(browser);
  // One that cannot be saved does not go unasked; one that is saved behind another panel is no question.
  await hold(browser, "POST", "/texts", 0, true);
  await browser.evaluate(`${area(3)}.focus()`);
  await browser.type("1998");
  await browser.evaluate(`${area(4)}.focus()`);
  await browser.until(`/Not saved/.test(document.querySelector("#message").textContent)`, "why not");
  await release(browser);
  browser.dialogs.length = 0;
  browser.dialogs.accept = false;
  await browser.click("#part-naga");
  await asked(browser, 1);
  assert.equal(await browser.evaluate(`${area(3)}.value`), "1998");
  browser.dialogs.accept = true;
  await browser.click("#part-naga");
  await browser.until(`location.hash === "#naga.en"`, "another part");
  await browser.evaluate(`${area(3)}.focus()`);
  await browser.type("1999");
  await browser.click("#tab-history");
  await browser.until(`fetch("/api/information").then(answer => answer.json()).then(all => all.parts.find(one => one.id === "naga").credits?.date === "1999")`, "the credit");
  await browser.click("#part-lions");
  await browser.until(`location.hash === "#lions.en"`, "no question");
  assert.equal(browser.dialogs.length, 2);
}

// With the keyboard alone: the next language, and the focus stays on it.
async function changesTheLanguage(browser) {
  await open(browser, "lions.en");
  await browser.evaluate(`document.querySelector("#languages [aria-selected=true]").focus()`);
  await browser.key("ArrowRight", 0, 39);
  await browser.until(`/^#lions\.(?!en)/.test(location.hash)`, "the next language");
  assert.equal(await browser.evaluate(`document.activeElement.getAttribute("aria-selected")`), "true");
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
  await keepsWhatIsNotSaved(ana);
  await writesWhileItSaves(ana, petra);
  await signsInAgain(ana);
  await meetsARemoval(ana, petra);
  await meetsInAList(ana, petra);
  await writesLines(ana);
  await savesByAnyKeyboard(ana);
  await waitsForThePage(ana);
  await pastesAPicture(ana);
  await losesTheLine(ana);
  await leavesWhatItCannotShow(ana);
  await writesCredits(ana);
  await changesTheLanguage(ana);
  await takesADrop(ana);
  await previews(ana);
  await ana.picture(`${folder}/writing.png`);
  await petra.picture(`${folder}/tablet.png`);
  // The browser remarks on the answers that refuse, and on the foreign style and script that were pasted, which the
  // policy forbids.
  const thrown = [...ana.complaints, ...petra.complaints].filter(text => !/status of (401|403|409|422)|Content Security Policy/.test(text));
  assert.deepEqual(thrown, []);
} catch (failure) {
  await ana.picture(`${folder}/failed.png`);
  await petra.picture(`${folder}/failed-petra.png`);
  throw failure;
} finally {
  await ana.close();
  await petra.close();
}
