# Part of the guest's init: starts the kiosk and changes its panel (gopura.case= of the command line).
preload=
case $(sed -n 's/.*gopura\.case=\([a-z]*\).*/\1/p' /proc/cmdline) in
unplugged)
	# Without a panel at the start; then it comes, goes and comes again.
	preload=/lost_gl.so
	status=$(ls /sys/class/drm/card0-*/status)
	echo off >"$status"
	self_test >/dev/console
	(
		said 'no panel is connected'
		sleep 4
		echo "init: plugged in"
		echo on >"$status"
		said 'app: first picture'
		sleep 2
		echo "init: unplugged"
		echo off >"$status"
		said 'the panel was unplugged'
		sleep 5
		echo "init: plugged in again"
		echo on >"$status"
		said 'app: card of'
		sleep 3
		echo "init: the GPU is reset"
		: >/tmp/lost
	) >/dev/console &
	;;
closed)
	self_test >/dev/console
	# Open on a day that is neither today nor next to it, in whatever time zone.
	set -- --hours "$(date -d "@$(($(date +%s) + 259200))" +%a) 09:00-10:00" --shift
	;;
safe)
	# A safe page, and a kiosk that begins while that has the card.
	{
		/bin/gopura-kiosk --safe-page --display drm 2>&1 &
		echo $! >/tmp/safe
		wait
	} | tee -a /tmp/log >/dev/console &
	said 'KMS canvas'
	(
		said 'waiting until it ends'
		sleep 12
		echo "init: the safe page ends"
		kill "$(cat /tmp/safe)"
	) >/dev/console &
	;;
esac
until kiosk "$@" | tee -a /tmp/log >/dev/console; grep -q 'the kiosk ended with status [^7]' /tmp/log; do
	rm -f /tmp/lost
	sleep 0.2 # as the service manager does for status 75 and 76
done
