#!/usr/bin/env python3
"""Writes the umockdev description of the two test devices beside this file."""
import os
import struct

HERE = os.path.dirname(os.path.abspath(__file__))
SLOTS_BYTES = 1028  # libevdev asks with room for 256 slots and the axis


def bits(numbers, size):
    value = 0
    for n in numbers:
        value |= 1 << n
    return value.to_bytes(size, "little").hex().upper()


def absinfo(maximum):
    return struct.pack("<iiiiii", 0, 0, maximum, 0, 0, 0).hex().upper()


def slots(axis, value):
    values = [value] * 5 + [0] * (SLOTS_BYTES // 4 - 6)
    return struct.pack("<257i", axis, *values).hex().upper()


def write(name, title, number, keys, axes, slot_axes, properties, calibrations={}):
    device = f"input/input{number}/event{number}"
    words = sum(1 << k for k in keys)
    key_words = " ".join(f"{(words >> shift) & (2 ** 64 - 1):x}" for shift in range(704, -1, -64))
    for suffix, matrix in {"": None, **calibrations}.items():
        udev = f"E: LIBINPUT_CALIBRATION_MATRIX={matrix}\n" if matrix else ""
        with open(f"{HERE}/{name}{suffix}.umockdev", "w") as out:
            out.write(f"""P: /devices/virtual/{device}
N: input/event{number}
E: DEVNAME=/dev/input/event{number}
E: DEVPATH=/devices/virtual/{device}
E: ID_INPUT=1
{udev}E: MAJOR=13
E: MINOR={64 + number}
E: SUBSYSTEM=input
A: dev=13:{64 + number}\\n

P: /devices/virtual/input/input{number}
E: EV=b
E: KEY={key_words.lstrip("0 ") or "0"}
E: ABS={sum(1 << a for a in axes):x}
E: PROP={sum(1 << p for p in properties):x}
E: NAME="{title}"
E: SUBSYSTEM=input
A: name={title}\\n
""")
    with open(f"{HERE}/{name}.ioctl", "w") as out:
        out.write(f"@DEV /dev/input/event{number}\n")
        out.write(f"EVIOCGBIT(0) 8 {bits([0, 1, 3], 8)}\n")
        text = title.encode() + b"\0"
        out.write(f"EVIOCGNAME(0) {len(text)} {text.ljust(255, bytes(1)).hex().upper()}\n")
        out.write("EVIOCGID 0 0300341200000000\nEVIOCGVERSION 0 01000100\n")
        out.write(f"EVIOCGPROP(0) 8 {bits(properties, 8)}\n")
        out.write(f"EVIOCGBIT(1) 96 {bits(keys, 96)}\n")
        out.write(f"EVIOCGBIT(3) 8 {bits(axes, 8)}\n")
        for kind, size in ((2, 8), (17, 8), (5, 8), (4, 8), (21, 16), (18, 8)):
            out.write(f"EVIOCGBIT({kind}) {size} {bits([], size)}\n")
        out.write(f"EVIOCGKEY(0) 96 {bits([], 96)}\nEVIOCGLED(0) 8 {bits([], 8)}\n")
        out.write(f"EVIOCGSW(0) 8 {bits([], 8)}\n")
        for axis, maximum in axes.items():
            code = f"({axis})" if axis else ""
            out.write(f"EVIOCGABS{code} 0 {absinfo(maximum)}\n")
        for axis in slot_axes:
            out.write(f"EVIOCGMTSLOTS(0) 0 {slots(axis, -1 if axis == 0x39 else 0)}\n")


write("panel", "Gopura test panel", 5, [0x14A], {
    0x00: 4095, 0x01: 4095, 0x2F: 4, 0x30: 4095, 0x35: 4095, 0x36: 4095, 0x39: 65535,
}, [0x30, 0x35, 0x36, 0x39], [1], {"-calibrated": "-1 0 1 0 0.5 0", "-misread": "1 0 0 0 1"})
write("tablet", "Gopura test tablet", 6, [0x110, 0x111, 0x112], {0: 32767, 1: 32767}, [], [])
