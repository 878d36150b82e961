// Files, texts and addresses that are dropped or pasted, on a page or on a part in the list.
import { clean } from "./clean.js";
import { insertBlocks, isEditable } from "./editor.js";
import { makeFigure, sendPicture } from "./pictures.js";
import { soundKind } from "./sound.js";

let on;

// handlers: opened(), the name of what is open; sound(kind, file) sends what is spoken; tell(sentence); state(words);
// edited(), after something has come to the page.
export const setUpDrops = handlers => { on = handlers; };

async function takePicture(file, opened) {
  on.state(`Sending ${file.name} …`);
  const name = await sendPicture(file);
  if (on.opened() === opened) insertBlocks(makeFigure({ name, alt: "", caption: "", credit: "" }));
  else on.tell(`${file.name} was sent, and can be chosen for any page: something else was opened meanwhile.`);
}

async function takeText(file) {
  const text = await file.text(), box = document.createElement("div");
  for (const lines of text.split(/\n\s*\n/)) box.append(Object.assign(document.createElement("p"), { textContent: lines }));
  insertBlocks(clean(box.innerHTML));
}

async function takeFile(file, opened) {
  const kind = soundKind(file);
  if (on.opened() !== opened) on.tell(`${file.name} was not taken, because something else was opened meanwhile: drop it again.`);
  else if (kind) await on.sound(kind, file);
  else if (!isEditable()) on.tell(`${file.name} was not taken: this page cannot be edited here.`);
  else if (/^image\//.test(file.type)) await takePicture(file, opened);
  else if (/^text\/html/.test(file.type)) insertBlocks(clean(await file.text()));
  else if (/^text\//.test(file.type)) await takeText(file);
  else on.tell(`${file.name}: pictures (JPEG, PNG, WebP), texts, web pages and speech (Opus, WebVTT) can be taken.`);
}

// All of them belong to what is open when they are dropped.
export async function takeFiles(files) {
  const opened = on.opened();
  for (const file of files) await takeFile(file, opened).catch(failure => on.tell(`${file.name}: ${failure.message}`));
  on.edited();
}

export async function takeDrop(data) {
  if (data.files.length) { await takeFiles([...data.files]); return; }
  const html = data.getData("text/html"), address = data.getData("text/uri-list");
  if (!isEditable()) return;
  if (html) insertBlocks(clean(html));
  else if (address) insertBlocks(clean(`<p>${address.replace(/[&<]/g, c => c === "&" ? "&amp;" : "&lt;")}</p>`)); // the kiosk shows nothing outside the release
  on.edited();
}
