// The page on which tours are made: the eye's views become stops, with words in each language; the tour is flown on the
// curve that the terminal flies. docs/curator.md has the addresses.
import { showAccount } from "./account.js";
import { ask, loadSession, may } from "./api.js";
import { guardLeaving, keyOf } from "./browser.js";
import { Eye } from "./eye.js";
import { versionsOf } from "./history.js";
import { showStops } from "./stop_list.js";
import { mergeTours, takeTheirs } from "./tour_merge.js";
import { Player } from "./tour_player.js";

const byId = id => document.getElementById(id);
const TOURS_MAX = 8, STOPS_MAX = 64, FLIGHT_MS = 500;
let information, tours = [], tour = null, language = "", chosen = -1, dirty = false, saving = false;
let wanted = false;                     // to save again, once the save that is under way has ended
let stored = "[]", tag = "", sent = ""; // the tours as they are in the file, its tag, and as they were sent last
let clashes = [];                       // ids of tours that somebody else has changed too, in another way
let gone = "";                          // why there is no model
let flightTimer, asked = 0;             // for the path of the tour as it is in the editor

const titleOf = one => information.languages.map(code => one.title?.[code]).find(Boolean) || one.id;
const round = numbers => numbers.map(number => Math.round(number * 1000) / 1000);

function tell(text, good = false) {
  byId("message").textContent = text;
  byId("message").hidden = !text;
  byId("message").classList.toggle("good", good);
}

function showState(words) {
  const then = gone && (dirty ? `${gone} Save, then load the page again.` : `${gone} Load the page again.`);
  byId("state").textContent = [words, then].filter(Boolean).join(". ");
}

function setDirty(on) {
  dirty = on;
  byId("save").disabled = !on || !may("editor");
  showState(on ? "Not saved yet" : "");
}

// ---- the eye

const eye = new Eye(byId("stage"), [byId("picture")], byId("quality"), {
  text: message => {
    if (message.type === "hello") { eye.begin(message); byId("keep").disabled = !tour || !may("editor"); if (tour) look(0); }
    else if (message.type === "point" && message.at) eye.lookAt(message.at);
    else if (message.type === "error") tell(message.message);
  },
  moved: () => {},
  tell,
  press: () => player.pause(),
  unsaved: () => dirty,
  closed: (wasOpen, reason) => {
    gone = reason || (wasOpen ? "The connection to the model is lost." : "There is no connection to the model.");
    showState(dirty ? "Not saved yet" : "");
  },
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
  if (!tour) return; // it was removed meanwhile
  try {
    flight = await ask("POST", `/api/tours/${tour.id}/flight`, { tours });
  } catch (failure) {
    flight = { problems: [{ error: true, text: failure.message }] };
  }
  if (mine !== asked || of !== tour) return;
  player.take(flight);
  showProblems(flight.problems);
}

// Of the chosen tour, and of no tour; ofAll: of the others too, by their titles.
function showProblems(list, ofAll = false) {
  const name = `tour "${tour?.id}"`, about = list.filter(one => ofAll || (one.error ? one.file !== "tours.json" || one.text.includes(name) || !one.text.startsWith("tour ") : one.text.includes(name)));
  const words = text => tours.reduce((said, one) => said.replace(`tour "${one.id}"`, `“${titleOf(one)}”`), text.replace(`${name}, `, "").replace(`${name}: `, ""));
  byId("problems").replaceChildren(...about.map(problem => Object.assign(document.createElement("li"), { className: problem.error ? "error" : "", textContent: words(problem.text) })));
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
  byId("attract").checked = tour?.attract === true;
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
  byId("tour").hidden = byId("languages").hidden = !is;
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

// Of two who begin a tour at the same time each gets another one, and what links to a tour that was removed leads to no
// newer one.
const freshId = () => `tour-${Math.random().toString(36).slice(2, 8)}`;

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

const read = answer => answer.tours.map(one => ({ ...one, stops: Array.isArray(one.stops) ? one.stops : [] }));

// Where the chosen tour is the same object, what shows it stays untouched: somebody may be typing in it.
function setTours(list) {
  const was = tour;
  tours = list;
  tour = tours.find(one => one.id === was?.id) || null;
  setDirty(JSON.stringify(tours) !== stored);
  if (tour && tour === was) { showTours(); return; }
  if (!tour) { open(tours.find(one => one.id === location.hash.slice(1)) || tours[0] || null); return; }
  if (chosen >= tour.stops.length) chosen = -1;
  show();
  askFlight();
}

// Takes up what is in the file now, and keeps what was changed here since `base`.
function meet(base, answer) {
  const theirs = read(answer);
  stored = JSON.stringify(theirs);
  tag = answer.tag;
  const both = mergeTours(JSON.parse(base), tours, theirs);
  clashes = [...new Set([...clashes, ...both.clashes])];
  setTours(both.tours);
  showClashes();
}

function showClashes() {
  const box = byId("clash"), theirs = JSON.parse(stored), button = Object.assign(document.createElement("button"), { type: "button", textContent: "Take theirs" });
  box.hidden = !clashes.length;
  if (box.hidden) return;
  const names = clashes.map(id => `“${titleOf([...theirs, ...tours].find(one => one.id === id))}”`).join(", ");
  button.addEventListener("click", () => {
    if (!confirm(`What you changed of ${names} is then kept nowhere. Take theirs?`)) return;
    setTours(takeTheirs(tours, theirs, clashes));
    clashes = [];
    showClashes();
  });
  box.replaceChildren(`Not saved: somebody else has changed ${names} meanwhile. Save again to put yours in the place of theirs, which stays in the history, or take theirs.`, document.createElement("br"), button);
  box.scrollIntoView({ block: "center" });
}

const load = async base => meet(base, await ask("GET", "/api/tours"));

// Saves, together with what somebody else has saved meanwhile. What is typed until the answer comes stays, and is then not
// saved yet. Returns what came of it.
async function put() {
  for (let withOthers = false; ; ) {
    const before = sent;
    sent = JSON.stringify(tours);
    try {
      ({ tag } = await ask("PUT", "/api/tours", { tours: JSON.parse(sent) }, tag ? { "If-Match": `"${tag}"` } : { "If-None-Match": "*" }));
      stored = sent;
      return { withOthers, isSaved: true };
    } catch (failure) {
      if (failure.status !== 409 || !failure.answer?.tours) throw failure;
      const own = [sent, before].find(one => one === JSON.stringify(read(failure.answer))); // saved, but the answer was lost
      meet(own || stored, failure.answer);
      if (clashes.length) return { isSaved: false };
      withOthers ||= !own;
    }
  }
}

async function save() {
  wanted = saving;
  if (saving || !dirty || !may("editor")) return;
  saving = true;
  showState("Saving …");
  tell("");
  if (!tour) showProblems([]); // no change of a tour will ask again
  clashes = []; // they were shown: mine are wanted
  showClashes();
  let isSaved = false, withOthers;
  try {
    ({ isSaved, withOthers } = await put());
    setDirty(JSON.stringify(tours) !== stored);
    if (!dirty) showState("Saved");
    if (withOthers) tell("Saved, together with what somebody else has changed in the tours meanwhile.", true);
    if (isSaved && byId("history-box").open) showVersions();
  } catch (failure) {
    setDirty(true);
    fail(failure);
  }
  saving = false;
  if (isSaved && wanted) save();
}

function fail(failure) {
  const problems = failure.answer?.problems;
  if (problems?.length) showProblems(problems, true);
  tell(problems?.length ? "Not saved: this cannot be published. See below." : `Not saved: ${failure.message}`);
  byId("message").scrollIntoView({ block: "center" });
}

// Somebody else may have saved since the page was loaded: nothing is then gone back to, and what is changed here stays.
async function goBack(version) {
  if (saving || (dirty && !confirm("What you changed is not saved, and would be lost. Go back all the same?"))) return;
  const given = JSON.stringify(tours);
  saving = true;
  try {
    const isStale = await ask("POST", "/api/restore", { document: "tours.json", version, tag })
      .then(() => false, failure => { if (failure.status !== 412) throw failure; return true; });
    if (!isStale) clashes = [];
    await load(isStale ? stored : given);
    await showVersions();
    if (isStale) tell("Somebody else has saved tours meanwhile, as the history shows now. What you changed is still here. Go back again if you still want to.");
    else tell("These are the old tours. They were saved as a new version, so nothing is lost.", true);
  } catch (failure) {
    fail(failure);
  }
  saving = false;
}

async function showVersions() {
  byId("versions").replaceChildren(await versionsOf("tours.json", goBack).catch(failure => failure.message));
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
  const key = keyOf(event), control = event.ctrlKey || event.metaKey;
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
guardLeaving(() => dirty);

loadSession().then(async session => {
  if (session.role === "nobody") { location.assign("/sign-in"); return; }
  showAccount(session);
  for (const name of ["title", "caption"]) byId(name).readOnly = !may("editor");
  byId("attract").disabled = byId("remove").disabled = !may("editor");
  information = await ask("GET", "/api/information");
  language = information.languages[0];
  byId("name").textContent = information.name;
  eye.connect();
  await load(stored);
}).catch(failure => { byId("nothing").textContent = failure.message; });
