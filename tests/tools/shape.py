"""shape.py TO [--mbit N] [--rtt-ms N] [--log FILE]: a line between a terminal and the server at localhost:TO.

Prints the port it listens on; TLS passes through untouched. What comes down shares N megabits a second (default 10), all
connections together; each way takes half of the round trip (default 40 ms), a connection a whole one before its first byte.
What the line cannot take waits at the server, but for a router's 50 ms. --log: monotonic seconds, bytes down and
bytes up so far, a line a tenth of a second while anything comes. A signal ends it.
"""
import argparse
import asyncio
import contextlib
import socket
import time

CHUNK_BYTES = 4096
ROUTER_S = 0.05
SOCKET_BYTES = 65536  # of the kernel's own buffers, which would be a longer line


class Line:
    def __init__(self, bits_per_s, one_way_s):
        self.bits_per_s, self.one_way_s = bits_per_s, one_way_s
        self.free_at, self.bytes = 0.0, 0

    async def take(self, size):
        """When these bytes arrive; returns once the router has room for more."""
        now = asyncio.get_running_loop().time()
        self.bytes += size
        if self.bits_per_s:
            self.free_at = max(self.free_at, now) + size * 8 / self.bits_per_s
        else:
            self.free_at = now
        due = self.free_at + self.one_way_s
        await asyncio.sleep(max(0.0, self.free_at - now - ROUTER_S))
        return due


async def carry(reader, writer, line):
    sent = asyncio.Queue()

    async def deliver():
        while True:
            due, data = await sent.get()
            await asyncio.sleep(due - asyncio.get_running_loop().time())
            if not data:
                with contextlib.suppress(OSError):
                    writer.write_eof()
                return
            writer.write(data)
            await writer.drain()

    delivery = asyncio.create_task(deliver())
    try:
        data = b"."
        while data:
            data = await reader.read(CHUNK_BYTES)
            sent.put_nowait((await line.take(len(data)), data))
        await delivery
    except OSError:
        delivery.cancel()
        writer.close()


async def main(options):
    down = Line(options.mbit * 1e6, options.rtt_ms / 2000)
    up = Line(0, options.rtt_ms / 2000)

    async def connect(reader, writer):
        await asyncio.sleep(options.rtt_ms / 1000)
        server = socket.socket()
        server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SOCKET_BYTES)
        server.setblocking(False)
        try:
            await asyncio.get_running_loop().sock_connect(server, ("127.0.0.1", options.to))
        except OSError:
            server.close()
            writer.close()
            return
        server_reader, server_writer = await asyncio.open_connection(sock=server, limit=CHUNK_BYTES)
        await asyncio.gather(carry(reader, server_writer, up), carry(server_reader, writer, down))
        server_writer.close()
        writer.close()

    listener = await asyncio.start_server(connect, "127.0.0.1", 0)
    print(listener.sockets[0].getsockname()[1], flush=True)
    log, said = options.log and open(options.log, "w"), None
    while True:
        await asyncio.sleep(0.1)
        if log and said != (down.bytes, up.bytes):
            said = down.bytes, up.bytes
            print(f"{time.monotonic():.3f} {down.bytes} {up.bytes}", file=log, flush=True)


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("to", type=int)
    arguments.add_argument("--mbit", type=float, default=10)
    arguments.add_argument("--rtt-ms", type=float, default=40)
    arguments.add_argument("--log")
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(main(arguments.parse_args()))
