# version.sh: sets version_text and sequence of what is built, by VERSION, SEQUENCE and the commit; to be sourced in the
# root of the tree. A terminal tells systems apart by their version, so the same commit built with a number of its own has
# a version of its own.
sequence=${SEQUENCE:-${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}}
version_text=${VERSION:-$(git describe --always --dirty)${SEQUENCE:+.$SEQUENCE}}
