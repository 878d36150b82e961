"""Just enough of QEMU's machine protocol: commands, taps, screendumps."""
import json
import socket
import time


class Qmp:
    def __init__(self, path, seconds=20):
        until = time.monotonic() + seconds
        while True:
            try:
                self.socket = socket.socket(socket.AF_UNIX)
                self.socket.connect(path)
                break
            except OSError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.1)
        self.stream = self.socket.makefile("rw")
        self.stream.readline()  # the greeting
        self.command("qmp_capabilities")

    def command(self, name, **arguments):
        self.stream.write(json.dumps({"execute": name, "arguments": arguments}) + "\n")
        self.stream.flush()
        while True:
            reply = json.loads(self.stream.readline())
            if "error" in reply:
                raise RuntimeError(f"{name}: {reply['error']['desc']}")
            if "return" in reply:
                return reply["return"]

    def tap(self, x, y, hold_s=0.15):
        """x and y in 0..1 of the panel."""
        at = [{"type": "abs", "data": {"axis": axis, "value": int(value * 32767)}} for axis, value in (("x", x), ("y", y))]
        button = lambda down: {"type": "btn", "data": {"button": "left", "down": down}}
        self.command("input-send-event", events=at)
        self.command("input-send-event", events=[button(True)])
        time.sleep(hold_s)
        self.command("input-send-event", events=[button(False)])

    def press(self, *keys):
        """Keys by QEMU's names, held together for a tenth of a second."""
        self.command("send-key", keys=[{"type": "qcode", "data": key} for key in keys])
        time.sleep(0.3)

    def screendump(self, path):
        self.command("screendump", filename=path, format="ppm")
