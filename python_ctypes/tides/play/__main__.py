"""python -m tides.play SCENE: opens the window in a browser, or prints its address."""

from __future__ import annotations

import argparse
import asyncio
import json
import math
import sys
import webbrowser
from typing import Any

from .. import __version__
from ..errors import TidesError
from .world import World, event_hash


def options() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(
        "python -m tides.play", description="Fly through a scene and see its events as they fire, in a page on this machine."
    )
    made.add_argument("scene", nargs="?", help="splats, in any format that tides convert --help lists, or a run file (.json)")
    made.add_argument("--size", metavar="WxH", help="of the image [px] (240x180, or the run file's)")
    made.add_argument("--preset", help="the sensor to begin with (davis240, or the run file's); tides presets lists them")
    made.add_argument("--rate", type=float, default=15, metavar="HZ", help="pictures a second at most (15)")
    made.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of the run file; may be repeated")
    made.add_argument("--out", default=".", metavar="DIR", help="where recordings go, each in a folder of its own (.)")
    made.add_argument("--device", metavar="SPEC", help="auto, cpu, gpu, reference, an index or a name (else TIDES_DEVICE)")
    made.add_argument("--port", type=int, default=0, help="of the page (any that is free)")
    made.add_argument("--no-browser", action="store_true", help="say the page's address, and open nothing")
    made.add_argument("--alone", type=float, metavar="SECONDS", help="end where no page comes within so long (never)")
    made.add_argument("--bench", type=int, metavar="N", help="measure N pictures of each way to fly, without a page, and end")
    made.add_argument("--hash", metavar="EVENTS", help="say the hash of an event file, as a recording shows it, and end")
    made.add_argument("--version", action="version", version=f"tides {__version__}")
    return made


def size_of(text: str) -> tuple[int, int]:
    try:
        width, height = (int(one) for one in text.lower().split("x"))
    except ValueError:
        raise ValueError(f"--size {text}: WxH in pixels is needed, as 240x180") from None
    return width, height


def setting(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"--set {text}: KEY=VALUE is needed")
    try:
        return key, json.loads(value)
    except json.JSONDecodeError:
        return key, value


def ready(url: str, opens: bool) -> None:
    print(f"{url}\nclose the page, or press Ctrl-C, to end", flush=True)
    if opens:
        webbrowser.open(url)


def kept_text(kept: dict[str, Any]) -> str:
    lines = "\n".join(f"    {line}" for line in kept["lines"])
    return f"{kept['events']} events of {kept['seconds']:.3g} s are in {kept['folder']}. To make them again:\n{lines}"


def play(given: argparse.Namespace) -> None:
    from .bench import bench
    from .server import Server  # which needs websockets, as bench does

    if not 0 < given.rate < math.inf:
        raise ValueError(f"--rate {given.rate:g}: a number above 0 is needed")
    if not 0 <= given.port <= 65535:
        raise ValueError(f"--port {given.port}: must be 0 (any) to 65535")
    set = dict(setting(one) for one in given.set)
    size = size_of(given.size) if given.size else None

    def make() -> World:
        return World(given.scene, set, size, given.preset, given.rate, given.out, given.device)

    if given.bench is not None:
        if given.bench < 1:
            raise ValueError(f"--bench {given.bench}: a number of pictures above 0 is needed")
        return bench(make, given.bench)
    world = make()
    server = Server(world, given.port)
    try:
        asyncio.run(server.run(lambda url: ready(url, not given.no_browser), given.alone))
    finally:
        world.close()
        if server.kept:
            print(kept_text(server.kept))


def main(arguments: list[str] | None = None) -> None:
    parser = options()
    given = parser.parse_args(arguments)
    try:
        if given.hash:
            print(event_hash(given.hash))
        elif given.scene:
            play(given)
        else:
            parser.error("a scene or a run file is needed")
    except (TidesError, ValueError, OSError, ImportError) as error:
        sys.exit(f"tides.play: {error}")
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
