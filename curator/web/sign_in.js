// The page where a curator signs in.
import { loadSession, signIn } from "./api.js";

const byId = id => document.getElementById(id);
const tell = text => { byId("message").textContent = text; };

function begin(session) {
  if (session.role !== "nobody") {
    location.replace("/");
    return;
  }
  byId("temple").textContent = session.temple;
  document.title = `Sign in – ${session.temple}`;
  if (session.sign_on) {
    byId("purpose").textContent = "Curators come here through the museum's own sign-on.";
    tell(session.name ? `${session.name} has no account here. Ask whoever administers gopura-curator.` : "The museum's sign-on has named nobody: sign on there first.");
    return;
  }
  byId("sign-in").hidden = false;
  byId("name").focus();
}

byId("sign-in").addEventListener("submit", async event => {
  event.preventDefault();
  const button = byId("enter");
  button.disabled = true;
  button.textContent = "Signing in …";
  tell("");
  try {
    await signIn(byId("name").value.trim(), byId("password").value);
    location.replace("/");
  } catch (failure) {
    tell(`${failure.message[0].toUpperCase()}${failure.message.slice(1)}${/[.?]$/.test(failure.message) ? "" : "."}`);
    byId("password").select();
    byId("password").focus();
  }
  button.disabled = false;
  button.textContent = "Sign in";
});

byId("reveal").addEventListener("click", () => {
  const shown = byId("password").type === "password";
  byId("password").type = shown ? "text" : "password";
  byId("reveal").textContent = shown ? "Hide" : "Show";
  byId("reveal").setAttribute("aria-pressed", String(shown));
  byId("password").focus();
});

loadSession().then(begin).catch(failure => tell(failure.message));
