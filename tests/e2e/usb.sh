#!/bin/bash
# Which USB devices are accepted (gopura-usb, which udev calls): each interface of a device is judged by its drivers, in
# a folder that stands for /sys. tests/qemu/usb.py plugs devices into a virtual machine.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=$PWD/build/e2e/usb
rm -rf "$work"
mkdir -p "$work/bin" "$work/sys/bus/usb"
policy=$PWD/image/root/usr/lib/gopura/gopura-usb

# modules of the image that exist for a device that identifies itself so, and where they are
cat >"$work/bin/modprobe" <<'P'
#!/bin/sh
case $2 in
*asix*ic08*) echo asix; echo uas; echo usb_storage ;;
*ic08*) echo uas; echo usb_storage ;;
*ic03*) echo usbhid ;;
*ic09*) echo usbcore; echo usbcore ;;
*ic02*) echo cdc_ether ;;
*touch*) echo usbtouchscreen ;;
*radio*) echo rtl8xxxu ;;
*displaylink*) echo udl ;;
*strange*) echo strange ;;
*killed*) kill -KILL $$ ;;
*half*) echo usb_storage; kill -KILL $$ ;;
*) exit 1 ;;
esac
P
cat >"$work/bin/modinfo" <<'P'
#!/bin/sh
case $2 in
asix | cdc_ether) echo "/lib/modules/kernel/drivers/net/usb/$2.ko" ;;
uas | usb_storage) echo "/lib/modules/kernel/drivers/usb/storage/$2.ko" ;;
usbcore) echo /lib/modules/kernel/drivers/usb/core/usbcore.ko ;;
usbhid) echo /lib/modules/kernel/drivers/hid/usbhid/usbhid.ko ;;
usbtouchscreen) echo /lib/modules/kernel/drivers/input/touchscreen/usbtouchscreen.ko ;;
rtl8xxxu) echo /lib/modules/kernel/drivers/net/wireless/realtek/rtl8xxxu/rtl8xxxu.ko ;;
udl) echo /lib/modules/kernel/drivers/gpu/drm/udl/udl.ko ;;
*) exit 1 ;;
esac
P
chmod +x "$work"/bin/*
export PATH=$work/bin:$PATH GOPURA_USB_ALLOWED=$work/allowed GOPURA_USB_LOG=$work/said

# device INTERFACE...: each "class subclass protocol" and, where it matters, the device's name
devices=0
device() {
	local number=0 class subclass protocol name
	devices=$((devices + 1))
	folder=$work/sys/devices/pci0/usb1/1-$devices
	mkdir -p "$folder"
	echo "$#" >"$folder/bNumInterfaces"
	for interface in "$@"; do
		read -r class subclass protocol name <<<"$interface"
		local at=$folder/1-$devices:1.$number
		mkdir "$at"
		echo "$class" >"$at/bInterfaceClass"
		echo "$subclass" >"$at/bInterfaceSubClass"
		echo "$protocol" >"$at/bInterfaceProtocol"
		echo "usb:${name:-}ic$class" >"$at/modalias"
		echo 0 >"$at/authorized"
		number=$((number + 1))
	done
}
# judged INTERFACES EXPECTED: "1 0": the first is authorized, the second not
judged() {
	local at is=
	for at in "$folder"/*:*; do
		"$policy" interface "$at" || [ "$(cat "$at/authorized")" = 0 ] || fail "$1: refused, and authorized"
		is="$is$(cat "$at/authorized") "
	done
	[ "$is" = "$2 " ] || fail "$1: $is instead of $2"
}
: >"$work/allowed"
: >"$work/said"
stick="08 06 50" keyboard="03 01 01" hid="03 00 00" mouse="03 01 02" ether="02 06 00" ether_data="0a 00 00"

device "$stick"; judged "a stick" 1
grep -q "1-1:1.0" "$work/sys/bus/usb/drivers_probe" || fail "a stick is authorized, but no driver is asked"
device "09 00 00"; judged "a hub" 1
device "$hid"; judged "a touchscreen" 1
device "$hid" "$mouse" "ff 00 00"; judged "a touchscreen with a mouse and the maker's own" "1 1 1"
device "ff 00 00 touch"; judged "a touchscreen of the maker's own" 1
device "$keyboard"; judged "a keyboard" 0
device "$keyboard" "$mouse"; judged "a keyboard's radio" "0 1"
device "$hid" "$keyboard"; judged "a touchscreen that types" "1 0"
device "$stick" "$hid"; judged "a stick that types" "1 0"
device "$hid" "$ether"; judged "a touchscreen with a network" "0 0"
device "$ether" "$ether_data"; judged "a network, whose data no driver takes up alone" "0 1"
device "08 06 50 asix"; judged "a network that calls itself storage" 0
device "ff 00 00 radio"; judged "a radio" 0
device "ff 00 00 displaylink"; judged "a panel" 0
device "0e 01 00"; judged "a camera, for which there is no driver" 1
device "08 06 50 strange" && sed -i s/ic08// "$folder"/*:*/modalias; judged "what only an unknown driver wants" 0
# ---- what cannot be judged is refused
device "ff 00 00 killed"; judged "a device whose drivers are not known" 0
grep -q "1-$devices:1.0 () is not taken up: nothing could be found out about it" "$work/said" || fail "nobody was told why: $(tail -n 1 "$work/said")"
device "ff 00 00 half"; judged "a device of whose drivers half are known" 0
device "$stick" && rm "$folder"/*:*/modalias; judged "a device that does not say what it is" 0
device "$hid" && rm "$folder"/*:*/bInterfaceProtocol; judged "HID that does not say what it is" 0
(
	mkdir -p "$work/without"
	printf '#!/bin/sh\nexit 127\n' >"$work/without/modprobe"
	chmod +x "$work/without/modprobe"
	PATH=$work/without:$PATH
	device "$stick"; judged "a stick, without modprobe" 0
)
devices=$((devices + 1))
grep -q "1-6:1.0 () is not taken up: keyboard; allow it in gopura.conf, under \[usb\]" "$work/said" || fail "nobody was told of the keyboard"

# ---- what gopura.conf allows, and nothing else
echo "keyboard network" >"$work/allowed"
device "$keyboard"; judged "a keyboard that is allowed" 1
device "$ether" "$ether_data"; judged "a network that is allowed" "1 1"
[ "$(grep -c "1-$devices:1.0" "$work/sys/bus/usb/drivers_probe")" = 2 ] || fail "a network's driver is not asked again once its data may be had"
device "08 06 50 asix"; judged "any network that is allowed" 1
device "ff 00 00 radio"; judged "a radio beside networks by cable" 0
"$policy" allows keyboard || fail "keyboards are allowed"
! "$policy" allows wifi || fail "wifi is not allowed"
! "$policy" allows key || fail "a word is a whole word"
rm "$work/allowed"
! "$policy" allows keyboard || fail "nothing is allowed where nothing was said"

# ---- devices that were in use before they were checked stay, or are removed
device "$stick" "$keyboard"
for at in "$folder"/*:*; do echo 1 >"$at/authorized"; done
: >"$work/sys/bus/usb/drivers_probe"
judged "a stick and a keyboard from before" "1 0"
[ ! -s "$work/sys/bus/usb/drivers_probe" ] || fail "a driver was asked anew for what works"
echo "storage and touch are taken up, nothing else unless it is allowed: $devices devices"
