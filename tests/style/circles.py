#!/usr/bin/env python3
"""circles.py FOLDER: sources that call one another in a circle, read off the object files below FOLDER.

Calls go down and callbacks go up, so no two sources may need each other's functions. A struct that they
share does not hide it: what counts is which object file defines a symbol that another one uses.
"""
import collections
import os
import subprocess
import sys


def object_files(folder):
    for top, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if os.path.relpath(os.path.join(top, name), folder) != "tests"]
        for name in names:
            source = os.path.relpath(os.path.join(top, name), folder)[:-2]
            if name.endswith(".o") and os.path.exists(source + ".c"):  # not left over from a source that is gone
                yield os.path.join(top, name)


def calls(folder):
    """The sources that each source uses a symbol of."""
    out = subprocess.run(["nm", "-A", *object_files(folder)], capture_output=True, text=True, check=True).stdout
    defined, used = {}, collections.defaultdict(set)
    for line in out.splitlines():
        path, rest = line.split(".o:", 1)
        source = os.path.relpath(path, folder)
        kind, name = rest.split()[-2:]
        if kind == "U":
            used[source].add(name)
        elif kind in "BDRTV" and name != "main":
            defined[name] = source
    return {source: {defined[name] for name in names if name in defined} - {source} for source, names in used.items()}


def circles(graph):
    """Strongly connected components of more than one source (Tarjan 1972)."""
    index, low, stack, found = {}, {}, [], []

    def walk(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in index:
                walk(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == index[node]:
            at = stack.index(node)
            if len(stack) - at > 1:
                found.append(" ".join(sorted(stack[at:])))
            del stack[at:]

    for node in graph:
        if node not in index:
            walk(node)
    return set(found)


def main():
    sys.setrecursionlimit(10000)
    graph = calls(sys.argv[1])
    if len(graph) < 100:
        sys.exit(f"{sys.argv[1]}: {len(graph)} object files: build the programs first")
    found = circles(graph)
    for circle in sorted(found):
        print(f"a circle of calls: {circle}: move what both need below them, or call back")
    print(f"{len(graph)} sources, {len(found)} circles of calls")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
