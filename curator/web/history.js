// The versions of a page or of parts.json: who, when, what was changed, and going back.
import { ask, may } from "./api.js";

const panel = document.getElementById("history"); // of the page on which texts are written
let newest = 0; // what was asked for last: a late answer is of something else

const when = seconds => new Date(seconds * 1000).toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
const words = text => text.split(/(\s+|<[^>]*>)/).filter(Boolean);
const readable = text => text.replace(/<(img|hr)[^>]*src="([^"]*)"[^>]*>/g, "[$2]").replace(/<[^>]*>/g, "").replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&");

// Longest common subsequence of two short lists of words; [sign, word] in order.
function compare(a, b) {
  if (a.length * b.length > 400000) return [...a.map(word => ["-", word]), ...b.map(word => ["+", word])];
  const best = Array.from({ length: a.length + 1 }, () => new Uint16Array(b.length + 1)), out = [];
  for (let i = a.length - 1; i >= 0; i--)
    for (let j = b.length - 1; j >= 0; j--) best[i][j] = a[i] === b[j] ? best[i + 1][j + 1] + 1 : Math.max(best[i + 1][j], best[i][j + 1]);
  let i = 0, j = 0;
  while (i < a.length || j < b.length) {
    if (i < a.length && j < b.length && a[i] === b[j]) { out.push([" ", a[i]]); i++; j++; }
    else if (j < b.length && (i === a.length || best[i][j + 1] >= best[i + 1][j])) out.push(["+", b[j++]]);
    else out.push(["-", a[i++]]);
  }
  return out;
}

function paragraph(pairs) {
  const p = document.createElement("p");
  for (const [sign, word] of pairs) {
    const text = readable(word);
    if (!text) continue;
    if (sign === " ") { p.append(text); continue; }
    const mark = document.createElement(sign === "+" ? "ins" : "del");
    mark.textContent = text;
    p.append(mark);
  }
  return p;
}

// Lines that were replaced are compared word by word.
function showDifference(lines) {
  const box = document.createElement("div");
  let gone = [], come = [];
  const flush = () => {
    for (let n = 0; n < Math.max(gone.length, come.length); n++) {
      const p = paragraph(compare(words(gone[n] || ""), words(come[n] || "")));
      if (p.textContent.trim()) box.append(p);
    }
    gone = [];
    come = [];
  };
  box.className = "difference";
  for (const line of lines.split("\n")) {
    if (line[0] === "-" && come.length) flush();
    if (line[0] === "-") gone.push(line.slice(1));
    else if (line[0] === "+") come.push(line.slice(1));
    else flush();
  }
  flush();
  if (!box.children.length) box.textContent = "Nothing that can be read has changed.";
  return box;
}

async function openVersion(item, button, document_, version, older, restored) {
  const address = `/api/difference?document=${encodeURIComponent(document_)}&from=${older || ""}&to=${version.version}`;
  if (item.children.length > 1) { item.lastElementChild.remove(); button.setAttribute("aria-expanded", "false"); return; }
  const box = document.createElement("div");
  button.setAttribute("aria-expanded", "true");
  try {
    if (version.removed) box.append("The page was removed.");
    else if (older) box.append(showDifference((await ask("GET", address)).lines));
    else {
      const { text } = await ask("GET", `/api/version?document=${encodeURIComponent(document_)}&version=${version.version}`);
      const p = document.createElement("p");
      p.textContent = readable(text).replace(/\s+/g, " ").slice(0, 1500);
      box.append(p);
      box.className = "difference";
    }
    if (!version.removed && may("editor") && restored) {
      const back = document.createElement("button"), row = document.createElement("div");
      back.type = "button";
      back.textContent = "Go back to this version";
      back.addEventListener("click", () => restored(version.version));
      row.className = "difference";
      row.append(back);
      box.append(row);
    }
  } catch (failure) {
    box.textContent = failure.message;
  }
  item.append(box);
}

export async function versionsOf(document_, restored) {
  const { versions } = await ask("GET", `/api/versions?document=${encodeURIComponent(document_)}`);
  const list = document.createElement("ul");
  list.className = "versions";
  list.append(...versions.map((version, n) => {
    const item = document.createElement("li"), button = document.createElement("button"), small = document.createElement("small");
    button.type = "button";
    button.setAttribute("aria-expanded", "false");
    button.textContent = version.author || "Outside this program";
    small.textContent = `${when(version.time)} – ${version.what}${n === 0 ? " (now)" : ""}`;
    button.append(small);
    const older = versions[n + 1] && !versions[n + 1].removed ? versions[n + 1].version : "";
    button.addEventListener("click", () => openVersion(item, button, document_, version, older, n > 0 ? restored : null));
    item.append(button);
    return item;
  }));
  return versions.length ? list : "Nothing has been written yet.";
}

function heading(text) {
  return Object.assign(document.createElement("h2"), { textContent: text });
}

const FIELD_WORDS = { title: "Title", caption: "Caption", reading: "Reading", thumbnail: "Picture", documents: "Documents" };

// One text of the card at one time: what was changed of it, and going back to it. now: the text as it is saved.
function fieldRow(change, now, set) {
  const item = document.createElement("li"), button = document.createElement("button"), small = document.createElement("small"), box = document.createElement("div");
  button.type = "button";
  button.setAttribute("aria-expanded", "false");
  button.textContent = `${FIELD_WORDS[change.field]}: ${change.to || "removed"}`;
  small.textContent = `${change.author || "Outside this program"}, ${when(change.time)}${change.to === now ? " (now)" : ""}`;
  button.append(small);
  box.className = "difference";
  box.hidden = true;
  const p = document.createElement("p");
  for (const [sign, word] of compare(change.from.split(/(\s+)/).filter(Boolean), change.to.split(/(\s+)/).filter(Boolean)))
    p.append(sign === " " ? word : Object.assign(document.createElement(sign === "+" ? "ins" : "del"), { textContent: word }));
  box.append(p);
  if (change.to !== now && may("editor")) {
    const back = document.createElement("button");
    back.type = "button";
    back.textContent = change.to ? "Go back to this text" : "Remove it again";
    back.addEventListener("click", () => set({ field: change.field, language: change.language, from: now, to: change.to }));
    box.append(back);
  }
  button.addEventListener("click", () => {
    box.hidden = !box.hidden;
    button.setAttribute("aria-expanded", String(!box.hidden));
  });
  item.append(button, box);
  return item;
}

async function cardHistory(part, language, set) {
  const { changes } = await ask("GET", `/api/parts/${part.id}/history`), list = document.createElement("ul");
  const here = changes.filter(change => !change.language || change.language === language);
  const nowOf = change => (change.language ? part[change.field]?.[change.language] : part[change.field]) || "";
  list.className = "versions";
  list.append(...here.map(change => fieldRow(change, nowOf(change), set)));
  return here.length ? list : "Nothing has been written yet.";
}

// Of a page, of the texts on the card, and of what parts.json has of all parts, which cannot go back: others' texts are in
// it too. set(change) saves one text, as POST /api/parts/ID/texts takes it.
export async function showHistory(part, language, document_, restored, set) {
  const mine = ++newest;
  panel.textContent = "Loading …";
  try {
    const page = await versionsOf(document_, restored), card = await cardHistory(part, language, set), parts = await versionsOf("parts.json", null);
    if (mine === newest) panel.replaceChildren(heading("This page"), page, heading("Title, caption, reading and picture"), card, heading("All parts"), parts);
  } catch (failure) {
    if (mine === newest) panel.textContent = failure.message;
  }
}
