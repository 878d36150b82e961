// HTML from anywhere to what a page may have, and back to a text with a block on each line, so that two people who edit
// different paragraphs edit different lines.
const BLOCKS = new Set(["P", "H1", "H2", "H3", "BLOCKQUOTE", "UL", "OL", "FIGURE", "TABLE", "HR"]);
const RENAMED = { STRONG: "STRONG", B: "STRONG", EM: "EM", I: "EM", CITE: "CITE", SMALL: "SMALL", SUB: "SUB", SUP: "SUP", Q: "Q", DFN: "DFN", ABBR: "ABBR", TIME: "TIME" };
const HEADINGS = { H4: "H3", H5: "H3", H6: "H3" };
const DROPPED = new Set(["SCRIPT", "STYLE", "TEMPLATE", "IFRAME", "OBJECT", "EMBED", "NOSCRIPT", "SVG", "MATH", "HEAD", "TITLE", "META", "LINK", "BUTTON", "INPUT", "SELECT", "TEXTAREA", "CANVAS", "VIDEO", "AUDIO"]);
const INSIDE = { UL: ["LI"], OL: ["LI"], TABLE: ["CAPTION", "TR"] };
// What is made here loads nothing: its pictures are named as in a page, not by an address.
const inert = document.implementation.createHTMLDocument("");
const PICTURE = "/api/picture?name=";

export const pictureAddress = name => PICTURE + encodeURIComponent(name);

// "pictures/gate.jpg" of an address in the editor or of a page; "" if it is not of this folder.
export function pictureName(address) {
  const at = address.indexOf(PICTURE);
  const name = at >= 0 ? decodeURIComponent(address.slice(at + PICTURE.length)) : address;
  return /^pictures\/[^/\\"<>?#%.][^/\\"<>?#%]*$/.test(name) ? name : "";
}

const isBlank = node => !node.textContent.replace(/[\s\u00a0]/g, "") && !(node.querySelector && node.querySelector("img, br"));

// Appends what is kept of a node's children to an element that holds text.
function cleanInline(from, to) {
  for (const node of from.childNodes) {
    if (node.nodeType === Node.TEXT_NODE) {
      to.append(node.data.replace(/[ \t\r\n]+/g, " "));
      continue;
    }
    if (node.nodeType !== Node.ELEMENT_NODE || DROPPED.has(node.tagName)) continue;
    if (node.tagName === "BR") { to.append(inert.createElement("br")); continue; }
    if (node.tagName === "A" && /^(part|page|tour):[a-z0-9_-]+$/.test(node.getAttribute("href") || "")) {
      const link = inert.createElement("a");
      link.setAttribute("href", node.getAttribute("href"));
      cleanInline(node, link);
      to.append(link);
      continue;
    }
    const bold = /^(bold|[6-9]00)$/.test(node.style.fontWeight), italic = node.style.fontStyle === "italic";
    const name = RENAMED[node.tagName] || (node.tagName === "SPAN" && (bold ? "STRONG" : italic ? "EM" : ""));
    if (!name) {
      cleanInline(node, to);
      if (BLOCKS.has(node.tagName) || node.tagName === "DIV" || node.tagName === "LI") to.append(" ");
      continue;
    }
    const kept = inert.createElement(name);
    cleanInline(node, kept);
    to.append(kept);
  }
}

function cleanFigure(from, to) {
  const image = from.tagName === "IMG" ? from : from.querySelector("img");
  const name = image ? pictureName(image.getAttribute("src") || "") : "";
  if (!name) return;
  const figure = inert.createElement("figure"), kept = inert.createElement("img"), words = from.querySelector("figcaption");
  kept.setAttribute("src", name);
  kept.setAttribute("alt", image.getAttribute("alt") || "");
  figure.append(kept);
  if (words && !isBlank(words)) {
    const caption = inert.createElement("figcaption");
    cleanInline(words, caption);
    figure.append(caption);
  }
  to.append(figure);
}

function cleanRows(from, to) {
  for (const node of from.children) {
    if (["THEAD", "TBODY", "TFOOT"].includes(node.tagName)) { cleanRows(node, to); continue; }
    if (node.tagName === "CAPTION") {
      const caption = inert.createElement("caption");
      cleanInline(node, caption);
      to.append(caption);
    }
    if (node.tagName !== "TR") continue;
    const row = inert.createElement("tr");
    for (const cell of node.children) {
      if (cell.tagName !== "TD" && cell.tagName !== "TH") continue;
      const kept = inert.createElement(cell.tagName);
      cleanInline(cell, kept);
      row.append(kept);
    }
    to.append(row);
  }
}

function cleanList(from, to, name) {
  const list = inert.createElement(name);
  for (const node of from.children) {
    if (node.tagName === "UL" || node.tagName === "OL") { // as browsers nest lists
      cleanList(node, list.lastElementChild || list, node.tagName);
      continue;
    }
    const item = inert.createElement("li"), words = node.cloneNode(true);
    for (const inner of words.querySelectorAll("ul, ol")) inner.remove();
    cleanInline(words, item);
    for (const inner of node.querySelectorAll(":scope > ul, :scope > ol")) cleanList(inner, item, inner.tagName);
    if (!isBlank(item)) list.append(item);
  }
  if (list.children.length) to.append(list);
}

// Appends blocks. Text that is in no block becomes paragraphs.
function cleanBlocks(from, to) {
  let loose = null;
  const close = () => { if (loose && !isBlank(loose)) to.append(loose); loose = null; };
  for (const node of from.childNodes) {
    const name = node.nodeType === Node.ELEMENT_NODE ? HEADINGS[node.tagName] || node.tagName : "";
    if (DROPPED.has(name) || node.nodeType === Node.COMMENT_NODE || (name && node.classList.contains("choice"))) continue;
    const isInline = !name || RENAMED[name] || ["A", "SPAN", "BR", "FONT", "U", "CODE"].includes(name);
    if (isInline && !(name && node.querySelector && node.querySelector("p, div, h1, h2, h3, ul, ol, table, img"))) {
      if (!loose && !name && !node.textContent.trim()) continue;
      if (!loose) loose = inert.createElement("p");
      const wrap = inert.createElement("div");
      wrap.append(node.cloneNode(true));
      cleanInline(wrap, loose);
      continue;
    }
    close();
    if (name === "FIGURE" || name === "IMG") cleanFigure(node, to);
    else if (name === "UL" || name === "OL") cleanList(node, to, name);
    else if (name === "TABLE") {
      const table = inert.createElement("table");
      cleanRows(node, table);
      if (table.querySelector("tr")) to.append(table);
    } else if (name === "HR") to.append(inert.createElement("hr"));
    else if (BLOCKS.has(name) && !node.querySelector("p, div, ul, ol, table, figure, img")) {
      const block = inert.createElement(name);
      cleanInline(node, block);
      if (!isBlank(block)) to.append(block);
    } else if (name === "BLOCKQUOTE") {
      const quote = inert.createElement("blockquote");
      cleanBlocks(node, quote);
      if (!isBlank(quote)) to.append(quote);
    } else cleanBlocks(node, to);
  }
  close();
}

// A fragment of blocks, with pictures named as in a page.
export function clean(html) {
  const parsed = new DOMParser().parseFromString(html, "text/html"), to = inert.createElement("div");
  cleanBlocks(parsed.body, to);
  return to;
}

// Whether a page's words and pictures are all there when it is cleaned. One that was written by hand may have a picture in a
// list, say.
export function isKept(html) {
  const whole = new DOMParser().parseFromString(html, "text/html").body, kept = clean(html);
  const words = from => from.textContent.replace(/\s+/g, ""), pictures = from => [...from.querySelectorAll("img")].map(image => image.getAttribute("src")).join("\n");
  for (const dropped of whole.querySelectorAll([...DROPPED].join(","))) dropped.remove();
  return words(whole) === words(kept) && pictures(whole) === pictures(kept);
}

const escape = text => text.replace(/[&<>]/g, c => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" }[c]));

function inlineText(node) {
  let out = "";
  for (const child of node.childNodes) {
    if (child.nodeType === Node.TEXT_NODE) out += escape(child.data);
    else if (child.tagName === "BR") out += "<br>";
    else if (child.tagName === "UL" || child.tagName === "OL") out += `\n${blockText(child)}\n`;
    else {
      const name = child.tagName.toLowerCase(), href = child.getAttribute("href");
      out += `<${name}${href ? ` href="${href}"` : ""}>${inlineText(child)}</${name}>`;
    }
  }
  return out;
}

function blockText(block) {
  const name = block.tagName.toLowerCase();
  if (name === "hr") return "<hr>";
  if (name === "img") return `<img src="${block.getAttribute("src")}" alt="${escape(block.getAttribute("alt")).replace(/"/g, "&quot;")}">`;
  if (name === "tr") return `<tr>${[...block.children].map(cell => blockText(cell)).join("")}</tr>`;
  if (INSIDE[block.tagName] || name === "figure" || (name === "blockquote" && block.querySelector("p, ul, ol, h2, h3")))
    return `<${name}>\n${[...block.children].map(blockText).join("\n")}\n</${name}>`;
  return `<${name}>${inlineText(block).trim()}</${name}>`;
}

// The text of cleaned blocks.
export const textOf = blocks => [...blocks.children].map(blockText).join("\n");
