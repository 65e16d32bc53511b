"""Serves page.html on this machine only, and drives a World as one page asks.

Access: only a page served here (by its Origin and Host) that knows the token. The token is in the fragment of the address,
which browsers send in no request and show to no other page. There is one page at a time; the run ends when it is closed."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import hmac
import json
import math
import re
import secrets
import struct
import time
from concurrent.futures import ThreadPoolExecutor
from http import HTTPStatus
from pathlib import Path
from typing import Any

import numpy as np

try:
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.datastructures import Headers
    from websockets.exceptions import ConnectionClosed
    from websockets.http11 import Request, Response
except ImportError as missing:
    raise ImportError("tides.play needs the websockets package: pip install tides[play]") from missing

from ..errors import TidesError
from .flight import Controls
from .world import World

PAGE = Path(__file__).with_name("page.html")
HOST = "127.0.0.1"
GRACE_S = 3.0  # time in which a page may be reloaded
TOKEN_S = 5.0  # time in which a page must send its token
EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("p", "u1"), ("late", "u1")])  # late: time within the picture, 0 to 255
LONGEST_MESSAGE = 4096  # [bytes] of the page's messages


def page_headers(page: str) -> list[tuple[str, str]]:
    """Headers: only the page's own script and style may run, and they may connect to this server alone."""

    def hashes(tag: str) -> str:
        found = re.findall(rf"<{tag}>(.*?)</{tag}>", page, re.S)
        return " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(one.encode()).digest()).decode()}'" for one in found)

    policy = f"default-src 'none'; script-src {hashes('script')}; style-src {hashes('style')}; connect-src 'self'; img-src data:"
    return [
        ("Content-Type", "text/html; charset=utf-8"),
        ("Content-Security-Policy", f"{policy}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"),
        ("Cache-Control", "no-store"),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
    ]


def packed(facts: dict[str, Any], picture: np.ndarray, events: np.ndarray, start: float, length: float) -> bytes:
    """One message: the length of a JSON text, the text, RGB pixels, and the events."""
    rows = np.empty(len(events), EVENT)
    rows["x"], rows["y"], rows["p"] = events["x"], events["y"], events["p"] > 0
    rows["late"] = np.clip((1e-9 * events["t"] - start) / length * 255, 0, 255)
    text = json.dumps(facts).encode()
    text += b" " * (-(4 + len(text) + picture.size) % 2)  # an array of 16-bit numbers must begin at an even byte
    return struct.pack("<I", len(text)) + text + picture.tobytes() + rows.tobytes()


def controls_of(message: dict[str, Any]) -> Controls:
    """Controls from a page's JSON, of which only valid numbers are used."""

    def numbers(name: str, count: int, most: float) -> tuple[float, ...]:
        given = message.get(name, [0] * count)
        fine = isinstance(given, list) and len(given) == count and all(isinstance(one, (int, float)) for one in given)
        if not fine or any(math.isnan(one) for one in given):
            raise ValueError(f"{name}: {count} numbers are needed")
        return tuple(float(np.clip(one, -most, most)) for one in given)

    return Controls(
        numbers("move", 3, 1), numbers("turn", 3, 1), numbers("look", 2, 10), bool(message.get("fast")), bool(message.get("orbit"))
    )


class Server:
    """Serves one World. `url` has the token; `run` returns when the page is closed."""

    def __init__(self, world: World, port: int = 0):
        self.world, self.token = world, secrets.token_urlsafe(24)
        self._wanted, self._page = port, PAGE.read_text()
        self._controls, self._requests = Controls(), []  # type: tuple[Controls, list[dict[str, Any]]]
        self._driver: ServerConnection | None = None
        self._left, self._ended = asyncio.Event(), asyncio.Event()
        self._worker = ThreadPoolExecutor(1)  # the engine's single thread
        self.port = 0
        self.kept: dict[str, Any] | None = None  # facts of a recording that the end of the run ended

    @property
    def origins(self) -> list[str]:
        return [f"http://{HOST}:{self.port}", f"http://localhost:{self.port}"]

    @property
    def url(self) -> str:
        return f"{self.origins[0]}/#{self.token}"

    async def run(self, ready: Any = None, alone_s: float | None = None) -> None:
        """Serves until the page is closed, or until no page has come within `alone_s`. Calls `ready` with the address."""
        try:
            async with serve(
                self._handle, HOST, self._wanted, process_request=self._request, max_size=LONGEST_MESSAGE, compression=None,
                server_header=None,
            ) as server:  # fmt: skip
                self.port = next(iter(server.sockets)).getsockname()[1]
                if ready:
                    ready(self.url)
                if alone_s is not None:
                    asyncio.get_running_loop().call_later(alone_s, lambda: self._driver or self._ended.set())
                await self._ended.wait()
        finally:  # also on Ctrl-C; waits for the step in progress, so that a recording has its events
            self.kept = await self._call(self.world.close)
            self._worker.shutdown()

    async def _call(self, function: Any, *arguments: Any) -> Any:
        return await asyncio.get_running_loop().run_in_executor(self._worker, function, *arguments)

    # -- requests ---------------------------------------------------------------------------------------------------
    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answers a request: the page, or None for a WebSocket that may be opened."""
        hosts = [origin.removeprefix("http://") for origin in self.origins]
        if request.headers.get_all("Host") not in [[host] for host in hosts]:
            return _answer(HTTPStatus.MISDIRECTED_REQUEST, "this is a window of TIDES on another machine's screen\n")
        if request.path == "/live":
            if request.headers.get_all("Origin") not in [[origin] for origin in self.origins]:
                return _answer(HTTPStatus.FORBIDDEN, "a page of another origin\n")
            return None
        if request.path == "/":
            return _answer(HTTPStatus.OK, self._page, page_headers(self._page))
        return _answer(HTTPStatus.NOT_FOUND, "not here\n")

    async def _handle(self, socket: ServerConnection) -> None:
        try:
            said = await asyncio.wait_for(socket.recv(), TOKEN_S)
            if not (isinstance(said, str) and hmac.compare_digest(said.encode(), self.token.encode())):
                return await socket.close(4403, "not the token of this run")
            if self._driver:
                return await socket.close(4409, "another page flies here")
        except (asyncio.TimeoutError, ConnectionClosed):
            return
        self._driver = socket
        self._controls, self._requests = Controls(), []
        flying = asyncio.ensure_future(self._fly(socket))
        try:
            async for text in socket:
                self._hear(text)
        except ConnectionClosed:
            pass
        finally:
            flying.cancel()
            await asyncio.gather(flying, return_exceptions=True)
            self._driver = None
            asyncio.get_running_loop().call_later(GRACE_S, lambda: self._driver or self._ended.set())

    def _hear(self, text: str | bytes) -> None:
        before = self._controls.look
        try:
            message = json.loads(text)
            if not isinstance(message, dict):
                raise ValueError("an object is needed")
            if "do" in message:
                self._requests.append(message)
                return
            self._controls = controls_of(message)
        except ValueError:
            self._requests.append({"do": str(text)[:80]})  # an unknown request is refused with a message
            return
        self._controls.look = tuple(a + b for a, b in zip(before, self._controls.look))

    # -- pictures ---------------------------------------------------------------------------------------------------
    async def _fly(self, socket: ServerConnection) -> None:
        """Sends picture after picture, at the world's rate or as fast as possible."""
        lens = self.world.intrinsics
        hello = {"width": lens.width, "height": lens.height, "name": self.world.name, "presets": self.world.presets}
        try:
            await socket.send(json.dumps({"hello": hello, "says": self.world.says()}))
            due = time.monotonic()
            while True:
                for request in self._take_requests():
                    await socket.send(json.dumps(await self._call(self._do, request)))
                controls, self._controls = self._controls, _without_look(self._controls)
                await socket.send(await self._call(self._picture, controls))
                due = max(due + 1 / self.world.rate, time.monotonic())
                await asyncio.sleep(due - time.monotonic())
        except ConnectionClosed:
            pass
        except (TidesError, ValueError, OSError) as error:
            await socket.send(json.dumps({"ended": str(error)}))
            await socket.close(4500, "the run ended")

    def _take_requests(self) -> list[dict[str, Any]]:
        taken, self._requests = self._requests, []
        return taken

    def _do(self, request: dict[str, Any]) -> dict[str, Any]:
        """Does what a button or a slider asks for; the page shows a refusal."""
        world = self.world
        try:
            if request["do"] == "change":
                world.change(**{name: request[name] for name in ("threshold", "preset", "speed") if name in request})
            elif request["do"] == "record":
                world.record()
            elif request["do"] == "keep":
                return {"kept": world.keep()}
            else:
                raise ValueError(f"do: {request['do']!r} is nothing that can be done")
        except (TidesError, ValueError, OSError) as error:
            return {"refused": str(error), "says": world.says()}
        return {"says": world.says()}

    def _picture(self, controls: Controls) -> bytes:
        world, begun = self.world, time.monotonic()
        events = world.step(controls)
        stepped = time.monotonic()
        picture = world.picture()
        length = world.speed / world.rate
        facts = {
            "time": world.live.time,
            "length": length,
            "events": len(events),
            "recording": world.recording,
            "held": world.recording and world.at_end,
            "position": [round(float(one), 4) for one in world.flight.position],
            "ms": [round(1e3 * (stepped - begun), 1), round(1e3 * (time.monotonic() - stepped), 1)],
        }
        return packed(facts, picture, events, world.live.time - length, length)


def _without_look(controls: Controls) -> Controls:
    return Controls(controls.move, controls.turn, (0.0, 0.0), controls.fast, controls.orbit)


def _answer(status: HTTPStatus, text: str, headers: list[tuple[str, str]] | None = None) -> Response:
    body = text.encode()
    given = headers or [("Content-Type", "text/plain; charset=utf-8")]
    return Response(status.value, status.phrase, Headers([*given, ("Content-Length", str(len(body))), ("Connection", "close")]), body)
