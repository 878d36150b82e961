// The page of a part, edited as it looks: the toolbar, pasting, figures, and places where two people wrote at once.
import { keyOf } from "./browser.js";
import { clean, isKept, pictureAddress, textOf } from "./clean.js";

const byId = id => document.getElementById(id);
const page = byId("page"), style = byId("style");
let changed = () => {}, before = "", after = "", range = null, editable = true;

// What stands around the body in the file stays as it is.
function split(html) {
  const start = html.search(/<body[^>]*>/i), end = html.search(/<\/body>/i);
  if (start < 0 || end < start) return ["", html, ""];
  const first = start + html.slice(start).indexOf(">") + 1;
  return [html.slice(0, first), html.slice(first, end), html.slice(end)];
}

// Gives cleaned blocks the addresses of their pictures, before they come to the page.
function named(blocks) {
  for (const image of blocks.querySelectorAll("img")) image.setAttribute("src", pictureAddress(image.getAttribute("src")));
  for (const figure of blocks.querySelectorAll("figure")) {
    figure.setAttribute("contenteditable", "false");
    figure.setAttribute("tabindex", "0");
  }
  return blocks;
}

// The text of a merge as pieces of whole blocks, {mine, theirs}: lines between the marks are one curator's alone, and where a
// list or a table is open, all of it belongs to the piece. Half a list would lose what makes it one.
function wholeBlocks(marked) {
  const pieces = [], depth = { mine: 0, theirs: 0 };
  let piece = { mine: "", theirs: "" }, sides = ["mine", "theirs"];
  for (const line of marked.split("\n")) {
    if (/^<{7} /.test(line)) { sides = ["mine"]; continue; }
    if (/^={7}$/.test(line)) { sides = ["theirs"]; continue; }
    const ends = /^>{7} /.test(line);
    if (ends) sides = ["mine", "theirs"];
    for (const side of ends ? [] : sides) {
      piece[side] += `${line}\n`;
      depth[side] += (line.match(/<(p|h[1-6]|div|blockquote|ul|ol|figure|table)\b/gi) || []).length - (line.match(/<\/(p|h[1-6]|div|blockquote|ul|ol|figure|table)\b/gi) || []).length;
    }
    if (sides.length < 2 || depth.mine > 0 || depth.theirs > 0) continue;
    pieces.push(piece);
    piece = { mine: "", theirs: "" };
  }
  return [...pieces, piece];
}

// One of two texts, with a button that keeps it alone.
function overlapBox(side, blocks) {
  const box = document.createElement("div"), choice = document.createElement("div"), button = document.createElement("button");
  box.dataset.overlap = side;
  choice.className = "choice";
  choice.contentEditable = "false";
  choice.textContent = side === "mine" ? "Yours" : "Somebody else's";
  button.type = "button";
  button.textContent = "Keep this alone";
  button.addEventListener("click", () => {
    const other = side === "mine" ? box.nextElementSibling : box.previousElementSibling;
    if (other && other.dataset.overlap) other.remove();
    choice.remove();
    box.replaceWith(...box.childNodes);
    changed();
  });
  choice.append(button);
  box.append(choice, ...named(blocks).childNodes);
  return box;
}

function showOverlaps(marked) {
  const out = document.createElement("div");
  for (const { mine, theirs } of wholeBlocks(marked))
    if (mine === theirs) out.append(...named(clean(mine)).childNodes);
    else out.append(overlapBox("mine", clean(mine)), overlapBox("theirs", clean(theirs)));
  page.replaceChildren(...out.childNodes);
}

// The first place where somebody still has to decide between two texts, or null.
export const firstOverlap = () => page.querySelector("[data-overlap]");

// Returns whether all of it is shown, and would be there again in what pageText() gives. A text that two wrote at once has
// marks of a merge.
export function setPage(html) {
  const [head, body, tail] = split(html);
  before = head;
  after = tail;
  if (/^<{7} /m.test(body)) {
    showOverlaps(body);
    firstOverlap().scrollIntoView({ block: "center" });
    return true;
  }
  page.replaceChildren(...named(clean(body)).childNodes);
  return isKept(body);
}

// "" if there is nothing on it. A new page has no frame around it.
export function pageText() {
  const blocks = clean(page.innerHTML), text = textOf(blocks);
  if (!blocks.textContent.trim() && !blocks.querySelector("img, hr")) return ""; // an empty paragraph, to write in
  return before ? `${before}\n${text}\n${after}` : `${text}\n`;
}

export const isEditable = () => editable;

export function allowEditing(on) {
  editable = on;
  page.contentEditable = String(on);
  page.setAttribute("aria-readonly", String(!on));
  for (const control of document.querySelectorAll(".toolbar button, .toolbar select")) control.disabled = !on;
}

// ---- the selection

function keepRange() {
  const selection = getSelection();
  if (selection.rangeCount && page.contains(selection.anchorNode)) range = selection.getRangeAt(0).cloneRange();
}

function restoreRange() {
  page.focus();
  const selection = getSelection();
  selection.removeAllRanges();
  if (!range || !page.contains(range.startContainer)) {
    range = document.createRange();
    range.selectNodeContents(page);
    range.collapse(false);
  }
  selection.addRange(range);
}

function around(tags) {
  let node = getSelection().anchorNode;
  for (; node && node !== page; node = node.parentNode)
    if (node.nodeType === Node.ELEMENT_NODE && tags.includes(node.tagName)) return node;
  return null;
}

function showState() {
  keepRange();
  if (!page.contains(getSelection().anchorNode)) return;
  const block = around(["H1", "H2", "H3", "BLOCKQUOTE", "P"]);
  style.value = block ? block.tagName.toLowerCase() : "p";
  for (const button of document.querySelectorAll("[data-command]"))
    if (["bold", "italic", "insertUnorderedList", "insertOrderedList"].includes(button.dataset.command))
      button.setAttribute("aria-pressed", String(document.queryCommandState(button.dataset.command)));
}

function run(command, value) {
  restoreRange();
  document.execCommand(command, false, value);
  showState();
  changed();
}

export function insertBlocks(blocks) {
  const last = [...page.children].at(-1);
  named(blocks);
  let at = range && page.contains(range.startContainer) ? range.startContainer : last;
  while (at && at.parentNode !== page) at = at === page ? page.lastChild : at.parentNode;
  const added = [...blocks.childNodes];
  if (at) at.after(...added);
  else page.append(...added);
  if (!page.lastElementChild || page.lastElementChild.tagName === "FIGURE") {
    const empty = document.createElement("p");
    empty.append(document.createElement("br"));
    page.append(empty);
  }
  changed();
  added.at(-1)?.scrollIntoView?.({ block: "nearest" });
}

// ---- links

export function setUpLinks(targets) {
  const dialog = byId("link-dialog"), choice = byId("link-target");
  const open = () => {
    if (!editable) return;
    keepRange();
    const link = around(["A"]);
    choice.replaceChildren(...targets().map(({ label, options }) => {
      const group = document.createElement("optgroup");
      group.label = label;
      group.append(...options.map(([value, text]) => new Option(text, value)));
      return group;
    }));
    if (link) choice.value = link.getAttribute("href");
    dialog.querySelector("[value=remove]").hidden = !link;
    dialog.returnValue = "";
    dialog.showModal();
  };
  byId("link").addEventListener("click", open);
  choice.addEventListener("dblclick", () => dialog.close("ok"));
  dialog.addEventListener("close", () => {
    restoreRange();
    const link = around(["A"]);
    if (dialog.returnValue === "remove" && link) link.replaceWith(...link.childNodes);
    else if (dialog.returnValue !== "ok" || !choice.value) return;
    else if (link) link.setAttribute("href", choice.value);
    else if (getSelection().isCollapsed) {
      const fresh = document.createElement("a");
      fresh.setAttribute("href", choice.value);
      fresh.textContent = choice.selectedOptions[0].textContent;
      range.insertNode(fresh);
    } else document.execCommand("createLink", false, choice.value);
    changed();
  });
  return open;
}

// ---- setting up

export function setUpEditor(onChange, openLink, openFigure, takeFiles) {
  changed = onChange;
  document.execCommand("defaultParagraphSeparator", false, "p");
  document.addEventListener("selectionchange", showState);
  page.addEventListener("input", () => {
    if (!page.textContent && !page.querySelector("img")) page.innerHTML = "<p><br></p>";
    changed();
  });
  style.addEventListener("change", () => run("formatBlock", style.value));
  for (const button of document.querySelectorAll("[data-command]")) {
    button.addEventListener("mousedown", event => event.preventDefault());
    button.addEventListener("click", () => run(button.dataset.command));
  }
  page.addEventListener("keydown", event => {
    const control = event.ctrlKey || event.metaKey;
    if (control && keyOf(event) === "k") { event.preventDefault(); openLink(); }
    if (event.target.tagName === "FIGURE" && (event.key === "Enter" || event.key === " ")) { event.preventDefault(); openFigure(event.target); }
    if (event.target.tagName === "FIGURE" && (event.key === "Delete" || event.key === "Backspace")) { event.preventDefault(); event.target.remove(); changed(); }
  });
  page.addEventListener("click", event => {
    const figure = event.target.closest("figure");
    if (figure && editable) openFigure(figure);
    else if (event.target.closest("a")) event.preventDefault();
  });
  page.addEventListener("paste", event => {
    event.preventDefault();
    const data = event.clipboardData, html = data.getData("text/html");
    const blocks = clean(html || data.getData("text/plain").split(/\n\s*\n/).map(text => `<p>${text.replace(/[&<]/g, c => c === "&" ? "&amp;" : "&lt;")}</p>`).join(""));
    // A picture alone, from a browser or a program for texts, comes with an address that means nothing here.
    if (data.files.length && (!html || (!blocks.textContent.trim() && !blocks.querySelector("img")))) { takeFiles([...data.files]); return; }
    const isLine = blocks.children.length === 1 && blocks.firstElementChild.tagName === "P";
    document.execCommand("insertHTML", false, isLine ? blocks.firstElementChild.innerHTML : named(blocks).innerHTML);
  });
}
