// Requests to the program. Who is signed in is asked once; each change carries the page's token.
let session = { name: "", role: "nobody", token: "" };

const UPLOAD_BYTES_MAX = 32 << 20; // refused before it is sent, where a proxy would cut the line

export class Failure extends Error {
  constructor(status, message, answer = null) {
    super(message);
    this.status = status;
    this.answer = answer; // the whole of it
  }
}

async function send(method, path, body, more) {
  const isBytes = body instanceof Blob, headers = { ...more };
  if (method !== "GET") headers["X-Gopura-Token"] = session.token;
  if (isBytes && body.size > UPLOAD_BYTES_MAX) throw new Failure(413, "It is larger than 32 MB: make it smaller.");
  if (body !== undefined) headers["Content-Type"] = isBytes ? "application/octet-stream" : "application/json";
  try {
    return await fetch(path, { method, headers, body: body === undefined || isBytes ? body : JSON.stringify(body), credentials: "same-origin" });
  } catch {
    throw new Failure(0, "No connection: is gopura-curator running?");
  }
}

// A page outlives its session where the program was started again, or where its curator signed in again in another tab: the
// change is then sent with the new session's token.
async function request(method, path, body, more) {
  const response = await send(method, path, body, more), before = session;
  if (method === "GET" || path === "/api/session" || (response.status !== 401 && response.status !== 403)) return response;
  await loadSession();
  if (session.name === before.name && session.role !== "nobody") return session.token === before.token ? response : send(method, path, body, more);
  const now = session.role === "nobody" ? "Nobody is signed in any more" : `${session.name} is signed in now`;
  session = before; // what is open here is still this curator's, and can be saved when they are back
  throw new Failure(401, `${now}. Sign in as ${before.name} in another tab of this browser, then save here: what you wrote is still on this page.`);
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
