// The part that is marked: its title, saving it, the list of all parts, and whether something is not saved. Which part is
// open is what the program answers, as the region lives there; a click alone opens nothing.
import { ask, may } from "./api.js";
import { guardLeaving } from "./browser.js";

const byId = id => document.getElementById(id);
let send = () => {}, tell = () => {}, connected = false;
let parts = [], openedId = "", region = { triangles: 0, undo: 0, redo: 0 };
let filled = "";             // what the field of the title was filled with
let changed = false;         // the region, since it was opened or saved
let saving = false, beginning = 0; // messages without an answer: a save; those that open a part or begin a new one

export function setUpPart(sendMessage, tellSentence) {
  send = sendMessage;
  tell = tellSentence;
}

const title = () => byId("title").value.trim();
const isTyped = () => title() !== filled;
export const isUnsaved = () => connected && may("editor") && (changed || isTyped()) && Boolean(openedId || region.triangles);

// A part that was removed meanwhile is in no list.
const nameOf = id => parts.find(part => part.id === id)?.title || id;

// Fills the field with the part's title in the chosen language; what was typed by hand stays.
function fill() {
  const typed = isTyped();
  filled = parts.find(part => part.id === openedId)?.titles[byId("language").value] || "";
  if (!typed) byId("title").value = filled;
}

function show() {
  byId("heading").textContent = openedId ? `Part: ${nameOf(openedId)}` : "New part";
  byId("save").disabled = !connected || !region.triangles || saving || beginning > 0 || !may("editor");
  byId("fresh").disabled = !connected;
  byId("publish-unsaved").hidden = !isUnsaved();
}

function showParts() {
  byId("parts").replaceChildren(...parts.map(part => {
    const item = document.createElement("li"), button = document.createElement("button"), small = document.createElement("small");
    button.type = "button";
    button.textContent = part.title || part.id;
    small.textContent = part.faces ? part.id : "a box or ball so far, not marked";
    button.disabled = !connected;
    button.setAttribute("aria-current", String(part.id === openedId));
    button.append(small);
    button.addEventListener("click", () => begin({ type: "open", id: part.id }));
    const write = Object.assign(document.createElement("a"), { href: `/information#${part.id}`, textContent: "Write", title: `Write about ${part.title || part.id}` });
    item.className = "part";
    item.append(button, write);
    return item;
  }));
  show();
}

// ---- what is asked for

// Returns whether it was asked for.
function begin(message) {
  if (isUnsaved() && !confirm("What you marked is not saved. Leave it?")) return false;
  tell("");
  beginning++;
  send(message);
  show();
  return true;
}

// A new part's id comes from its title, if that has Latin letters; the program puts a number behind one that is taken.
const idFor = text => text.normalize("NFD").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 56) || "part";

// A title is sent only if it was typed here: others may have written the part's meanwhile.
function save({ asNew = false, replace = false } = {}) {
  const isNew = asNew || !openedId, language = byId("language").value;
  tell("");
  saving = true;
  if (isNew) send({ type: "save", new: true, id: idFor(title()), title: title(), language });
  else send({ type: "save", id: openedId, title: isTyped() ? title() : "", from: filled, language, replace });
  show();
}

byId("part").addEventListener("submit", event => {
  event.preventDefault();
  if (!byId("save").disabled) save();
});
byId("fresh").addEventListener("click", () => {
  if (!begin({ type: "empty" })) return;
  byId("title").value = filled = ""; // at once: the next title may be typed before the answer comes
  byId("title").focus();
});
byId("title").addEventListener("input", show);
byId("language").addEventListener("change", () => { fill(); show(); });
guardLeaving(isUnsaved);

// ---- answers

export function takeHello(message) {
  connected = true;
  byId("language").replaceChildren(...message.languages.map(code => new Option(code, code)));
}

export function takeRegion(message) {
  if (message.opened === undefined) changed ||= ["triangles", "undo", "redo"].some(key => message[key] !== region[key]);
  region = message;
  if (message.opened === undefined) { show(); return; }
  beginning = Math.max(0, beginning - 1); // the first region is of no part, and nobody asked for it
  changed = false;
  openedId = message.opened;
  if (!beginning) {
    if (openedId) byId("title").value = filled; // what was typed there was another part's
    fill();
  }
  showParts();
}

export function takeParts(message) {
  parts = message.parts;
  if (message.saved) {
    saving = changed = false;
    openedId = message.saved;
    tell("Saved. The next build of the content takes it up. ", true);
    byId("message").append(Object.assign(document.createElement("a"), { href: `/information#${openedId}`, textContent: "Write about it" }));
    if (!beginning) fill();
  }
  showParts();
}

function button(text, more) {
  const made = Object.assign(document.createElement("button"), { type: "button", textContent: text });
  made.addEventListener("click", () => save(more));
  return made;
}

export function takeError(message) {
  if (message.of === "open" || message.of === "empty") beginning--;
  else if (message.of === "save" || !message.of) saving = false;
  show();
  if (message.conflict) {
    const choices = document.createElement("span");
    choices.className = "line";
    if (message.conflict === "changed") choices.append(button("Replace theirs", { replace: true }));
    choices.append(button("Save as a new part", { asNew: true }));
    byId("message").append(choices);
  }
  if (message.conflict || message.of === "open") ask("GET", "/api/parts").then(list => { parts = list; showParts(); }).catch(() => {});
}

// The region has gone with the session.
export function takeEnd() {
  connected = false;
  showParts();
}
