// The page on which curators write: parts at the left, a part's texts and its page in the middle, preview, history and
// credits at the right. docs/curator.md has the addresses.
import { dropCredits, hasUnsavedCredit, showAbout } from "./about.js";
import { showAccount } from "./account.js";
import { ask, loadSession, may } from "./api.js";
import { guardLeaving, keyOf } from "./browser.js";
import { pictureAddress } from "./clean.js";
import { showDocuments } from "./documents.js";
import { setUpDrops, takeDrop, takeFiles } from "./drops.js";
import { allowEditing, firstOverlap, insertBlocks, pageText, setPage, setUpEditor, setUpLinks } from "./editor.js";
import { showHistory } from "./history.js";
import { setUpList, showList, titleOf } from "./part_list.js";
import { makeFigure, pickPicture, readFigure, setPictures } from "./pictures.js";
import { showPreview } from "./preview.js";
import { locate, showProblems } from "./problems.js";
import { sendSound, showSound } from "./sound.js";

const byId = id => document.getElementById(id);
const FIELDS = ["title", "caption", "reading"];
let information = { parts: [], languages: [], tours: [], problems: [], pictures: [], documents: [] };
let part = null, language = "", tag = "", loadedText = "", loaded = {}, dirty = false, panel = "preview";
let saving = null, sending = null; // promises while texts, or a credit, are on their way
let loads = 0, isLoaded = false; // of pages: a late one is not shown

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

// Says that something else was saved, unless what is written is not.
function tellSaved(words) {
  edited();
  if (!dirty) byId("state").textContent = words;
}

// Before what is open gives way to something else.
async function mayLeave() {
  await saving;
  await sending;
  if (!dirty && !hasUnsavedCredit()) return true;
  if (!confirm("What you wrote is not saved. Leave it?")) return false;
  dropCredits();
  return true;
}

const problemsHere = () => information.problems.filter(problem => part && problem.part === part.id && (!problem.language || problem.language === language));

// ---- loading

async function loadInformation() {
  information = await ask("GET", "/api/information");
  information.problems = information.problems.map(locate);
  setPictures(information.pictures);
  byId("name").textContent = information.name;
  if (!language) language = information.languages[0];
  if (part) {
    const now = information.parts.find(one => one.id === part.id);
    if (!now) tell("Somebody else has removed this part. What you wrote is still here, but cannot be saved: copy what you want to keep.");
    part = now || part;
  }
  showList(information.parts, part?.id, information.languages, information.problems);
  if (part) { showLanguages(); showProblems(problemsHere(), language); }
}

function showLanguages() {
  const names = new Intl.DisplayNames([], { type: "language" }), isHere = byId("languages").contains(document.activeElement);
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
  if (isHere) byId("languages").querySelector("[aria-selected=true]").focus();
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

// Opens a part in a language; again: also if it is open, as it is saved.
async function open(id, code = language, again = false) {
  const other = part?.id !== id || code !== language;
  if ((!other && isLoaded && !again) || !await mayLeave()) return;
  if (part?.id !== id) shown = "";
  part = information.parts.find(one => one.id === id) || part; // which somebody else may have removed
  language = code;
  byId("nothing").hidden = true;
  byId("work").hidden = false;
  for (const name of FIELDS) {
    loaded[name] = [part[name]?.[language] || ""].flat().join("\n"); // earlier programs made a list of lines
    byId(name).value = loaded[name];
  }
  for (const element of [byId("page"), ...FIELDS.map(byId)]) element.lang = language;
  byId("page").dir = byId("title").dir = byId("caption").dir = "auto";
  showLanguages();
  showList(information.parts, part.id, information.languages, information.problems);
  showProblems(problemsHere(), language);
  if (other) tell("");
  if (!await loadPage()) return;
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
  if (!await mayLeave()) return;
  shown = wanted;
  if (await loadPage()) showPanel();
}

async function setDocuments(of, list) {
  await changeFiles(() => ask("POST", `/api/parts/${of.id}/texts`, { changes: [{ field: "documents", language: "", from: (of.documents || []).join("\n"), to: list.join("\n") }] }));
  if (shown && !part.documents?.includes(shown)) await editDocument(part.id);
  showWhich();
}

// Nothing can be written on the page before it is here, because it would be lost. Returns false if another was asked for
// meanwhile.
async function loadPage() {
  const mine = ++loads;
  let page = { html: "", tag: "" }, why = "";
  showWhich();
  allowEditing(false);
  isLoaded = false;
  try {
    page = await ask("GET", pageAddress());
  } catch (failure) {
    why = failure.message;
    page.tag = failure.answer?.tag || ""; // to go back from
  }
  if (mine !== loads) return false;
  const isWhole = setPage(page.html || "<p><br></p>");
  tag = page.tag;
  loadedText = pageText();
  isLoaded = !why;
  allowEditing(may("editor") && isLoaded && isWhole);
  if (why) tell(`The page could not be loaded: ${why} Choose it again.`);
  else if (!isWhole) tell(`${pageName()} has something that cannot be edited here and is not shown, such as a picture in a list or a table: change the file itself.`);
  edited(); // fields may have been written in meanwhile
  return true;
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
  if (!isLoaded || text === loadedText) return true; // until it is here, the editor has that of the one before
  const condition = tag ? { "If-Match": `"${tag}"` } : { "If-None-Match": "*" };
  try {
    const answer = text ? await ask("PUT", pageAddress(), { html: text }, condition) : await ask("DELETE", pageAddress(), undefined, condition);
    if (answer.merged && pageText() !== text) { // what was written meanwhile began from the text that was sent
      tag = answer.sent;
      loadedText = text;
      return savePage();
    }
    tag = answer.tag;
    loadedText = text;
    if (answer.merged) {
      setPage(answer.html);
      loadedText = pageText();
      tell("Saved, together with what somebody else has changed on this page meanwhile.", true);
    }
    return true;
  } catch (failure) {
    if (failure.status !== 409 || failure.answer?.tag === undefined) fail(failure);
    else if (failure.answer.html && pageText() !== text) return savePage();
    else meet(failure.answer);
    return false;
  }
}

// Somebody else has saved the page meanwhile: what they have comes to the editor, and the next save begins from it.
function meet(theirs) {
  tag = theirs.tag;
  if (theirs.html) setPage(theirs.html);
  loadedText = firstOverlap() || !theirs.html ? "" : pageText();
  tell(firstOverlap() ? "Somebody else has changed the same paragraph meanwhile. Both texts are on the page, blue and green: keep one, or make one of both, and save again."
    : `Not saved: ${theirs.message}.`);
  byId("message").scrollIntoView({ block: "center" });
}

function fail(failure) {
  const problems = failure.answer?.problems;
  if (problems?.length) showProblems(problems.map(locate), language);
  tell(problems?.length ? "Not saved: this cannot be published. See below." : `Not saved: ${failure.message}`);
  byId(problems?.length ? "problems" : "message").scrollIntoView({ block: "center" });
}

// What is written meanwhile is not saved with it, and stays.
async function saveAll() {
  if (firstOverlap()) {
    tell("Not saved: both texts of a paragraph are still on the page, blue and green. Keep one of them first.");
    firstOverlap().scrollIntoView({ block: "center" });
    return;
  }
  byId("save").disabled = true;
  byId("state").textContent = "Saving …";
  tell("");
  try {
    await sending;
    const good = await saveTexts() && await savePage();
    edited();
    if (!good) return;
    await loadInformation();
    showPanel();
    if (byId("message").hidden) tellSaved("Saved");
  } catch (failure) {
    fail(failure);
    setDirty(true);
  }
}

function save() {
  if (!part || !may("editor")) return;
  if (byId("about").contains(document.activeElement)) document.activeElement.blur(); // a credit is sent as its field is left
  const mine = Promise.resolve(saving).then(saveAll).finally(() => { if (saving === mine) saving = null; });
  saving = mine; // one after another
}

// ---- the panels at the right

async function restore(name, version) {
  if (name !== pageName() || !await mayLeave()) return; // another one was opened, its history is on its way
  try {
    await ask("POST", "/api/restore", { document: name, version, tag });
    setDirty(false);
    await loadInformation();
    await open(part.id, language, true);
    tell("This is the old version. It was saved as a new one, so nothing is lost.", true);
  } catch (failure) {
    if (failure.status !== 412) { fail(failure); return; }
    setDirty(false);
    await open(part.id, language, true);
    tell("Somebody else has saved this page meanwhile, and this is theirs: go back once more if it is to go.");
  }
}

// Returns whether it is saved.
async function setField(change) {
  const isHere = change.language === language && FIELDS.includes(change.field), field = isHere ? byId(change.field) : null;
  let isSaved = false;
  if (isHere && field.value.trim() !== loaded[change.field] && !confirm(`What you wrote as ${change.field} is not saved. Leave it?`)) return false;
  try {
    await ask("POST", `/api/parts/${part.id}/texts`, { changes: [change] });
    isSaved = true;
    await loadInformation();
    if (isHere) loaded[change.field] = field.value = change.to;
    edited();
  } catch (failure) {
    if (failure.status === 409) tell(`Not saved: somebody else has changed this meanwhile, to “${failure.answer.theirs}”. Yours is still in its field: change it as it should be.`);
    else fail(failure);
    await loadInformation().catch(() => {});
  }
  showPanel();
  return isSaved;
}

const sendField = change => (sending = setField(change).finally(() => { sending = null; }));

async function changeFiles(work) {
  tell("");
  byId("state").textContent = "Sending …";
  try {
    await work();
    await loadInformation();
    tellSaved("Saved");
  } catch (failure) {
    tellSaved("");
    fail(failure);
    if (failure.status === 409 || failure.status === 412) await loadInformation(); // what others have, for the next try
  }
  showPanel();
}

async function remove() {
  if (!confirm(`Remove “${titleOf(part, information.languages)}” with its region on the model, its texts and its pages in all languages? They stay in the history.`)) return;
  await saving;
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
  const name = pageName();
  if (panel === "history") showHistory(part, language, name, version => restore(name, version), sendField);
  if (panel === "documents") showDocuments({ part, parts: information.parts, documents: information.documents, titleOf: one => titleOf(one, information.languages),
    shown: pageId(), language, edit: editDocument, set: setDocuments, done: changeFiles });
  if (panel === "sound") showSound(part, language, changeFiles);
  if (panel === "about") showAbout(part, information.credits, language, sendField, remove);
  if (panel === "preview") showPreview(part, language, dirty && !shown ? pageText() : null);
}

// ---- links, pictures

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

setUpDrops({
  opened: () => `${part.id} ${language} ${shown}`,
  sound: (kind, file) => changeFiles(() => sendSound(kind, part, language, file)),
  tell,
  state: words => { byId("state").textContent = words; },
  edited,
});
setUpEditor(edited, setUpLinks(linkTargets), openFigure, takeFiles);
setUpList(id => open(id), async (id, before) => {
  try {
    await ask("POST", `/api/parts/${id}/place`, { before });
    await loadInformation();
    tellSaved("The order is saved");
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
  if ((event.ctrlKey || event.metaKey) && keyOf(event) === "s") { event.preventDefault(); save(); }
});
guardLeaving(() => dirty || saving || hasUnsavedCredit());
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
