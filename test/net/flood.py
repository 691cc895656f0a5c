#!/usr/bin/python3
"""A flood of garbage: flood.py SEED RATE SECONDS HOST PORT...: so many datagrams a second to each of the ports.

A third is random bytes, a third has a header as on the public channel, a third one as on a private channel, which the
receiver must try to decrypt before it knows better. Prints how many it has sent.
"""

import random
import socket
import struct
import sys
import time

PERIOD_S = 0.002


def garbage(rng: random.Random) -> bytes:
    """One datagram that is none of ours."""
    size = rng.randrange(0, 300)
    noise = bytes(rng.randrange(256) for _ in range(size))
    kind = rng.randrange(3)
    if kind == 0:
        return noise
    if kind == 1:
        return struct.pack(">BBHI", 2, 0, 0, 4 + size) + struct.pack(">HH", 6666, rng.choice((10, 20, 30, 40))) + noise
    noise = (noise + bytes(rng.randrange(256) for _ in range(32)))[: 16 * (2 + size // 16)]
    return struct.pack(">BBHI", 2, rng.choice((2, 4)), 0, len(noise)) + noise


def main() -> None:
    """Flood."""
    seed, rate, seconds = int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
    host, ports = sys.argv[4], [int(port) for port in sys.argv[5:]]
    rng = random.Random(seed)
    stock = [garbage(rng) for _ in range(1000)]
    began = time.monotonic()
    sent = lost = 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        while True:
            elapsed = time.monotonic() - began
            if elapsed >= seconds:
                break
            for number in range(sent, int(elapsed * rate)):
                for port in ports:
                    try:
                        out.sendto(stock[number % len(stock)], (host, port))
                    except OSError:
                        lost += 1
                sent = number + 1
            time.sleep(PERIOD_S)
    print(f"sent {sent} to each of {len(ports)} ports in {elapsed:.1f} s, {lost} not taken by the system", flush=True)


if __name__ == "__main__":
    main()
