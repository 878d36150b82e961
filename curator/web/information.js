// The page on which curators write: parts at the left, a part's texts and its page in the middle, preview, history and
// credits at the right. docs/curator.md has the addresses.
import { showAbout } from "./about.js";
import { showAccount } from "./account.js";
import { ask, loadSession, may } from "./api.js";
import { clean, pictureAddress } from "./clean.js";
import { showDocuments } from "./documents.js";
import { allowEditing, insertBlocks, pageText, setPage, setUpEditor, setUpLinks } from "./editor.js";
import { showHistory } from "./history.js";
import { setUpList, showList, titleOf } from "./part_list.js";
import { makeFigure, pickPicture, readFigure, sendPicture, setPictures } from "./pictures.js";
import { showPreview } from "./preview.js";
import { sendSound, showSound, soundKind } from "./sound.js";

const byId = id => document.getElementById(id);
const FIELDS = ["title", "caption", "reading"];
let information = { parts: [], languages: [], tours: [], problems: [], pictures: [], documents: [] };
let part = null, language = "", tag = "", loadedText = "", loaded = {}, dirty = false, panel = "preview", saving = false;

let shown = ""; // the document in the editor; "": the part's own page
const pageId = () => shown || part.id;
const isPartsOwn = id => information.parts.some(one => one.id === id);
const pageName = () => `pages/${pageId()}.${language}.html`;
const pageAddress = () => `/api/pages/${pageId()}.${language}${isPartsOwn(pageId()) ? "" : "?kind=document"}`;

function tell(text, good = false) {
  byId("message").textContent = text;
  byId("message").hidden = !text;
  byId("message").classList.toggle("good", good);
}

function setDirty(on) {
  dirty = on;
  byId("save").disabled = !on || !may("editor");
  byId("state").textContent = on ? "Not saved yet" : "";
}

// ---- what is wrong

// Each problem with the part that it is about, as its file or its sentence names it.
function locate(problem) {
  const page = /^pages\/([a-z0-9_-]+)\.([A-Za-z-]+)\.html$/.exec(problem.file), named = /part "([a-z0-9_-]+)"/.exec(problem.text);
  return { ...problem, part: page ? page[1] : named ? named[1] : "", language: page ? page[2] : "" };
}

// A build's sentence says what to write into parts.json; here there is a field for it.
function forPage(text) {
  const names = new Intl.DisplayNames([], { type: "language" });
  const short = text.replace(/^part "[^"]*"[:,]? /, "").replace(/: add "[a-z]+": .*$/, "").replace(/in "([A-Za-z-]+)"/, (all, code) => `in ${names.of(code)}`);
  return short[0].toUpperCase() + short.slice(1);
}

function showProblems(list) {
  byId("problems").replaceChildren(...list.map(problem => {
    const item = document.createElement("li");
    item.className = problem.error ? "error" : "";
    item.textContent = `${problem.language && problem.language !== language ? `${problem.language}: ` : ""}${forPage(problem.text)}`;
    return item;
  }));
}

const problemsHere = () => information.problems.filter(problem => part && problem.part === part.id && (!problem.language || problem.language === language));

// ---- loading

async function loadInformation() {
  information = await ask("GET", "/api/information");
  information.problems = information.problems.map(locate);
  setPictures(information.pictures);
  byId("name").textContent = information.name;
  if (!language) language = information.languages[0];
  if (part) part = information.parts.find(one => one.id === part.id) || null;
  showList(information.parts, part?.id, information.languages, information.problems);
  if (part) { showLanguages(); showProblems(problemsHere()); }
}

function showLanguages() {
  const names = new Intl.DisplayNames([], { type: "language" });
  byId("languages").replaceChildren(...information.languages.map(code => {
    const button = document.createElement("button"), dot = document.createElement("i");
    const has = [part.title?.[code], part.caption?.[code], part.without_page || part.pages[code]].filter(Boolean).length;
    const words = has === 3 ? "complete" : has ? "incomplete" : "nothing yet";
    dot.className = has === 3 ? "" : has ? "some" : "none";
    button.type = "button";
    button.setAttribute("role", "tab");
    button.setAttribute("aria-selected", String(code === language));
    button.tabIndex = code === language ? 0 : -1;
    button.title = words;
    button.append(dot, names.of(code), Object.assign(document.createElement("span"), { className: "hidden", textContent: `, ${words}` }));
    button.addEventListener("click", () => open(part.id, code));
    return button;
  }));
}

function arrowTabs(list) {
  list.addEventListener("keydown", event => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key], tabs = [...list.children];
    if (!step) return;
    event.preventDefault();
    const next = tabs[(tabs.indexOf(document.activeElement) + step + tabs.length) % tabs.length];
    next.focus();
    next.click();
  });
}

async function open(id, code = language) {
  const other = part?.id !== id || code !== language;
  if (dirty && other && !confirm("What you wrote is not saved. Leave it?")) return;
  if (part?.id !== id) shown = "";
  part = information.parts.find(one => one.id === id);
  language = code;
  byId("nothing").hidden = true;
  byId("work").hidden = false;
  for (const name of FIELDS) {
    loaded[name] = part[name]?.[language] || "";
    byId(name).value = loaded[name];
  }
  for (const element of [byId("page"), ...FIELDS.map(byId)]) element.lang = language;
  byId("page").dir = byId("title").dir = byId("caption").dir = "auto";
  showLanguages();
  showList(information.parts, part.id, information.languages, information.problems);
  showProblems(problemsHere());
  if (other) tell("");
  await loadPage();
  history.replaceState(null, "", `#${id}.${language}`);
  showPanel();
}

// Says which text is in the editor, unless it is the part's own.
function showWhich() {
  const parts = information.parts.filter(one => one.documents?.includes(shown) || one.id === shown).map(one => titleOf(one, information.languages));
  byId("document").hidden = !shown;
  byId("document").textContent = `Below is “${shown}”, which is on the page of: ${parts.join(", ") || "no part"}.`;
}

async function editDocument(id) {
  const wanted = id === part.id ? "" : id;
  if (wanted === shown) return;
  if (dirty && !confirm("What you wrote is not saved. Leave it?")) return;
  shown = wanted;
  await loadPage();
  showPanel();
}

async function setDocuments(of, list) {
  await changeFiles(() => ask("POST", `/api/parts/${of.id}/texts`, { changes: [{ field: "documents", language: "", from: (of.documents || []).join("\n"), to: list.join("\n") }] }));
  if (shown && !part.documents?.includes(shown)) await editDocument(part.id);
  showWhich();
}

// Nothing can be written on the page before it is here, because it would be lost.
async function loadPage() {
  showWhich();
  allowEditing(false);
  const page = await ask("GET", pageAddress());
  tag = page.tag;
  setPage(page.html || "<p><br></p>");
  loadedText = pageText();
  allowEditing(may("editor"));
  edited(); // fields may have been written in meanwhile
}

// ---- saving

async function saveTexts() {
  const changes = FIELDS.filter(name => byId(name).value.trim() !== loaded[name])
    .map(field => ({ field, language, from: loaded[field], to: byId(field).value.trim() }));
  if (!changes.length) return true;
  try {
    await ask("POST", `/api/parts/${part.id}/texts`, { changes });
    for (const change of changes) loaded[change.field] = change.to;
    return true;
  } catch (failure) {
    if (failure.status === 409 && failure.answer?.field) {
      const { field, theirs } = failure.answer;
      loaded[field] = theirs;
      tell(`Somebody else has changed the ${field} meanwhile, to “${theirs}”. Yours is still in the field: change it as it should be, and save again.`);
    } else fail(failure);
    return false;
  }
}

async function savePage() {
  const text = pageText();
  if (text === loadedText) return true;
  const condition = tag ? { "If-Match": `"${tag}"` } : { "If-None-Match": "*" };
  try {
    const answer = text ? await ask("PUT", pageAddress(), { html: text }, condition) : await ask("DELETE", pageAddress(), undefined, condition);
    tag = answer.tag;
    if (answer.merged) {
      setPage(answer.html);
      tell("Saved, together with what somebody else has changed on this page meanwhile.", true);
    }
    loadedText = pageText();
    return true;
  } catch (failure) {
    if (failure.status === 409 && failure.answer?.html) {
      tag = failure.answer.tag;
      setPage(failure.answer.html, true);
      tell("Somebody else has changed the same paragraph meanwhile. Both texts are on the page, blue and green: keep one, or make one of both, and save again.");
    } else fail(failure);
    return false;
  }
}

function fail(failure) {
  const problems = failure.answer?.problems;
  if (problems?.length) showProblems(problems.map(locate));
  tell(problems?.length ? "Not saved: this cannot be published. See below." : `Not saved: ${failure.message}`);
  byId("message").scrollIntoView({ block: "center" });
}

async function save() {
  if (saving || !part || !may("editor")) return;
  saving = true;
  byId("save").disabled = true;
  byId("state").textContent = "Saving …";
  tell("");
  try {
    const good = await saveTexts() && await savePage();
    setDirty(!good);
    if (good) {
      await loadInformation();
      showPanel();
      if (byId("message").hidden) byId("state").textContent = "Saved";
    }
  } catch (failure) {
    fail(failure);
    setDirty(true);
  }
  saving = false;
}

// ---- the panels at the right

async function restore(version) {
  try {
    await ask("POST", "/api/restore", { document: pageName(), version, tag });
    await loadInformation();
    await open(part.id);
    tell("This is the old version. It was saved as a new one, so nothing is lost.", true);
  } catch (failure) {
    fail(failure);
  }
}

async function setField(change) {
  try {
    await ask("POST", `/api/parts/${part.id}/texts`, { changes: [change] });
    await loadInformation();
    if (change.language === language && FIELDS.includes(change.field)) {
      loaded[change.field] = byId(change.field).value = change.to;
      edited();
    }
    showPanel();
  } catch (failure) {
    if (failure.status === 409) tell(`Somebody else has changed this meanwhile, to “${failure.answer.theirs}”.`);
    else fail(failure);
    await loadInformation();
  }
}

async function changeFiles(work) {
  tell("");
  byId("state").textContent = "Sending …";
  try {
    await work();
    await loadInformation();
    byId("state").textContent = "Saved";
  } catch (failure) {
    byId("state").textContent = "";
    fail(failure);
    if (failure.status === 412) await loadInformation();
  }
  showPanel();
}

async function remove() {
  if (!confirm(`Remove “${titleOf(part, information.languages)}” with its pages in all languages? They stay in the history.`)) return;
  try {
    await ask("DELETE", `/api/parts/${part.id}`);
    part = null;
    setDirty(false);
    byId("work").hidden = true;
    byId("nothing").hidden = false;
    await loadInformation();
  } catch (failure) {
    fail(failure);
  }
}

function showPanel() {
  for (const tab of byId("side-tabs").children) {
    const on = tab.getAttribute("aria-controls") === panel;
    tab.setAttribute("aria-selected", String(on));
    tab.tabIndex = on ? 0 : -1;
    byId(tab.getAttribute("aria-controls")).hidden = !on;
  }
  if (!part) return;
  if (panel === "history") showHistory(part, language, pageName(), restore, setField);
  if (panel === "documents") showDocuments({ part, parts: information.parts, documents: information.documents, titleOf: one => titleOf(one, information.languages),
    shown: pageId(), language, edit: editDocument, set: setDocuments, done: changeFiles });
  if (panel === "sound") showSound(part, language, changeFiles);
  if (panel === "about") showAbout(part, information.credits, language, setField, remove);
  if (panel === "preview") showPreview(part, language, dirty && !shown ? pageText() : null);
}

// ---- files that are dropped, links, pictures

async function takeFiles(files) {
  for (const file of files) {
    try {
      if (soundKind(file)) {
        await changeFiles(() => sendSound(soundKind(file), part, language, file));
        continue;
      }
      if (/^image\//.test(file.type)) {
        byId("state").textContent = `Sending ${file.name} …`;
        const name = await sendPicture(file);
        insertBlocks(makeFigure({ name, alt: "", caption: "", credit: "" }));
      } else if (/^text\/html/.test(file.type)) {
        insertBlocks(clean(await file.text()));
      } else if (/^text\//.test(file.type)) {
        const text = await file.text(), box = document.createElement("div");
        for (const lines of text.split(/\n\s*\n/)) box.append(Object.assign(document.createElement("p"), { textContent: lines }));
        insertBlocks(clean(box.innerHTML));
      } else tell(`${file.name}: pictures (JPEG, PNG, WebP), texts, web pages and speech (Opus, WebVTT) can be taken.`);
    } catch (failure) {
      tell(`${file.name}: ${failure.message}`);
    }
  }
  edited();
}

function takeDrop(data) {
  if (data.files.length) return takeFiles([...data.files]);
  const html = data.getData("text/html"), address = data.getData("text/uri-list");
  if (html) insertBlocks(clean(html));
  else if (address) insertBlocks(clean(`<p>${address.replace(/[&<]/g, c => c === "&" ? "&amp;" : "&lt;")}</p>`)); // the kiosk shows nothing outside the release
  else return Promise.resolve();
  setDirty(true);
  return Promise.resolve();
}

function linkTargets() {
  const names = list => list.map(one => [one.id, titleOf(one, [language, ...information.languages])]);
  return [
    { label: "Pages", options: names(information.parts.filter(one => !one.without_page)).map(([id, title]) => [`page:${id}`, title]) },
    { label: "Parts on the model", options: names(information.parts).map(([id, title]) => [`part:${id}`, title]) },
    { label: "Tours", options: names(information.tours).map(([id, title]) => [`tour:${id}`, title]) },
  ];
}

function openFigure(figure) {
  pickPicture(readFigure(figure), true, picked => {
    if (picked) {
      const fresh = makeFigure(picked).firstElementChild;
      fresh.querySelector("img").setAttribute("src", pictureAddress(picked.name));
      figure.replaceChildren(...fresh.childNodes);
    } else figure.remove();
    setDirty(true);
  });
}

// ---- setting up

const edited = () => setDirty(pageText() !== loadedText || FIELDS.some(name => byId(name).value.trim() !== loaded[name]));

setUpEditor(edited, setUpLinks(linkTargets), openFigure, takeFiles);
setUpList(id => open(id), async (id, before) => {
  try {
    await ask("POST", `/api/parts/${id}/place`, { before });
    await loadInformation();
    byId("state").textContent = "The order is saved";
    byId(`part-${id}`)?.focus();
  } catch (failure) {
    tell(failure.message);
  }
}, async (id, data) => {
  const files = [...data.files];
  if (part?.id !== id) await open(id);
  if (part?.id === id) await (files.length ? takeFiles(files) : takeDrop(data));
});
arrowTabs(byId("languages"));
arrowTabs(byId("side-tabs"));
for (const tab of byId("side-tabs").children) tab.addEventListener("click", () => { panel = tab.getAttribute("aria-controls"); showPanel(); });
for (const name of FIELDS) byId(name).addEventListener("input", edited);
byId("picture").addEventListener("click", () => pickPicture(null, true, picked => { if (picked) insertBlocks(makeFigure(picked)); }));
byId("save").addEventListener("click", save);
document.addEventListener("keydown", event => {
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "s") { event.preventDefault(); save(); }
});
addEventListener("beforeunload", event => { if (dirty) event.preventDefault(); });
const page = byId("page");
page.addEventListener("dragover", event => { if (may("editor") && !event.dataTransfer.types.includes("text/x-part")) { event.preventDefault(); page.classList.add("dropping"); } });
page.addEventListener("dragleave", () => page.classList.remove("dropping"));
page.addEventListener("drop", event => { event.preventDefault(); page.classList.remove("dropping"); takeDrop(event.dataTransfer); });

loadSession().then(async session => {
  if (session.role === "nobody") { location.assign("/sign-in"); return; }
  showAccount(session);
  allowEditing(may("editor"));
  for (const name of FIELDS) byId(name).readOnly = !may("editor");
  await loadInformation();
  const [id, code] = location.hash.slice(1).split(".");
  const first = information.parts.find(one => one.id === id) || information.parts[0];
  if (first) await open(first.id, information.languages.includes(code) ? code : language);
}).catch(failure => { byId("nothing").textContent = failure.message; });
