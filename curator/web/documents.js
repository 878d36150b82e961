// The panel about a part's documents: its own page and those that follow it, their order, and at which parts each of them is.
import { ask, may } from "./api.js";

const panel = document.getElementById("documents");

function element(name, values = {}, ...children) {
  const made = Object.assign(document.createElement(name), values);
  made.append(...children);
  return made;
}

const escape = text => text.replace(/[&<>]/g, c => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" }[c]));
const idOf = title => title.normalize("NFD").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 56) || "document";

// context: part, parts, documents ({id, pages}), titleOf(part), shown (the id of the text in the editor), language, edit(id),
// set(part, list of ids), which saves, and done(work), which does the work and shows what came of it.
export function showDocuments(context) {
  const { part, parts, documents, titleOf, shown, set, edit } = context, list = part.documents || [];
  const partOf = id => parts.find(one => one.id === id), nameOf = id => partOf(id) ? titleOf(partOf(id)) : id;
  const places = id => parts.filter(one => one.id === id || one.documents?.includes(id));
  const button = (textContent, label, action, disabled = false) => {
    const made = element("button", { type: "button", textContent, disabled: disabled || !may("editor") });
    made.setAttribute("aria-label", label);
    made.addEventListener("click", action);
    return made;
  };
  const moved = (n, by) => {
    const fresh = [...list];
    fresh.splice(n + by, 0, ...fresh.splice(n, 1));
    return fresh;
  };
  // Every part with a box: one document can be at several.
  const chooser = id => element("details", {}, element("summary", { textContent: `At ${places(id).length} ${places(id).length === 1 ? "part" : "parts"}` }),
    ...parts.map(one => {
      const box = element("input", { type: "checkbox", checked: places(id).includes(one), disabled: !may("editor") || one.id === id });
      box.addEventListener("change", () => set(one, box.checked ? [...(one.documents || []), id] : one.documents.filter(other => other !== id)));
      return element("label", { className: "check" }, box, element("span", { textContent: titleOf(one) }));
    }));
  const row = (id, n) => {
    const name = nameOf(id), item = element("li", {}), head = element("div", { className: "line" }, element("strong", { textContent: n < 0 ? "Its own page" : name }));
    if (id === shown) item.className = "chosen";
    else head.append(button("Edit", `Edit ${n < 0 ? "its own page" : name}`, () => edit(id)));
    if (n >= 0) head.append(button("↑", `${name} before the one above`, () => set(part, moved(n, -1)), n === 0),
      button("↓", `${name} after the one below`, () => set(part, moved(n, 1)), n === list.length - 1),
      button("×", `Take ${name} away from this part`, () => set(part, list.filter(other => other !== id))));
    item.append(head, chooser(id));
    return item;
  };
  const others = [...documents.map(one => one.id), ...parts.filter(one => Object.keys(one.pages).length).map(one => one.id)].filter(id => id !== part.id && !list.includes(id));
  const choice = element("select", { disabled: !may("editor") || !others.length }, ...others.map(id => new Option(nameOf(id), id)));
  choice.setAttribute("aria-label", "A document that is there");
  const title = element("input", { maxLength: 80, placeholder: "Works of restoration", disabled: !may("editor"), autocomplete: "off" });
  title.setAttribute("aria-label", "Title of a new document");
  const typed = panel.dataset.part === part.id ? panel.querySelector("input[maxlength]") : null, isTyping = typed && typed === document.activeElement;
  title.value = typed?.value || ""; // what is typed while something else is saved stays
  const make = async () => {
    const words = title.value.trim(), base = idOf(words), taken = id => partOf(id) || documents.some(one => one.id === id);
    let id = base;
    for (let n = 2; taken(id); n++) id = `${base}-${n}`;
    await ask("PUT", `/api/pages/${id}.${context.language}?kind=document`, { html: `<h2>${escape(words)}</h2>\n` }, { "If-None-Match": "*" });
    title.value = "";
    await set(part, [...list, id]);
    edit(id);
  };
  const fresh = button("Make", "Make a new document", () => { if (title.value.trim()) context.done(make); else title.focus(); });
  panel.replaceChildren(
    element("p", { className: "quiet", textContent: "On the terminal they stand one below the other on the part's page, in this order." }),
    element("ol", {}, row(part.id, -1), ...list.map(row)),
    element("div", { className: "line" }, choice, button("Add", "Add the chosen document", () => set(part, [...list, choice.value]), !others.length)),
    element("div", { className: "line" }, title, fresh));
  panel.dataset.part = part.id;
  if (isTyping) title.focus();
}
