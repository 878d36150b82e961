#!/bin/bash
# The curator's two services as docs/curator.md sets them up, started by systemd behind nginx: what a browser asks for is
# done within their confinement. systemd runs in a container over this machine's own files, which stay as they are.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
[ "$(id -u)" = 0 ] || skip "systemd is started in a container, which root alone may make"
command -v systemd-nspawn >/dev/null || skip "systemd-nspawn is not installed"
command -v nginx >/dev/null || skip "nginx is not installed"
work=$PWD/build/e2e/services
rm -rf "$work"
mkdir -p "$work"
tiny_content "$work/content" 10000 2000
build/gopura-content build "$work/content" --out "$work/release" --keys "$work/keys" >"$work/log" 2>&1 ||
	{ cat "$work/log"; fail "the first build"; }

# A content folder that comes from elsewhere has accounts already.
echo "password of ana" | build/gopura-curator user add "$work/content" ana --role editor

# ---- a machine: this one's files below, what is written above
space=$(mktemp -d)
away() {
	umount "$space/root" 2>/dev/null || true
	umount "$space" 2>/dev/null || true
	rmdir "$space" 2>/dev/null || true
}
trap away EXIT
mount -t tmpfs -o size=1g tmpfs "$space" || skip "no file system can be mounted here"
mkdir "$space/above" "$space/work" "$space/root" "$space/gopura"
mount -t overlay overlay -o "lowerdir=/,upperdir=$space/above,workdir=$space/work" "$space/root" ||
	skip "no overlay of / can be mounted here"
root=$space/root
ln -s /dev/null "$root/etc/systemd/system/systemd-networkd-wait-online.service" # it has no network
rm -f "$root/etc/machine-id" "$root"/etc/systemd/system/*.wants/* "$root"/etc/nginx/sites-enabled/*
mkdir -p "$root/srv/gopura" "$root/var/lib/gopura-publisher" "$root/srv/test"
cp build/gopura-curator build/gopura-content "$root/usr/bin/"
cp systemd/gopura-curator.service systemd/gopura-publisher.service "$root/etc/systemd/system/"
cp -a "$work/content" "$work/release" "$space/gopura/" # no overlay: files in one have other devices than their folder
cp -a "$work/keys" "$root/var/lib/gopura-publisher/keys"
cp tests/e2e/curator.py tests/e2e/services.py demo/content/pictures/*.jpg "$root/srv/test/"
cp "$(find demo/content/pages -name '*.opus' | sort | head -1)" "$root/srv/test/spoken.opus"
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=curator.museum.example \
	-keyout "$root/etc/ssl/curator.key" -out "$root/etc/ssl/curator.pem" 2>/dev/null
# Without a sign-on, as its head says.
sed -e '/auth_request/d' -e '/Remote-User/d' -e '/Answers 200/d' -e '/location = .sign-on/,/^\t}/d' server/curator.conf \
	>"$root/etc/nginx/sites-enabled/curator.conf"
sed -n '/^    groupadd/,/^$/p' docs/curator.md | sed 's/^    //' >"$root/srv/test/setup.sh"
grep -q useradd "$root/srv/test/setup.sh" || fail "docs/curator.md does not say how to set the services up"

cat >"$root/srv/test/run.sh" <<'IN'
#!/bin/bash
cd /srv/test
(
	set -eux
	bash -eux setup.sh
	echo "password of petra" |
		runuser -u gopura-curator -- gopura-curator user add /srv/gopura/content petra --role publisher
	systemctl enable --now gopura-publisher.service gopura-curator.service
	systemctl start nginx.service
	python3 services.py
) >log 2>&1
status=$?
{
	systemctl --no-pager --full status gopura-curator.service gopura-publisher.service nginx.service
	journalctl --no-pager -n 100
} >journal 2>&1
[ $status = 0 ] && ! grep 'less protection' journal && touch passed
systemctl poweroff
IN
cat >"$root/etc/systemd/system/run.service" <<'IN'
[Service]
Type=oneshot
TimeoutStartSec=200
ExecStart=/bin/bash /srv/test/run.sh
IN

timeout -k 10 220 systemd-nspawn --register=no --keep-unit --quiet -D "$root" --private-network --bind="$space/gopura:/srv/gopura" -b --console=pipe \
	systemd.unit=run.service </dev/null >"$work/console" 2>&1 || true
cp "$root"/srv/test/{log,journal,passed} "$work/" 2>/dev/null || true
[ -e "$work/log" ] || { cat "$work/console"; skip "systemd does not start in a container here"; }
[ -e "$work/passed" ] || { tail -n 15 "$work/log"; tail -n 40 "$work/journal"; fail "the services in a container"; }
