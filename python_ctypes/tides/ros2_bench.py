"""Latency of events from a writer to a reader in another process, and how many arrive: python -m tides.ros2_bench

Packets of 1 ms are sent as by a run, at a few rates, over the loopback interface. Latency is from before a packet is
encoded until it has been read; both processes use this machine's clock."""

from __future__ import annotations

import json
import subprocess
import sys
import time

import numpy as np

from . import ros2_messages as messages
from .ros2 import Bus

DOMAIN, PACKET_S, SECONDS = 78, 1e-3, 2.0
RATES = (1e5, 1e6, 5e6)  # [events/s]
TOPIC = "bench/events"


def listen() -> None:
    """Reads until a packet of height 0; prints latencies [s] and the number of bytes."""
    bus = Bus(DOMAIN, loopback=True)
    reader, latencies, size = bus.reader(TOPIC, messages.EventPacket, 1000), [], 0
    until = time.monotonic() + 60
    while time.monotonic() < until:
        for one in reader.take(100):
            now = time.time_ns()
            if not hasattr(one, "time_base"):
                continue
            if one.height == 0:
                return print(json.dumps([latencies, size]))
            latencies.append(1e-9 * (now - one.time_base))  # a field that EVT 3 doesn't use
            size += len(one.events)
        time.sleep(1e-4)


def measure(rate: float) -> dict[str, float]:
    """Measures one rate: packets sent and received, latencies [ms], and the share of time for encoding and writing."""
    random, count = np.random.default_rng(1), int(rate * PACKET_S)
    t = np.sort(random.integers(0, int(1e9 * PACKET_S), count))
    x, y = random.integers(0, 640, count).astype("u2"), random.integers(0, 480, count).astype("u2")
    p = random.choice(np.array([-1, 1], "i1"), count)
    listener = subprocess.Popen([sys.executable, "-m", "tides.ros2_bench", "listen"], stdout=subprocess.PIPE, text=True)
    try:
        bus = Bus(DOMAIN, loopback=True)  # its end deletes its topics and readers
        writer = bus.writer(TOPIC, messages.EventPacket, 1000)
        while not writer.get_matched_subscriptions():
            time.sleep(0.01)
        begun, busy, packets = time.monotonic(), 0.0, int(SECONDS / PACKET_S)
        for index in range(packets):
            time.sleep(max(0.0, begun + index * PACKET_S - time.monotonic()))
            now = time.time_ns()
            words = messages.evt3(t + index * 1_000_000, x, y, p)
            writer.write(messages.EventPacket(messages.header(now, "bench"), 480, 640, index, now, "evt3", False, words))
            busy += 1e-9 * (time.time_ns() - now)
        took = time.monotonic() - begun
        writer.write(messages.EventPacket(messages.header(0, ""), 0, 0, 0, 0, "", False, b""))
        latencies, size = json.loads(listener.communicate(timeout=60)[0])
    finally:
        listener.kill()
        listener.wait()
    half, most = (1e3 * float(np.quantile(latencies, share)) for share in (0.5, 0.95))
    return {
        "asked_per_s": rate, "sent_per_s": packets * count / took, "packets": packets, "heard": len(latencies), "median_ms": half,
        "p95_ms": most, "writer_busy": busy / took, "bytes_per_event": size / max(1, len(latencies) * count),
    }  # fmt: skip


def main() -> None:
    for rate in RATES:
        row = measure(rate)
        print(", ".join(f"{name} {value:.4g}" for name, value in row.items()), flush=True)


if __name__ == "__main__":
    listen() if sys.argv[1:] == ["listen"] else main()
