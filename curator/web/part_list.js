// The list of parts: choosing one, their order, and what is missing of each.
import { may } from "./api.js";
import { pictureAddress } from "./clean.js";

const list = document.getElementById("part-list");
let move = () => {}, open = () => {}, drop = () => {}, dragged = "";

export function setUpList(onOpen, onMove, onDrop) {
  open = onOpen;
  move = onMove;
  drop = onDrop;
}

export const titleOf = (part, languages) => languages.map(language => part.title?.[language]).find(Boolean) || part.id;

// "4 languages", or what is missing.
function describe(part, languages, problems) {
  if (problems.some(problem => problem.error)) return ["wrong", "needs attention"];
  const lacking = languages.filter(language => !part.title?.[language] || !part.caption?.[language] || (!part.without_page && !part.pages[language]));
  if (lacking.length) return ["missing", `incomplete: ${lacking.join(", ")}`];
  return ["", part.without_page ? "card, no page" : `${languages.length} languages`];
}

function thumbnail(part) {
  const image = document.createElement(part.thumbnail ? "img" : "span");
  image.className = part.thumbnail ? "" : "none";
  if (part.thumbnail) {
    image.src = pictureAddress(part.thumbnail);
    image.alt = "";
    image.loading = "lazy";
    image.draggable = false;
  }
  return image;
}

function row(part, n, parts, current, languages, problems) {
  const item = document.createElement("li"), button = document.createElement("button"), words = document.createElement("span");
  const title = document.createElement("strong"), small = document.createElement("small"), mine = problems.filter(problem => problem.part === part.id);
  [small.className, small.textContent] = describe(part, languages, mine);
  title.textContent = titleOf(part, languages);
  words.append(title, small);
  button.type = "button";
  button.id = `part-${part.id}`;
  button.setAttribute("aria-current", String(part.id === current));
  button.append(thumbnail(part), words);
  button.addEventListener("click", () => open(part.id));
  button.addEventListener("keydown", event => {
    if (event.altKey && may("editor") && event.key === "ArrowUp" && n > 0) move(part.id, parts[n - 1].id);
    else if (event.altKey && may("editor") && event.key === "ArrowDown" && n + 1 < parts.length) move(part.id, parts[n + 2]?.id || "");
    else if (!event.altKey && event.key === "ArrowUp") button.closest("li").previousElementSibling?.firstElementChild.focus();
    else if (!event.altKey && event.key === "ArrowDown") button.closest("li").nextElementSibling?.firstElementChild.focus();
    else return;
    event.preventDefault();
  });
  item.draggable = may("editor");
  item.addEventListener("dragstart", event => { dragged = part.id; event.dataTransfer.setData("text/x-part", part.id); event.dataTransfer.effectAllowed = "move"; });
  item.addEventListener("dragend", () => { dragged = ""; });
  item.addEventListener("dragover", event => {
    if (!may("editor")) return;
    event.preventDefault();
    item.classList.add(dragged ? "over" : "dropping");
  });
  item.addEventListener("dragleave", () => item.classList.remove("over", "dropping"));
  item.addEventListener("drop", event => {
    event.preventDefault();
    item.classList.remove("over", "dropping");
    if (dragged && dragged !== part.id) move(dragged, part.id);
    else if (!dragged) drop(part.id, event.dataTransfer);
  });
  item.append(button);
  return item;
}

export function showList(parts, current, languages, problems) {
  const focused = document.activeElement?.id;
  list.replaceChildren(...parts.map((part, n) => row(part, n, parts, current, languages, problems)));
  if (focused?.startsWith("part-")) document.getElementById(focused)?.focus();
}
