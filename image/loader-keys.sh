#!/bin/bash
# loader-keys.sh make: creates in KEYS, if missing, the key that signs what the loader starts (loader.key, loader.pub:
# OpenPGP, which GRUB reads), and the key that signs the loader itself for UEFI's Secure Boot (secure-boot.key, .crt).
# loader-keys.sh sign FILE...: writes FILE.sig beside each.
set -eu
keys=${KEYS:-build/image-keys} what=$1
shift
# GnuPG wants a home, and starts an agent there; neither outlives this. A short path, because it holds sockets.
home=$(mktemp -d /tmp/gopura-gpg.XXXXXX)
trap 'gpgconf --homedir "$home" --kill all 2>/dev/null || true; rm -rf "$home"' EXIT
gpg() { command gpg --homedir "$home" --batch --quiet --pinentry-mode loopback --passphrase '' "$@"; }

case $what in
make)
	mkdir -p "$keys"
	if [ ! -f "$keys/loader.key" ]; then
		# Born before every commit, because signatures bear the commit's time.
		gpg --faked-system-time 20200101T000000! --quick-generate-key 'Gopura loader' rsa3072 sign never
		(umask 077 && gpg --export-secret-keys >"$keys/loader.key")
		gpg --export >"$keys/loader.pub"
	fi
	[ -f "$keys/secure-boot.key" ] || (umask 077 && openssl req -x509 -newkey rsa:2048 -sha256 -nodes -days 7300 \
		-subj '/CN=Gopura loader' -keyout "$keys/secure-boot.key" -out "$keys/secure-boot.crt" 2>/dev/null)
	;;
sign)
	gpg --import "$keys/loader.key"
	for file; do
		rm -f "$file.sig"
		gpg --faked-system-time "$SOURCE_DATE_EPOCH" --digest-algo SHA256 --detach-sign --output "$file.sig" "$file"
	done
	;;
esac
