"""Latency of events from a writer to a reader in another process, and how many arrive: python -m tides.ros2_bench

Packets of 1 ms are sent in real time, at a few rates of events, over the loopback interface. Latency is from before a packet is
encoded until it has been read; both processes have this machine's clock. `tides bench live` has these rows in its table."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from . import ros2_messages as messages
from .ros2 import Bus

DOMAIN, PACKET_S, PACKETS = 78, 1e-3, 1000
RATES = (1e5, 1e6, 5e6)  # [events/s]
TOPIC = "bench/events"
LONGEST_S = 60.0  # how long a listener is waited for, and waits for a packet


def listen() -> None:
    """Reads until a packet of height 0; prints latencies [s] and the number of bytes."""
    bus = Bus(DOMAIN, loopback=True)
    reader, latencies, size = bus.reader(TOPIC, messages.EventPacket, 1000), [], 0
    until = time.monotonic() + LONGEST_S
    while time.monotonic() < until:
        for one in reader.take(100):
            now = time.time_ns()
            if not hasattr(one, "time_base"):
                continue
            if one.height == 0:
                return print(json.dumps([latencies, size]))
            until = time.monotonic() + LONGEST_S
            latencies.append(1e-9 * (now - one.time_base))  # EVT 3 doesn't use this field, which has the time of sending [ns]
            size += len(one.events)
        time.sleep(1e-4)


def _send(writer: Any, rate: float, packets: int) -> float:
    """Sends packets of random events in real time. Returns how long it took [s]."""
    random, count = np.random.default_rng(1), int(rate * PACKET_S)
    t = np.sort(random.integers(0, int(1e9 * PACKET_S), count))
    x, y = random.integers(0, 640, count).astype("u2"), random.integers(0, 480, count).astype("u2")
    p = random.choice(np.array([-1, 1], "i1"), count)
    begun = time.monotonic()
    for index in range(packets):
        time.sleep(max(0.0, begun + index * PACKET_S - time.monotonic()))
        now = time.time_ns()
        words = messages.evt3(t + index * 1_000_000, x, y, p)
        writer.write(messages.EventPacket(messages.header(now, "bench"), 480, 640, index, now, "evt3", False, words))
    return time.monotonic() - begun


def measure(rate: float, packets: int = PACKETS) -> dict[str, Any]:
    """Sends `packets` packets at a `rate` [events/s]. `ms` of the result are sorted latencies; `first_ms` is that of the first packet."""
    listener = subprocess.Popen([sys.executable, "-m", "tides.ros2_bench", "listen"], stdout=subprocess.PIPE, text=True)
    try:
        bus = Bus(DOMAIN, loopback=True)  # kept as long as its writer: its end ends the writer
        writer, until = bus.writer(TOPIC, messages.EventPacket, 1000), time.monotonic() + LONGEST_S
        while not writer.get_matched_subscriptions():
            if time.monotonic() > until or listener.poll() is not None:
                raise RuntimeError("no listener is found over the loopback interface")
            time.sleep(0.01)
        seconds = _send(writer, rate, packets)
        writer.write(messages.EventPacket(messages.header(0, ""), 0, 0, 0, 0, "", False, b""))
        heard = listener.communicate(timeout=LONGEST_S)[0]
        if not heard:
            raise RuntimeError("the listener ended before the packets did")
        latencies, size = json.loads(heard)
    finally:
        listener.kill()
        listener.wait()
    ms, events = [1e3 * one for one in latencies], int(rate * PACKET_S) * packets
    return {
        "rate": rate, "packets": packets, "lost": packets - len(ms), "events": events, "seconds": seconds, "first_ms": ms[0] if ms else None,
        "bytes_per_event": size / max(1, len(ms) * int(rate * PACKET_S)), "ms": sorted(ms),
    }  # fmt: skip


def main() -> None:
    made = argparse.ArgumentParser("python -m tides.ros2_bench", description="Latency and rate of events on ROS 2's topics.")
    made.add_argument("--packets", type=int, default=PACKETS, metavar="N", help=f"of a millisecond each, at each rate ({PACKETS})")
    made.add_argument("--json", metavar="FILE", help="write the rows there, instead of printing a table")
    given = made.parse_args()
    if given.packets < 1:
        made.error(f"--packets {given.packets}: a number above 0 is needed")
    try:
        rows = [measure(rate, given.packets) for rate in RATES]
    except (RuntimeError, OSError, ValueError, subprocess.TimeoutExpired) as error:
        sys.exit(f"tides.ros2_bench: {error}")
    if given.json:
        Path(given.json).write_text(json.dumps(rows))
        return
    print(f"{'events/s':>10} {'sent/s':>10} {'lost':>12} {'median ms':>10} {'p95 ms':>8} {'worst ms':>9}")
    for row in rows:
        median, most, worst = np.quantile(row["ms"], (0.5, 0.95, 1)) if row["ms"] else (np.nan,) * 3
        lost = f"{row['lost']} of {row['packets']}"
        print(f"{row['rate']:10.3g} {row['events'] / row['seconds']:10.3g} {lost:>12} {median:10.3g} {most:8.3g} {worst:9.3g}")


if __name__ == "__main__":
    listen() if sys.argv[1:] == ["listen"] else main()
