# Sourced by tests of the fetcher alone, from the top of the tree: sets tool and fetch, which are made if they are missing,
# and folder, a new temporary one.
tool=build/tests/tools/fetch_tool fetch=build/gopura-fetch
for program in "$tool" "$fetch"; do [ -x "$program" ] || make -s "$program"; done
folder=$(mktemp -d)
