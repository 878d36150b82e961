// The page on which tours are made: the eye's views become stops, with words in each language; the tour is flown on the
// curve that the terminal flies. docs/curator.md has the addresses.
import { showAccount } from "./account.js";
import { ask, loadSession, may } from "./api.js";
import { Eye } from "./eye.js";
import { versionsOf } from "./history.js";
import { showStops } from "./stop_list.js";
import { Player } from "./tour_player.js";

const byId = id => document.getElementById(id);
const TOURS_MAX = 8, STOPS_MAX = 64, FLIGHT_MS = 500;
let information, tours = [], tag = "", tour = null, language = "", chosen = -1, dirty = false, saving = false;
let flightTimer, asked = 0; // for the path of the tour as it is in the editor

const titleOf = one => information.languages.map(code => one.title?.[code]).find(Boolean) || one.id;
const round = numbers => numbers.map(number => Math.round(number * 1000) / 1000);

function tell(text, good = false, ...buttons) {
  byId("message").replaceChildren(text, ...(buttons.length ? [document.createElement("br"), ...buttons] : []));
  byId("message").hidden = !text;
  byId("message").classList.toggle("good", good);
}

function setDirty(on) {
  dirty = on;
  byId("save").disabled = !on || !may("editor");
  byId("state").textContent = on ? "Not saved yet" : "";
}

// ---- the eye

const eye = new Eye(byId("stage"), [byId("picture")], byId("quality"), {
  text: message => {
    if (message.type === "hello") { eye.begin(message); byId("keep").disabled = !tour || !may("editor"); if (tour) look(0); }
    else if (message.type === "point" && message.at) eye.lookAt(message.at);
  },
  moved: () => {},
  tell,
  press: () => player.pause(),
  closed: wasOpen => { byId("state").textContent = wasOpen ? "Connection lost: reload the page." : "No connection: is gopura-curator running?"; },
});

function look(n) {
  const stop = tour?.stops[n], place = stop?.eye && stop.target ? stop : player.flight?.stops?.[n];
  if (place && eye.camera) eye.lookFrom(place.eye, place.target);
}

// ---- playing

const player = new Player(eye, n => tour.stops[n]?.caption?.[language] || "");

// Asks for the path of the tour as it is in the editor, and what a build would say about it.
async function askFlight() {
  const mine = ++asked, of = tour;
  let flight;
  try {
    flight = await ask("POST", `/api/tours/${tour.id}/flight`, { tours });
  } catch (failure) {
    flight = { problems: [{ error: true, text: failure.message }] };
  }
  if (mine !== asked || of !== tour) return;
  player.take(flight);
  showProblems(flight.problems);
}

function showProblems(list) {
  const name = `tour "${tour?.id}"`, about = list.filter(one => one.error ? one.file !== "tours.json" || one.text.includes(name) || !one.text.startsWith("tour ") : one.text.includes(name));
  byId("problems").replaceChildren(...about.map(problem => Object.assign(document.createElement("li"), { className: problem.error ? "error" : "", textContent: problem.text.replace(`${name}, `, "").replace(`${name}: `, "") })));
}

function flySoon() {
  clearTimeout(flightTimer);
  flightTimer = setTimeout(askFlight, FLIGHT_MS);
}

// ---- tours

function changed(all = true) {
  setDirty(true);
  if (all) flySoon();
}

function showTours() {
  byId("tour-list").replaceChildren(...tours.map(one => {
    const item = document.createElement("li"), button = document.createElement("button"), small = document.createElement("small");
    button.type = "button";
    button.append(Object.assign(document.createElement("strong"), { textContent: titleOf(one) }), small);
    const views = one.scene ? `views of ${one.scene}` : `${one.stops.length} stops`; // docs/tours.md
    small.textContent = `${views}${one.attract ? ", while nobody is there" : ""}`;
    button.setAttribute("aria-current", String(one === tour));
    button.addEventListener("click", () => open(one));
    item.append(button);
    return item;
  }));
  byId("new-tour").disabled = !may("editor") || tours.length >= TOURS_MAX;
}

function showLanguages() {
  const names = new Intl.DisplayNames([], { type: "language" });
  byId("languages").replaceChildren(...information.languages.map(code => {
    const button = document.createElement("button"), dot = document.createElement("i");
    const said = tour.stops.filter(stop => stop.caption), all = said.length + 1, has = said.filter(stop => stop.caption[code]).length + (tour.title?.[code] ? 1 : 0);
    const words = has === all ? "complete" : has ? "incomplete" : "nothing yet";
    dot.className = has === all ? "" : has ? "some" : "none";
    button.type = "button";
    button.setAttribute("role", "tab");
    button.setAttribute("aria-selected", String(code === language));
    button.tabIndex = code === language ? 0 : -1;
    button.append(dot, names.of(code), Object.assign(document.createElement("span"), { className: "hidden", textContent: `, ${words}` }));
    button.addEventListener("click", () => { language = code; show(); byId("languages").querySelector("[aria-selected=true]").focus(); });
    return button;
  }));
}

function move(from, to) {
  if (from === to) return;
  tour.stops.splice(to, 0, ...tour.stops.splice(from, 1));
  if (chosen >= 0) chosen = to;
  changed();
  show();
  byId(`stop-${to}`).focus();
}

function show() {
  const is = Boolean(tour);
  byId("work").hidden = !is;
  byId("nothing").hidden = is;
  byId("keep").disabled = !is || tour.scene || !eye.camera || !may("editor") || tour.stops.length >= STOPS_MAX;
  showTours();
  if (!is) return;
  showLanguages();
  for (const name of ["title", "caption"]) {
    byId(name).value = tour[name]?.[language] || "";
    byId(name).lang = language;
    byId(name).dir = "auto";
  }
  byId("attract").checked = tour.attract === true;
  showStops(tour, {
    chosen, language, languageName: new Intl.DisplayNames([], { type: "language" }).of(language),
    parts: information.parts.map(part => ({ id: part.id, title: titleOf(part) })),
    changed, move, look,
    choose: n => { chosen = n; player.pause(); show(); byId(`stop-${n}`)?.focus(); if (n >= 0) look(n); },
    set: n => { Object.assign(tour.stops[n], present()); changed(); tell("This stop now has the present eye.", true); },
    remove: n => { tour.stops.splice(n, 1); chosen = -1; changed(); show(); byId(`stop-${Math.min(n, tour.stops.length - 1)}`)?.focus(); },
  });
}

function open(one) {
  player.begin();
  tour = one;
  chosen = -1;
  tell("");
  byId("problems").replaceChildren();
  show();
  if (tour) { history.replaceState(null, "", `#${tour.id}`); askFlight(); look(0); }
}

function freshId() {
  for (let n = 1; ; n++) if (!tours.some(one => one.id === `tour-${n}`)) return `tour-${n}`;
}

const present = () => ({ eye: round(eye.position), target: round(eye.camera.target) });

function keep() {
  if (byId("keep").disabled) return;
  player.pause();
  const at = chosen < 0 ? tour.stops.length : chosen + 1;
  tour.stops.splice(at, 0, present());
  chosen = at;
  changed();
  show();
  byId("stops").querySelector(".stop textarea").focus();
}

// ---- loading and saving

function take(answer) {
  const id = tour?.id;
  tours = answer.tours.map(one => ({ ...one, stops: Array.isArray(one.stops) ? one.stops : [] }));
  tag = answer.tag;
  tour = tours.find(one => one.id === id) || null;
  if (tour && chosen >= tour.stops.length) chosen = -1;
  setDirty(false);
  show();
  if (tour) askFlight();
}

async function load() {
  take(await ask("GET", "/api/tours"));
  if (!tour && tours.length) open(tours.find(one => one.id === location.hash.slice(1)) || tours[0]);
  else show();
}

async function save() {
  if (saving || !dirty || !may("editor")) return;
  saving = true;
  byId("state").textContent = "Saving …";
  tell("");
  try {
    const answer = await ask("PUT", "/api/tours", { tours }, tag ? { "If-Match": `"${tag}"` } : { "If-None-Match": "*" });
    take(answer);
    byId("state").textContent = "Saved";
    if (answer.merged) tell("Saved, together with what somebody else has changed in the tours meanwhile.", true);
    if (byId("history-box").open) await showVersions();
  } catch (failure) {
    setDirty(true);
    fail(failure);
  }
  saving = false;
}

function fail(failure) {
  const answer = failure.answer;
  if (failure.status === 409 && answer?.tours) {
    const theirs = Object.assign(document.createElement("button"), { type: "button", textContent: "Take theirs" });
    tag = answer.tag;
    theirs.addEventListener("click", () => { tell(""); take(answer); });
    tell("Somebody else has changed the same tour meanwhile. Take theirs, or save again to put yours in its place; the history keeps both.", false, theirs);
  } else {
    if (answer?.problems?.length) showProblems(answer.problems);
    tell(answer?.problems?.length ? "Not saved: this cannot be published. See below." : `Not saved: ${failure.message}`);
  }
  byId("message").scrollIntoView({ block: "center" });
}

async function showVersions() {
  byId("versions").replaceChildren(await versionsOf("tours.json", async version => {
    try {
      await ask("POST", "/api/restore", { document: "tours.json", version, tag });
      setDirty(false);
      await load();
      await showVersions();
      tell("These are the old tours. They were saved as a new version, so nothing is lost.", true);
    } catch (failure) {
      fail(failure);
    }
  }));
}

// ---- setting up

for (const name of ["title", "caption"]) byId(name).addEventListener("input", () => {
  tour[name] = { ...tour[name], [language]: byId(name).value };
  if (!byId(name).value.trim()) delete tour[name][language];
  if (!Object.keys(tour[name]).length) delete tour[name];
  changed();
  showTours();
});
byId("attract").addEventListener("change", () => {
  for (const one of tours) delete one.attract; // at most one has it
  if (byId("attract").checked) tour.attract = true;
  changed();
  showTours();
});
byId("languages").addEventListener("keydown", event => {
  const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key], tabs = [...byId("languages").children];
  if (!by) return;
  event.preventDefault();
  tabs[(tabs.indexOf(document.activeElement) + by + tabs.length) % tabs.length].click();
});
byId("new-tour").addEventListener("click", () => {
  tours.push({ id: freshId(), title: {}, stops: [] });
  language = information.languages[0];
  open(tours[tours.length - 1]);
  changed();
  byId("title").focus();
});
byId("remove").addEventListener("click", () => {
  if (!confirm(`Remove the tour “${titleOf(tour)}”? It stays in the history.`)) return;
  tours = tours.filter(one => one !== tour);
  open(tours[0] || null);
  changed(Boolean(tour));
});
byId("keep").addEventListener("click", keep);
byId("save").addEventListener("click", save);
byId("history-box").addEventListener("toggle", () => { if (byId("history-box").open) showVersions(); });
byId("stage").addEventListener("dblclick", event => {
  const box = byId("stage").getBoundingClientRect(), canvas = byId("picture");
  if (eye.sharpView >= 0) eye.send({ type: "pick", view: eye.sharpView, points: [(event.clientX - box.left) * canvas.width / box.width, (event.clientY - box.top) * canvas.height / box.height] });
});

const TURN_KEYS = { ArrowLeft: [-30, 0], ArrowRight: [30, 0], ArrowUp: [0, -30], ArrowDown: [0, 30] }, ZOOM_KEYS = { "+": 0.8, "=": 0.8, "-": 1.25 };
document.addEventListener("keydown", event => {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, control = event.ctrlKey || event.metaKey;
  if (control && key === "s") { event.preventDefault(); save(); return; }
  if (control || !eye.camera || event.target.matches("input, textarea, select")) return;
  const onStage = document.activeElement === byId("stage");
  if (key === "k") keep();
  else if (onStage && key === " ") player.play();
  else if (onStage && TURN_KEYS[key]) { player.pause(); event.shiftKey ? eye.pan(...TURN_KEYS[key]) : eye.turn(...TURN_KEYS[key]); }
  else if (onStage && ZOOM_KEYS[key]) { player.pause(); eye.zoom(ZOOM_KEYS[key]); }
  else return;
  event.preventDefault();
});
addEventListener("beforeunload", event => { if (dirty) event.preventDefault(); });

loadSession().then(async session => {
  if (session.role === "nobody") { location.assign("/sign-in"); return; }
  showAccount(session);
  for (const name of ["title", "caption"]) byId(name).readOnly = !may("editor");
  byId("attract").disabled = byId("remove").disabled = !may("editor");
  information = await ask("GET", "/api/information");
  language = information.languages[0];
  byId("name").textContent = information.name;
  eye.connect();
  await load();
}).catch(failure => { byId("nothing").textContent = failure.message; });
