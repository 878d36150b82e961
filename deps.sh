#!/bin/sh
# deps.sh [LIST]: installs the packages of the list (packages.txt) that are missing. Needs root, or a user with sudo.
set -eu
cd "$(dirname "$0")"
list=${1:-packages.txt}
missing=$(grep -v '^#' "$list" | while read -r name; do
	dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q 'ok installed' || echo "$name"
done)
[ -n "$missing" ] || exit 0
if [ "$(id -u)" = 0 ]; then as_root=; else
	as_root=sudo
	command -v sudo >/dev/null || { echo "deps.sh: run this as root, or install sudo; missing:" $missing >&2; exit 1; }
fi
echo "Installing $(echo "$missing" | wc -l) Debian packages (see $list) ..."
$as_root apt-get update -qq
# A new machine often installs its own updates for its first minutes: this waits for them.
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=600 \
	-o Dpkg::Progress-Fancy=0 -o Dpkg::Use-Pty=0 $missing </dev/null >build/deps.log 2>&1 ||
	{ tail -20 build/deps.log >&2; exit 1; }
echo "Packages are installed."
