#!/bin/bash
# Prepares a run folder for nginx: certificate authority, certificate, configuration.
#
#   server/setup.sh RELEASE PORT RUN [NAME ...]
#
# RELEASE  the release folder to serve (it may still be empty)
# PORT     to listen on
# RUN      where certificate, configuration, logs and pid go; kept between runs
# NAME     further host names or addresses for the certificate (localhost and 127.0.0.1 are in it)
#
# GOPURA_LISTEN  address to listen on, default 127.0.0.1 (0.0.0.0 for all)
#
# Copy RUN/ca.pem to the terminals. Its key stays in RUN/tls (mode 0600): keep that folder private, and a copy of both.
set -eu
usage() { sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; }
[ "${1:-}" != --help ] || { usage; exit 0; }
[ $# -ge 3 ] || { usage >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
release=$1 port=$2 run=$3
shift 3
[ -d "$release" ] || { echo "setup.sh: no such folder: $release" >&2; exit 1; }
case $release in *[\"\$\;]*) echo "setup.sh: the folder's path must not contain \" \$ ;" >&2; exit 1 ;; esac
case $port in '' | *[!0-9]*) echo "setup.sh: not a port: $port" >&2; exit 2 ;; esac
release=$(cd "$release" && pwd)
mkdir -p "$run/logs" "$run/temp" "$run/tls"
chmod 0700 "$run/tls"
run=$(cd "$run" && pwd)

# ---- certificates: an authority for thirty years, because terminals have to be told of another one by hand, and one of
# the server for ten, renewed when the names change or a year is left
names="DNS:localhost,IP:127.0.0.1"
for name in "$@"; do
	case $name in
	*:*) names="$names,IP:$name" ;;
	*[!0-9.]*) names="$names,DNS:$name" ;;
	*) names="$names,IP:$name" ;;
	esac
done
ec() { openssl ecparam -name prime256v1 -genkey -noout -out "$1" && chmod 0600 "$1"; }
fail() { echo "setup.sh: $*" >&2; exit 1; }
cd "$run/tls"
holds() { openssl x509 -in "$1" -noout 2>/dev/null; } # a certificate
if [ ! -e ca.key ] && [ ! -e server.pem ] && ! holds ../ca.pem; then
	ec ca.key.new
	openssl req -x509 -new -key ca.key.new -sha256 -days 10950 -subj "/CN=Gopura museum server $(date +%F)" \
		-addext basicConstraints=critical,CA:TRUE,pathlen:0 \
		-addext keyUsage=critical,keyCertSign,cRLSign -out ../ca.pem.new
	holds ../ca.pem.new || fail "$run/ca.pem cannot be written: is the disk full?" # openssl does not tell
	mv ca.key.new ca.key
	mv ../ca.pem.new ../ca.pem
elif ! holds ../ca.pem; then
	# Another authority, made silently, would be one that no terminal knows.
	fail "$run/ca.pem is missing or damaged: copy it back from a terminal or a backup. If no terminal has it, remove" \
		"$run/tls, and another one is made"
fi
lasts() { openssl x509 -in "$1" -noout -checkend $((365 * 86400)) >/dev/null; }
until=$(openssl x509 -in ../ca.pem -noout -enddate | cut -d = -f 2)
days=$((($(date -d "$until" +%s) - $(date +%s)) / 86400)) # what an authority signs is worth nothing after its own end
lasts ../ca.pem ||
	echo "setup.sh: WARNING: the certificate authority $run/ca.pem ends on $until. Then no terminal reaches this server" \
		"any more. Give all terminals another one before: docs/server.md, Another certificate authority" >&2
if [ ! -f server.pem ] || [ "$(cat names 2>/dev/null)" != "$names" ] || ! lasts server.pem; then
	[ "$days" -gt 0 ] || fail "an authority that has ended signs no certificate; it ended on $until, and today is $(date)"
	[ -s ca.key ] || fail "$run/tls/ca.key is missing: copy it back from a backup, or see docs/server.md, Another certificate authority"
	rm -f names # what is interrupted here is made again
	ec server.key
	printf '%s\n' "subjectAltName=$names" basicConstraints=critical,CA:FALSE \
		keyUsage=critical,digitalSignature extendedKeyUsage=serverAuth authorityKeyIdentifier=keyid >extensions
	openssl req -new -key server.key -subj "/CN=localhost" -out request.pem
	openssl x509 -req -in request.pem -CA ../ca.pem -CAkey ca.key -CAcreateserial -sha256 \
		-days $((days < 3650 ? days : 3650)) -extfile extensions -out server.pem 2>openssl.log || { cat openssl.log >&2; exit 1; }
	printf '%s' "$names" >names
fi
cd "$run"

# ---- configuration. If started by root, nginx would run its workers as a user that may not read the release.
user=
[ "$(id -u)" != 0 ] || user="user $(stat -c %U "$release") $(stat -c %G "$release");"
sed_text() { printf '%s' "$1" | sed 's/[\\&|]/\\&/g'; }
sed -e "s|@FOLDER@|$(sed_text "$release")|" -e "s|@PORT@|$port|" -e "s|@USER@|$user|" \
	-e "s|@LISTEN@|$(sed_text "${GOPURA_LISTEN:-127.0.0.1}")|" "$here/nginx.conf.in" >nginx.conf
cp "$here/headers.conf" headers.conf
nginx -t -q -p "$run" -e logs/error.log -c nginx.conf
