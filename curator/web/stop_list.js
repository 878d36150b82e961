// The stops of a tour: choosing one, their order, and the form of the chosen one.
import { may } from "./api.js";

const list = document.getElementById("stops");
let dragged = -1;

function element(name, values = {}, ...children) {
  const made = Object.assign(document.createElement(name), values);
  made.append(...children);
  return made;
}

function labelled(words, help, field) {
  return element("label", {}, words, " ", element("small", { textContent: help }), field);
}

function seconds(stop, key, usual, changed) {
  const field = element("input", { type: "number", min: key === "stay" ? 0 : 1, max: 120, step: "any", value: stop[key] ?? "", placeholder: usual, readOnly: !may("editor") });
  field.dataset.key = key;
  field.addEventListener("input", () => {
    if (field.value === "") delete stop[key];
    else stop[key] = Number(field.value);
    changed();
  });
  return field;
}

function form(stop, n, tour, context) {
  const words = element("textarea", { rows: 3, maxLength: 2000, value: stop.caption?.[context.language] || "", lang: context.language, dir: "auto", readOnly: !may("editor") });
  words.dataset.key = "caption";
  words.addEventListener("input", () => {
    stop.caption = { ...stop.caption, [context.language]: words.value };
    if (!words.value.trim()) delete stop.caption[context.language];
    if (!Object.keys(stop.caption).length) delete stop.caption;
    context.changed(false);
  });
  const part = element("select", { disabled: !may("editor") }, new Option("none", ""), ...context.parts.map(one => new Option(one.title, one.id)));
  part.dataset.key = "part";
  part.value = stop.part || "";
  part.addEventListener("change", () => {
    if (part.value) stop.part = part.value;
    else delete stop.part;
    context.changed();
  });
  const button = (textContent, action, title, className = "") => {
    const made = element("button", { type: "button", textContent, title, className, disabled: !may("editor") && action !== context.look });
    made.addEventListener("click", () => action(n));
    return made;
  };
  return element("div", { className: "stop" },
    labelled("What is said", context.languageName, words),
    labelled("Part", "shown while it stays", part),
    element("div", { className: "times" },
      labelled("Stays", "seconds; 0: passes", seconds(stop, "stay", "6", context.changed)),
      labelled("Flight to it", "seconds", seconds(stop, "travel", "by its length", context.changed))),
    element("div", { className: "line" },
      button("Look from here", context.look, "Bring the eye to this stop"),
      button("Set to this view", context.set, "This stop gets the present eye"),
      button("Remove", context.remove, "Remove this stop", "danger")));
}

function row(stop, n, tour, context) {
  const words = stop.caption?.[context.language], part = context.parts.find(one => one.id === stop.part);
  const facts = [stop.stay === 0 ? "passes" : `stays ${stop.stay ?? 6} s`, part?.title].filter(Boolean).join(" · ");
  const button = element("button", { type: "button", className: "row", id: `stop-${n}` },
    element("span", {}, element("span", { className: words ? "words" : "words none", textContent: words || (stop.stay === 0 ? "on the way" : "nothing is said") }), element("small", { textContent: facts })));
  const item = element("li", { className: n === context.chosen ? "chosen" : "" }, button), last = tour.stops.length - 1;
  button.setAttribute("aria-expanded", String(n === context.chosen));
  button.addEventListener("click", () => context.choose(n === context.chosen ? -1 : n));
  button.addEventListener("keydown", event => {
    const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const to = Math.max(0, Math.min(last, n + step));
    if (event.altKey && may("editor")) context.move(n, to);
    else document.getElementById(`stop-${to}`).focus();
  });
  button.draggable = may("editor");
  button.addEventListener("dragstart", event => { dragged = n; event.dataTransfer.setData("text/x-stop", String(n)); event.dataTransfer.effectAllowed = "move"; });
  button.addEventListener("dragend", () => { dragged = -1; });
  item.addEventListener("dragover", event => {
    if (dragged < 0) return;
    event.preventDefault();
    item.classList.add("over");
  });
  item.addEventListener("dragleave", () => item.classList.remove("over"));
  item.addEventListener("drop", event => {
    event.preventDefault();
    item.classList.remove("over");
    if (dragged >= 0) context.move(dragged, dragged < n ? n - 1 : n);
    dragged = -1;
  });
  if (n === context.chosen) item.append(form(stop, n, tour, context));
  return item;
}

// context: chosen, language, languageName, parts ({id, title}), and what is done: changed(flies), choose(n),
// move(from, to), look(n), set(n), remove(n). Who is typing goes on typing, at the same place.
export function showStops(tour, context) {
  const { id, dataset, selectionStart, selectionEnd } = document.activeElement, isHere = list.contains(document.activeElement);
  list.replaceChildren(...tour.stops.map((stop, n) => row(stop, n, tour, context)));
  if (!isHere) return;
  const again = id ? document.getElementById(id) : dataset.key && list.querySelector(`[data-key=${dataset.key}]`);
  again?.focus();
  if (Number.isInteger(selectionStart)) again?.setSelectionRange(selectionStart, selectionEnd);
}
