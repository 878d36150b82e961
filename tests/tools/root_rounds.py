"""A kiosk at the fetcher's socket that has root 1 and follows "root 2\\n" and "root 3\\n", and nothing else.

    root_rounds.py SOCKET MODE_FILE

Waits for eight rounds of whatever the server answers now, then has it be good (hostile_server.py),
and ends well when both roots have come, in this order."""
import os
import socket
import struct
import sys
import time

ASK_META, TRUST, META, META_ROOT, META_RELEASE = 5, 7, 66, 0, 1
ROUNDS = 8

kiosk = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
kiosk.settimeout(60)
kiosk.connect(sys.argv[1])
version, rounds, refused = 1, 0, 0
kiosk.send(struct.pack("<BI", TRUST, version))
kiosk.send(struct.pack("<BI", ASK_META, 0))
until = time.monotonic() + 110
while version < 3 and time.monotonic() < until:
    packet = kiosk.recv(1 << 20)
    if not packet:
        sys.exit("the fetcher hung up")
    if packet[0] != META:
        continue
    role, _, number = struct.unpack("<BBI", packet[1:7])
    if role == META_RELEASE:
        rounds += 1
        if rounds == ROUNDS:
            with open(sys.argv[2] + ".new", "w") as file:
                file.write("good\n")
            os.rename(sys.argv[2] + ".new", sys.argv[2])
    if role == META_ROOT:
        if number == version + 1 and packet[7:] == b"root %d\n" % number:
            version = number
        else:
            refused += 1
        kiosk.send(struct.pack("<BI", TRUST, version))
print(f"{rounds} rounds of a portal, {refused} pages refused, root {version}")
sys.exit(version < 3 or refused < ROUNDS)
