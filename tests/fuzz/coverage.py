#!/usr/bin/env python3
"""make fuzz-coverage: which lines and branches of each decoder the inputs of its fuzz target reach.

  TARGET=NAME  only tests/fuzz/fuzz_NAME.c

A target runs as in `make test`: each kept input as it is, truncated and changed blindly; then what `make fuzz` has found on
this machine (build/fuzz/NAME/corpus). The decoder is the source of each header that the target includes, with the sources of
the same folder whose headers those include. Lines and branches are those of functions that were entered, because some write
what others read. Functions never entered, and lines never reached, are listed in build/coverage/NAME.txt.
"""
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile

OUT = "build/coverage"
INCLUDE = re.compile(r'^#include "([^"]+)\.h"', re.M)


def included(path):
    with open(path, encoding="utf-8") as file:
        return [name for name in INCLUDE.findall(file.read()) if os.path.exists(name + ".c")]


def decoder(name):
    """The sources of a target's decoder. Those of base/ serve all, unless there is nothing else."""
    direct = [one for one in included(f"tests/fuzz/fuzz_{name}.c") if not one.startswith("tests/")]
    waiting, found = [one for one in direct if not one.startswith("base/")] or direct, set()
    while waiting:
        one = waiting.pop()
        if one in found:
            continue
        found.add(one)
        folder = os.path.dirname(one)
        if folder != "base":
            waiting += [other for other in included(one + ".c") if os.path.dirname(other) == folder]
    return sorted(one + ".c" for one in found)


def inputs(name):
    kept, found = f"tests/fuzz/corpus/{name}", f"build/fuzz/{name}/corpus"
    return [kept] + [os.path.join(found, file) for file in sorted(os.listdir(found) if os.path.isdir(found) else [])]


class Source:
    """What was counted in one: runs of functions by their first line, of lines, of branches by line, block and branch."""

    def __init__(self):
        self.functions, self.names, self.lines, self.branches = {}, {}, {}, {}

    def is_entered(self, line):
        """Whether the function of a line was entered: one that writes a format has no part in reading it."""
        before = [first for first in self.functions if first <= line]
        return bool(before) and self.functions[max(before)] > 0


def parse(told):
    """llvm-cov's lcov as sources by name."""
    out, source, starts = {}, None, {}
    for line in told.splitlines():
        kind, _, rest = line.partition(":")
        if kind == "SF":
            source, starts = out.setdefault(os.path.relpath(rest), Source()), {}
        elif kind == "FN":
            number, name = rest.split(",", 1)
            starts[name] = int(number)
        elif kind == "FNDA":
            count, name = rest.split(",", 1)
            source.functions[starts[name]] = int(count)
            source.names[starts[name]] = name.split(":")[-1]
        elif kind == "DA":
            number, count = rest.split(",")[:2]
            source.lines[int(number)] = int(count)
        elif kind == "BRDA":
            number, block, branch, count = rest.split(",")
            source.branches[int(number), block, branch] = 0 if count == "-" else int(count)
    return out


def reached(name):
    """The sources of a target's decoder, with what its inputs reached."""
    program, profile = f"{OUT}/tests/fuzz/fuzz_{name}", f"{OUT}/{name}.profdata"
    with tempfile.TemporaryDirectory(dir=OUT) as folder:  # a target may start processes
        environment = {**os.environ, "LLVM_PROFILE_FILE": os.path.join(folder, "%p")}
        run = subprocess.run([program, *inputs(name)], env=environment, capture_output=True, text=True)
        if run.returncode != 0:
            raise SystemExit(f"{program}: exit {run.returncode}\n{run.stderr[-2000:]}")
        written = [os.path.join(folder, file) for file in os.listdir(folder)]
        subprocess.run(["llvm-profdata", "merge", "-sparse", "-o", profile, *written], check=True)
    told = subprocess.run(["llvm-cov", "export", "-format=lcov", f"-instr-profile={profile}", program], check=True, capture_output=True, text=True).stdout
    counted = parse(told)
    return {source: counted[source] for source in decoder(name) if source in counted}


def share(counts):
    return f"{100 * sum(count > 0 for count in counts) / max(1, len(counts)):.1f}"


def tell(name, found):
    functions = [count for source in found.values() for count in source.functions.values()]
    lines = [count for source in found.values() for line, count in source.lines.items() if source.is_entered(line)]
    branches = [count for source in found.values() for at, count in source.branches.items() if source.is_entered(at[0])]
    with open(f"{OUT}/{name}.txt", "w", encoding="utf-8") as out:
        for path, source in found.items():
            with open(path, encoding="utf-8") as file:
                text = file.read().split("\n")
            for first, count in sorted(source.functions.items()):
                if count == 0:
                    print(f"{path}:{first}: {source.names[first]}() is never entered", file=out)
            for line, count in sorted(source.lines.items()):
                if count == 0 and source.is_entered(line):
                    print(f"{path}:{line}: {text[line - 1].strip()}", file=out)
    entered = f"{sum(count > 0 for count in functions)}/{len(functions)}"
    print(f"{name:16} {entered:>9} {len(lines):7} {share(lines):>7} {len(branches):9} {share(branches):>7}", flush=True)


def main():
    chosen = os.environ.get("TARGET", "").split()
    names = chosen or sorted(name[5:-2] for name in os.listdir("tests/fuzz") if re.fullmatch(r"fuzz_\w+\.c", name))
    for name in names:
        if not os.path.exists(f"tests/fuzz/fuzz_{name}.c"):
            raise SystemExit(f"TARGET={name}: there is no tests/fuzz/fuzz_{name}.c")
    os.makedirs(OUT, exist_ok=True)
    made = subprocess.run(["make", "--no-print-directory", f"-j{os.cpu_count()}", "COVERAGE=yes", f"BUILD={OUT}", *(f"{OUT}/tests/fuzz/fuzz_{name}" for name in names)], capture_output=True, text=True)
    if made.returncode != 0:
        raise SystemExit(made.stdout[-3000:] + made.stderr[-3000:])
    print(f"{'target':16} {'functions':>9} {'lines':>7} {'%':>7} {'branches':>9} {'%':>7}", flush=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, found in zip(names, pool.map(reached, names)):
            tell(name, found)


if __name__ == "__main__":
    sys.exit(main())
