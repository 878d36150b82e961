// The panel about what is spoken on a page: a recording in each language, and its words.
import { ask, may } from "./api.js";

const panel = document.getElementById("sound");
const KINDS = {
  spoken: { words: "Recording", help: "Ogg Opus, at most ten minutes", accept: ".opus,audio/ogg", none: "Nothing is spoken on this page yet." },
  words: { words: "Its words", help: "WebVTT, shown while they are said", accept: ".vtt,text/vtt", none: "The words are not shown while they are said." },
};

export const soundKind = file => /\.(opus|ogg|oga)$/i.test(file.name) || /^audio\//.test(file.type) ? "spoken" : /\.vtt$/i.test(file.name) ? "words" : "";

const address = (kind, part, language) => `/api/${kind}/${part.id}.${language}`;

function condition(kind, part, language) {
  const tag = part[kind][language];
  return tag ? { "If-Match": `"${tag}"` } : { "If-None-Match": "*" };
}

export const sendSound = (kind, part, language, file) => ask("PUT", address(kind, part, language), file, condition(kind, part, language));

function section(kind, part, language, done) {
  const box = document.createElement("section"), label = document.createElement("label"), small = document.createElement("small"), field = document.createElement("input");
  const { words, help, accept, none } = KINDS[kind], has = Boolean(part[kind][language]);
  if (has && kind === "spoken") {
    const player = document.createElement("audio");
    player.controls = true;
    player.preload = "metadata";
    player.src = `${address(kind, part, language)}?${part[kind][language]}`;
    player.setAttribute("aria-label", words);
    box.append(player);
  } else box.append(Object.assign(document.createElement("p"), { className: "quiet", textContent: has ? "The words are shown while they are said." : none }));
  small.textContent = help;
  Object.assign(field, { type: "file", accept, disabled: !may("editor") || (kind === "words" ? !part.spoken[language] : !part.pages[language]) });
  field.addEventListener("change", () => { if (field.files[0]) done(() => sendSound(kind, part, language, field.files[0])); });
  label.append(words, " ", small, field);
  box.append(label);
  if (has) {
    const gone = document.createElement("button");
    Object.assign(gone, { type: "button", className: "danger", textContent: kind === "spoken" ? "Remove the recording" : "Remove the words", disabled: !may("editor") });
    gone.addEventListener("click", () => done(() => ask("DELETE", address(kind, part, language), undefined, condition(kind, part, language))));
    box.append(gone);
  }
  return box;
}

// done(work) does the work, which returns a promise, and shows what came of it.
export function showSound(part, language, done) {
  const note = document.createElement("p");
  note.className = "quiet";
  note.textContent = part.pages[language] ? "Visitors hear it where the museum has turned sound on at the terminal." : "Write and save the page first: what is spoken belongs to it.";
  panel.replaceChildren(note, section("spoken", part, language, done), section("words", part, language, done));
}
