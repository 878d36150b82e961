// Pictures: sending them, choosing one, and what is written about it.
import { ask } from "./api.js";
import { clean, pictureAddress, pictureName } from "./clean.js";

const byId = id => document.getElementById(id);
const dialog = byId("picture-dialog"), choices = byId("picture-choices"), message = byId("picture-message");
let names = [], chosen = "", done = () => {};

export const setPictures = list => { names = list; };

export async function sendPicture(file) {
  const answer = await ask("POST", `/api/pictures?name=${encodeURIComponent(file.name || "picture")}`, file);
  if (!names.includes(answer.name)) names.push(answer.name);
  return answer.name;
}

function choose(name) {
  chosen = name;
  for (const button of choices.children) {
    button.setAttribute("aria-checked", String(button.dataset.name === name));
    button.tabIndex = button.dataset.name === name || (!name && button === choices.firstElementChild) ? 0 : -1;
  }
  dialog.querySelector("[value=ok]").disabled = !name;
}

function showChoices() {
  choices.replaceChildren(...names.map(name => {
    const button = document.createElement("button"), image = document.createElement("img"), label = document.createElement("span");
    button.type = "button";
    button.setAttribute("role", "radio");
    button.dataset.name = name;
    image.src = pictureAddress(name);
    image.alt = "";
    image.loading = "lazy";
    label.textContent = name.slice("pictures/".length);
    button.append(image, label);
    button.addEventListener("click", () => choose(name));
    return button;
  }));
  choose(chosen);
}

choices.addEventListener("keydown", event => {
  const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
  if (!step) return;
  event.preventDefault();
  const list = [...choices.children], next = list[(list.indexOf(document.activeElement) + step + list.length) % list.length];
  next.focus();
  choose(next.dataset.name);
});

byId("picture-file").addEventListener("change", async event => {
  const [file] = event.target.files;
  if (!file) return;
  message.textContent = "Sending …";
  try {
    chosen = await sendPicture(file);
    message.textContent = `Sent as ${chosen.slice("pictures/".length)}.`;
    showChoices();
    choices.querySelector("[aria-checked=true]")?.scrollIntoView({ block: "nearest" });
  } catch (failure) {
    message.textContent = failure.message;
  }
  event.target.value = "";
});

dialog.addEventListener("close", () => {
  if (dialog.returnValue === "ok" && chosen) done({ name: chosen, alt: byId("picture-alt").value, caption: byId("picture-caption").value, credit: byId("picture-credit").value });
  else if (dialog.returnValue === "remove") done(null);
});

// Calls then() with {name, alt, caption, credit}, or null: remove it. Cancelled: it is not called.
export function pickPicture(old, hasTexts, then) {
  chosen = old ? old.name : "";
  done = then;
  byId("picture-alt").value = old?.alt || "";
  byId("picture-caption").value = old?.caption || "";
  byId("picture-credit").value = old?.credit || "";
  byId("picture-texts").hidden = !hasTexts;
  byId("picture-remove").hidden = !old;
  message.textContent = "";
  dialog.returnValue = "";
  showChoices();
  dialog.showModal();
}

// ---- figures of pages

export function readFigure(figure) {
  const caption = figure.querySelector("figcaption")?.cloneNode(true), small = caption?.querySelector("small");
  if (small) small.remove();
  return { name: pictureName(figure.querySelector("img").getAttribute("src")), alt: figure.querySelector("img").alt,
    caption: caption ? caption.textContent.trim() : "", credit: small ? small.textContent.trim() : "" };
}

// Blocks for the editor.
export function makeFigure({ name, alt, caption, credit }) {
  const out = document.createElement("div"), figure = document.createElement("figure"), image = document.createElement("img");
  image.setAttribute("src", pictureAddress(name));
  image.alt = alt;
  figure.append(image);
  if (caption || credit) {
    const words = document.createElement("figcaption");
    words.append(caption);
    if (credit) {
      const small = document.createElement("small");
      small.textContent = credit;
      if (caption) words.append(" ");
      words.append(small);
    }
    figure.append(words);
  }
  out.append(figure);
  return clean(out.innerHTML);
}
