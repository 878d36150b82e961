#!/bin/sh
# flip_byte.sh FILE OFFSET: inverts the bits of one byte, so that it certainly differs from what it was.
set -eu
byte=$(od -An -tu1 -j "$2" -N 1 "$1" | tr -d ' ')
[ -n "$byte" ] || { echo "flip_byte: $1 has no byte $2" >&2; exit 1; }
# shellcheck disable=SC2059
printf "$(printf '\\%03o' $((255 - byte)))" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none
