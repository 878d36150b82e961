// The panel about a part: thumbnail, Dublin Core credits, removing it.
import { may } from "./api.js";
import { pictureAddress } from "./clean.js";
import { pickPicture } from "./pictures.js";

const panel = document.getElementById("about");
let shownOf = ""; // the part and language
const CREDITS = [["creator", "Creator", "who made the part, or wrote about it"], ["contributor", "Contributor", "who helped"], ["publisher", "Publisher", "the museum"],
  ["date", "Date", ""], ["source", "Source", "after what it was written"], ["rights", "Rights", "licence or owner"], ["subject", "Subjects", "for the search"], ["coverage", "Coverage", "place and period"],
  ["relation", "Relation", "to other objects"]];

const textOf = value => Array.isArray(value) ? value.join("\n") : typeof value === "string" ? value : "";

function field(part, common, language, [element, label, help], set) {
  const value = part.credits?.[element], byLanguage = value !== null && typeof value === "object" && !Array.isArray(value);
  const wrap = document.createElement("label"), area = document.createElement("textarea"), small = document.createElement("small");
  const old = byLanguage ? value[language] || "" : textOf(value), all = common?.[element];
  wrap.append(byLanguage ? `${label} (${language})` : label);
  small.textContent = help;
  area.rows = 1;
  area.defaultValue = old;
  area.readOnly = !may("editor");
  area.placeholder = !value && all ? textOf(typeof all === "object" && !Array.isArray(all) ? all[language] || Object.values(all)[0] : all) : "";
  area.addEventListener("change", async () => {
    const to = area.value.trim();
    if (await set({ field: element, language: byLanguage ? language : "", from: old, to })) area.defaultValue = to; // it may stay, behind another panel
  });
  wrap.append(" ", small, area);
  return wrap;
}

const areas = () => [...panel.querySelectorAll("textarea")];

export const hasUnsavedCredit = () => areas().some(area => area.value.trim() !== area.defaultValue.trim());

// What is typed is not wanted any more.
export function dropCredits() {
  for (const area of areas()) area.value = area.defaultValue;
}

// What is typed while another field is saved stays, and the caret in it.
function keepTyped(of, redraw) {
  const typed = of === shownOf ? areas().map(area => [area.value, area.defaultValue]) : [], at = typed.length ? areas().indexOf(document.activeElement) : -1;
  const { selectionStart, selectionEnd } = areas()[at] || {};
  redraw();
  areas().forEach((area, n) => { if (typed[n] && typed[n][0] !== typed[n][1]) area.value = typed[n][0]; });
  shownOf = of;
  if (at < 0) return;
  areas()[at].focus();
  areas()[at].setSelectionRange(selectionStart, selectionEnd);
}

// set(change) saves one, as POST /api/parts/ID/texts takes it, and returns whether it did.
export function showAbout(part, common, language, set, remove) {
  const figure = document.createElement("figure"), words = document.createElement("figcaption"), pick = document.createElement("button"), gone = document.createElement("button");
  if (part.thumbnail) {
    const image = document.createElement("img");
    image.src = pictureAddress(part.thumbnail);
    image.alt = "The picture on the card";
    figure.append(image);
  }
  words.textContent = part.thumbnail ? `On the card: ${part.thumbnail}` : "The card has no picture.";
  figure.append(words);
  pick.type = gone.type = "button";
  pick.textContent = part.thumbnail ? "Another picture for the card" : "Choose a picture for the card";
  pick.disabled = gone.disabled = !may("editor");
  pick.addEventListener("click", () => pickPicture(part.thumbnail ? { name: part.thumbnail } : null, false,
    picked => set({ field: "thumbnail", language: "", from: part.thumbnail || "", to: picked ? picked.name : "" })));
  gone.className = "danger";
  gone.textContent = "Remove this part";
  gone.addEventListener("click", remove);
  const note = document.createElement("p");
  note.className = "quiet";
  note.textContent = "Several creators: one on each line. What is empty is taken from the credits of the whole content, shown in grey.";
  keepTyped(`${part.id}.${language}`, () => panel.replaceChildren(figure, pick, note, ...CREDITS.map(credit => field(part, common, language, credit, set)), gone));
}
