// What a visitor will see, drawn by the terminal's own code.
import { askPicture } from "./api.js";

const panel = document.getElementById("preview");
const KINDS = [["near", "Near: its name beside the model"], ["card", "Touched: the card"], ["page", "Opened: the page"]];
let newest = 0, addresses = [];

// text: of the page as it is in the editor; null: as it is saved.
export async function showPreview(part, language, text) {
  const mine = ++newest, figures = KINDS.map(([, words]) => {
    const figure = document.createElement("figure"), caption = document.createElement("figcaption");
    caption.textContent = `${words} …`;
    figure.append(caption);
    return figure;
  });
  panel.replaceChildren(...figures);
  addresses.forEach(URL.revokeObjectURL);
  addresses = [];
  for (let n = 0; n < KINDS.length; n++) {
    const [kind, words] = KINDS[n], image = document.createElement("img"), caption = figures[n].firstElementChild;
    if (kind === "page" && part.without_page && !text) {
      caption.textContent = "Opened: it has no page yet";
      continue;
    }
    try {
      const picture = await askPicture("POST", "/api/preview", { part: part.id, language, kind, ...(text === null ? {} : { html: text }) });
      if (mine !== newest) return;
      addresses.push(URL.createObjectURL(picture));
      image.src = addresses.at(-1);
      image.alt = words;
      const button = document.createElement("button");
      button.type = "button";
      button.title = "Show it large";
      button.append(image);
      button.addEventListener("click", () => {
        document.getElementById("large-image").src = image.src;
        document.getElementById("large-image").alt = words;
        document.getElementById("large").showModal();
      });
      figures[n].prepend(button);
      caption.textContent = words;
    } catch (failure) {
      if (mine !== newest) return;
      caption.textContent = `${words}: ${failure.message}`;
    }
  }
}
