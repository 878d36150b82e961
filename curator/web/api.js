// Requests to the program. Who is signed in is asked once; each change carries the page's token.
let session = { name: "", role: "nobody", token: "" };

export class Failure extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

// Returns the parsed answer, or null where there is none. Throws a Failure with the program's sentence.
export async function ask(method, path, body) {
  const headers = {};
  if (method !== "GET") headers["X-Gopura-Token"] = session.token;
  if (body !== undefined) headers["Content-Type"] = "application/json";
  let response;
  try {
    response = await fetch(path, { method, headers, body: body === undefined ? undefined : JSON.stringify(body), credentials: "same-origin" });
  } catch {
    throw new Failure(0, "No connection: is gopura-curator running?");
  }
  const isJson = (response.headers.get("content-type") || "").startsWith("application/json");
  const answer = isJson ? await response.json() : null;
  if (!response.ok) throw new Failure(response.status, (answer && answer.message) || `The program answered ${response.status}.`);
  return answer;
}

export async function loadSession() {
  session = await ask("GET", "/api/session");
  return session;
}

export async function signIn(name, password) {
  session = await ask("POST", "/api/session", { name, password });
  return session;
}

export async function signOut() {
  await ask("DELETE", "/api/session");
}

const ROLES = ["nobody", "reader", "editor", "publisher"];
export const may = role => ROLES.indexOf(session.role) >= ROLES.indexOf(role);
export const token = () => session.token;
