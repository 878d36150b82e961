// Requests to the program. Who is signed in is asked once; each change carries the page's token.
let session = { name: "", role: "nobody", token: "" };

export class Failure extends Error {
  constructor(status, message, answer = null) {
    super(message);
    this.status = status;
    this.answer = answer; // the whole of it
  }
}

async function request(method, path, body, more) {
  const isBytes = body instanceof Blob, headers = { ...more };
  if (method !== "GET") headers["X-Gopura-Token"] = session.token;
  if (body !== undefined) headers["Content-Type"] = isBytes ? "application/octet-stream" : "application/json";
  try {
    return await fetch(path, { method, headers, body: body === undefined || isBytes ? body : JSON.stringify(body), credentials: "same-origin" });
  } catch {
    throw new Failure(0, "No connection: is gopura-curator running?");
  }
}

// Returns the parsed answer, or null where there is none. Throws a Failure with the program's sentence. A body is an
// object, or a Blob, which is sent as it is.
export async function ask(method, path, body, headers) {
  const response = await request(method, path, body, headers);
  const isJson = (response.headers.get("content-type") || "").startsWith("application/json");
  const answer = isJson ? await response.json() : null;
  if (!response.ok) throw new Failure(response.status, (answer && answer.message) || `The program answered ${response.status}.`, answer);
  return answer;
}

// The same where the answer is a picture: returns a Blob.
export async function askPicture(method, path, body) {
  const response = await request(method, path, body);
  if (response.ok) return response.blob();
  const answer = await response.json().catch(() => null);
  throw new Failure(response.status, (answer && answer.message) || `The program answered ${response.status}.`, answer);
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
