// What differs between browsers and between keyboards.

// The key that was pressed, in lower case. On a keyboard of another script, as Arabic or Khmer, it is what the same key is on
// a Latin one, as browsers take it for their own shortcuts. With Alt it is itself: AltGr, which is Ctrl and Alt, writes letters.
export function keyOf({ key = "", code = "", altKey }) {
  if (key.length > 1) return key;
  return (altKey || /^[ -~]$/.test(key) ? key : code.replace(/^(Key|Digit)/, "")).toLowerCase();
}

let isUnsaved = () => false;

// Asks whoever leaves the page whether what is not saved may go. Chromium before 119, the last ones for some computers, asks
// for returnValue alone.
export function guardLeaving(ofPage) {
  isUnsaved = ofPage;
  addEventListener("beforeunload", event => {
    if (!isUnsaved()) return;
    event.preventDefault();
    event.returnValue = true;
  });
}

// Returns whether what is not saved may go. The browser does not ask again then.
export function mayLose(question) {
  if (isUnsaved() && !confirm(question)) return false;
  isUnsaved = () => false;
  return true;
}
