// What keeps a part from being published, in words for this page.
const list = document.getElementById("problems");

// A problem with the part that it is about, as its file or its sentence names it.
export function locate(problem) {
  const page = /^pages\/([a-z0-9_-]+)\.([A-Za-z-]+)\.html$/.exec(problem.file), named = /part "([a-z0-9_-]+)"/.exec(problem.text);
  return { ...problem, part: page ? page[1] : named ? named[1] : "", language: page ? page[2] : "" };
}

// A build's sentence says what to write into parts.json; here there is a field for it.
function forPage(text) {
  const names = new Intl.DisplayNames([], { type: "language" });
  const short = text.replace(/^part "[^"]*"[:,]? /, "").replace(/: add "[a-z]+": .*$/, "").replace(/^is missing: write it, or .*$/, "the page is missing: write it").replace(/in "([A-Za-z-]+)"/, (all, code) => `in ${names.of(code)}`);
  return short[0].toUpperCase() + short.slice(1);
}

// language: of what is open.
export function showProblems(problems, language) {
  list.replaceChildren(...problems.map(problem => {
    const item = document.createElement("li");
    item.className = problem.error ? "error" : "";
    item.textContent = `${problem.language && problem.language !== language ? `${problem.language}: ` : ""}${forPage(problem.text)}`;
    return item;
  }));
}
