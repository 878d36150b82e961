// Who is signed in, at the top of the page, and signing out.
import { signOut } from "./api.js";
import { mayLose } from "./browser.js";

const WORDS = { reader: "Reader", editor: "Editor", publisher: "Publisher" };

export function showAccount(session) {
  document.getElementById("who").textContent = session.name;
  document.getElementById("role").textContent = WORDS[session.role] || "";
  const button = document.getElementById("sign-out");
  button.hidden = session.sign_on; // the museum's own sign-on signs out
  button.addEventListener("click", async () => {
    if (!mayLose("What is not saved is lost. Sign out all the same?")) return; // what is marked ends with the session
    try {
      await signOut();
    } finally {
      location.assign("/sign-in");
    }
  });
  document.getElementById("account").hidden = false;
}
