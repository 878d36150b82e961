// Publishing: what the next release would change, the button, progress, the releases and the way back.
import { ask, may } from "./api.js";

const byId = id => document.getElementById(id);
const POLL_MS = 1000;
let poll = 0, changes = null, state = null;
let refused = ""; // why the last request was not taken

function element(name, text = "", className = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

const plural = (n, one, many = `${one}s`) => `${n.toLocaleString()} ${n === 1 ? one : many}`;
const sentence = text => text && `${text[0].toUpperCase()}${text.slice(1)}${/[.:…?]$/.test(text) ? "" : "."}`;
const when = seconds => seconds ? new Date(seconds * 1000).toLocaleString([], { dateStyle: "medium", timeStyle: "short" }) : "";

function bytes(n) {
  return n < 1e6 ? `${Math.max(1, Math.round(n / 1e3))} KB` : `${(n / 1e6).toFixed(1)} MB`;
}

// ---- what would change

const KINDS = [["parts", "Part"], ["cards", "Card"], ["pages", "Page"], ["sounds", "Sound"], ["pictures", "Picture"], ["tours", "Tour"]];
const SIGNS = { added: "+", changed: "~", removed: "−" };
const isDifferent = () => changes && !changes.errors.length && (changes.bytes > 0 || changes.model === "new" || !changes.release);

function changeRow(kind, row) {
  const item = element("li", "", `change ${row.change}`), sign = element("span", SIGNS[row.change], "sign");
  sign.setAttribute("aria-hidden", "true");
  const language = ["cards", "pages", "sounds"].includes(kind) ? row.key.slice(row.key.lastIndexOf(".") + 1) : "";
  const what = element("span", `${row.title || row.key}`, "what");
  const label = KINDS.find(one => one[0] === kind)[1];
  item.append(sign, what, element("small", `${label}${language ? ` · ${language}` : ""} ${row.change}`));
  return item;
}

function listOf(rows, className) {
  const list = element("ul", "", className);
  list.append(...rows);
  return list;
}

function section(title, list, open = true) {
  const details = element("details"), summary = element("summary", title);
  details.open = open;
  details.append(summary, list);
  return details;
}

function missingRows() {
  const rows = [];
  for (const { code, titles, pages } of changes.languages) {
    const lacks = [titles && plural(titles, "title"), pages && plural(pages, "page")].filter(Boolean);
    if (lacks.length) rows.push(element("li", `${code}: ${lacks.join(" and ")}`));
  }
  return rows;
}

function changeSections() {
  const made = [], rows = KINDS.flatMap(([kind]) => changes[kind].map(row => changeRow(kind, row)));
  if (changes.model === "new") made.push(element("p", "The model will be built anew, which may take hours: scans or settings have changed.", "note"));
  if (rows.length) made.push(section(plural(rows.length, "change"), listOf(rows, "changes")));
  else made.push(element("p", isDifferent() ? "Credits, order or settings have changed." : "Nothing has changed since the last release.", "quiet"));
  if (isDifferent()) made.push(element("p", `Terminals will fetch about ${bytes(changes.bytes)} for texts and pictures.`, "quiet"));
  if (changes.sound_bytes) made.push(element("p", `And ${bytes(changes.sound_bytes)} of speech, when somebody listens for the first time.`, "quiet"));
  const missing = missingRows();
  if (missing.length) made.push(section("Not translated yet", listOf(missing, "plain"), false));
  return made;
}

function showChanges() {
  const made = [];
  if (changes.errors.length)
    made.push(section(`${plural(changes.errors.length, "error")} to correct first`, listOf(changes.errors.map(text => element("li", text)), "plain errors")));
  else made.push(...changeSections());
  if (changes.undescribed.length)
    made.push(section(`${plural(changes.undescribed.length, "picture")} without a description`,
      listOf(changes.undescribed.map(one => element("li", `${one.file}:${one.line}: ${one.picture}`)), "plain"), false));
  if (changes.warnings.length)
    made.push(section(plural(changes.warnings.length, "warning"), listOf(changes.warnings.map(text => element("li", text)), "plain"), false));
  byId("changes").replaceChildren(...made);
  showButton();
}

async function loadChanges() {
  byId("changes").replaceChildren(element("p", "Comparing with the last release …", "quiet"));
  try {
    changes = await ask("GET", "/api/changes");
    showChanges();
  } catch (failure) {
    changes = null;
    byId("changes").replaceChildren(element("p", sentence(failure.message), "problem"));
    showButton();
  }
}

// ---- the state

const isPending = () => state && (state.step === "waiting" || state.step === "running");

function showButton() {
  byId("publish-now").disabled = !may("publisher") || isPending() || !isDifferent() || !state || !state.publisher;
  byId("publish-comment").disabled = !may("publisher") || isPending();
}

function outcome() {
  const wish = state.sequence ? `going back to release ${state.sequence}` : "publishing";
  switch (state.step) {
  case "waiting": return ["", `${state.by} asked for it; the publisher begins soon.`];
  case "running": return ["busy", `${wish[0].toUpperCase()}${wish.slice(1)} for ${state.by} since ${when(state.begun)} …`];
  case "done": return ["good", state.after > state.before ? `Release ${state.after} was published on ${when(state.ended)}.` : "Nothing had changed, so there is no new release."];
  case "failed": return ["problem", `${wish[0].toUpperCase()}${wish.slice(1)} failed: ${state.message.replace(/^error: (pipeline: )?/, "")}`];
  default: return ["", ""];
  }
}

function showState() {
  const [kind, text] = outcome();
  byId("publish-form").hidden = !state.set_up; // the changes say why
  const line = byId("publish-state");
  if (line.textContent !== text) line.textContent = text; // a screen reader says only what is new
  line.className = `state ${kind}`;
  const problem = !state.publisher && !isPending() ? "The publisher does not run, so nothing can be published now." :
    !state.publisher ? "The publisher does not run: the request waits for it." : !may("publisher") ? "Only publishers can publish." : refused;
  byId("publish-problem").textContent = problem;
  byId("publish-problem").hidden = !problem;
  const last = (state.log || "").trimEnd().split("\n").pop();
  byId("publish-progress").textContent = state.step === "running" ? last : "";
  byId("publish-log").textContent = state.log || "";
  byId("publish-log-box").hidden = !state.log;
  showReleases();
  showButton();
}

function releaseRow(release) {
  const item = element("li", "", release.current ? "release current" : "release"), text = element("div");
  text.append(element("strong", `Release ${release.sequence}`), element("span", release.comment || "no comment", release.comment ? "" : "quiet"),
    element("small", [release.by, when(release.at)].filter(Boolean).join(" · ") || "made on the command line"));
  item.append(text);
  if (release.current) item.append(element("em", release === state.releases[0] ? "current" : "the same"));
  else if (may("publisher")) {
    const back = element("button", "Go back");
    back.type = "button";
    back.disabled = isPending() || !state.publisher;
    back.setAttribute("aria-label", `Go back to release ${release.sequence}`);
    back.addEventListener("click", () => goBack(release));
    item.append(back);
  }
  return item;
}

let shown = "";
function showReleases() {
  const now = JSON.stringify([state.releases, isPending(), state.publisher]);
  if (now === shown) return; // keeps the focus
  shown = now;
  byId("releases").replaceChildren(...state.releases.map(releaseRow));
  byId("no-releases").hidden = state.releases.length > 0;
}

async function loadState() {
  clearTimeout(poll);
  const was = isPending();
  try {
    state = await ask("GET", "/api/publish?log=1");
    showState();
    if (was && !isPending()) loadChanges();
  } catch (failure) {
    byId("publish-state").textContent = sentence(failure.message);
    byId("publish-state").className = "state problem";
  }
  if (byId("publish").open) poll = setTimeout(loadState, isPending() ? POLL_MS : 10 * POLL_MS);
}

// ---- asking for it

async function send(wish) {
  refused = "";
  try {
    await ask("POST", "/api/publish", wish);
    byId("publish-comment").value = "";
  } catch (failure) {
    refused = sentence(failure.message);
    if (failure.answer?.changes) { // somebody has saved since they were looked at
      changes = failure.answer.changes;
      showChanges();
    }
    showState();
    return;
  }
  await loadState();
}

// Asked twice, in the page: a release is what every terminal shows.
function goBack(release) {
  byId("back-question").textContent = `Show release ${release.sequence} on every terminal again? It becomes a new release; the content here stays as it is.`;
  byId("back").returnValue = "";
  byId("back").onclose = () => {
    if (byId("back").returnValue === "yes")
      send({ comment: `back to release ${release.sequence}`, sequence: release.sequence });
  };
  byId("back").showModal();
}

export function setUpPublishing() {
  byId("open-publish").hidden = false;
  const open = () => {
    byId("publish").showModal();
    refused = "";
    loadState();
    loadChanges();
  };
  byId("open-publish").addEventListener("click", open);
  if (location.hash === "#publish") { // as the other pages link here
    history.replaceState(null, "", "/");
    open();
  }
  byId("publish").addEventListener("close", () => clearTimeout(poll));
  byId("close-publish").addEventListener("click", () => byId("publish").close());
  byId("publish-form").addEventListener("submit", event => {
    event.preventDefault();
    if (!byId("publish-now").disabled) send({ comment: byId("publish-comment").value.trim(), content: changes.content });
  });
}
