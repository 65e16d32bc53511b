"""The window to fly in: its flight, the runs behind it, who may drive it, and the page in headless Chromium, which is skipped
without one. TIDES_PAGE_PICTURES=FOLDER takes the guide's picture anew: `-k picture` is that alone."""

import asyncio
import json
import os
import re
import shlex
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest
import tides

sys.path.append(str(Path(__file__).parents[1] / "python" / "package"))
from chromium import Chromium, found  # noqa: E402

from tides.play import Controls, Flight, World, event_hash  # noqa: E402

client = pytest.importorskip("websockets.asyncio.client", reason="pip install tides[play]")
from tides.play import server  # noqa: E402
from websockets.exceptions import ConnectionClosed, InvalidStatus  # noqa: E402

browser = pytest.mark.skipif(not found(), reason="no Chromium: apt-get install chromium, or set TIDES_CHROMIUM")
SIZE = (64, 48)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """Coloured Gaussians about the origin."""
    random, folder = np.random.default_rng(8), tmp_path_factory.mktemp("scene")
    made = tides.Scene()
    points = random.normal(size=(400, 3)) * [1, 0.6, 1]
    made.add(tides.Gaussians.from_colours(points, 0.08, random.uniform(0, 1, (400, 3))), name="cloud")
    made.save(folder / "cloud.h5")
    return folder / "cloud.h5"


def again(kept):
    """The hash that a recording's lines say, run as a reader would run them."""
    folder = Path(kept["folder"])
    assert sorted(one.name for one in folder.iterdir()) == ["events.h5", "path.json", "run.json"]
    make, say = (shlex.split(line) for line in kept["lines"])
    assert make[:2] == ["tides", "simulate"] and say[:3] == ["python", "-m", "tides.play"]
    subprocess.run([os.environ["TIDES"], *make[1:], "-q"], check=True, cwd="/")
    return subprocess.run([sys.executable, *say[1:]], check=True, cwd="/", capture_output=True, text=True).stdout.strip()


# -- flight ---------------------------------------------------------------------------------------------------------------


def level():
    """At the origin, looking along z."""
    return tides.Pose(np.eye(3), np.zeros(3), np.zeros((3, 3)), np.zeros(3))


@pytest.mark.parametrize(
    "asked, axis, sign",
    [({"move": (1, 0, 0)}, 0, 1), ({"move": (0, -1, 0)}, 1, -1), ({"move": (0, 0, 1)}, 2, 1)],
)
def test_keys_move_along_the_camera(asked, axis, sign):
    flight = Flight(level(), (0, 0, 4), (0, -1, 0), 2.0, 1.0)
    for _ in range(200):
        flight.step(Controls(**asked, orbit=False), 0.05, 0.1)
    assert flight.position[axis] * sign == pytest.approx(20, rel=0.02) and flight.velocity[axis] == pytest.approx(2 * sign)
    assert np.count_nonzero(np.abs(flight.position) > 1e-9) == 1


@pytest.mark.parametrize(
    "asked, seen",
    [
        ({"turn": (1, 0, 0)}, (0, 1)),  # to the right: what is looked at lies at +x
        ({"turn": (0, 1, 0)}, (1, 1)),  # down: at +y
        ({"look": (0.1, 0)}, (0, 1)),
        ({"look": (0, 0.1)}, (1, 1)),
    ],
)
def test_looking_about(asked, seen):
    flight = Flight(level(), (0, 0, 4), (0, -1, 0), 2.0, 1.0)
    flight.step(Controls(**asked, orbit=False), 0.05, 0.1)
    forward = flight.rotation[:, 2]
    assert forward[seen[0]] * seen[1] > 1e-3 and forward[1 - seen[0]] == pytest.approx(0, abs=1e-12)
    assert np.allclose(flight.rotation @ flight.rotation.T, np.eye(3), atol=1e-12)


def test_it_doesnt_tip_over():
    flight = Flight(level(), (0, 0, 4), (0, -1, 0), 2.0, 1.0)
    for way in (1, -1):
        for _ in range(400):
            flight.step(Controls(turn=(0, way, 0), orbit=False), 0.05, 0.1)
        assert 0.9 < -way * flight.rotation[:, 2] @ flight.up < 0.9999 and flight.rotation[1, 1] > 0


def test_a_circle_comes_back_and_its_rates_are_those_of_the_path():
    flight = Flight(level(), (0, 0, 4), (0, -1, 0), 2.0, 2 * np.pi / 12)
    before = flight.position.copy()
    flight.step(Controls(), 1e-4, 0.1)
    there, rate = flight.position.copy(), flight.velocity.copy()
    flight.step(Controls(), 1e-4, 0.1)
    assert rate == pytest.approx((flight.position - before) / 2e-4, abs=1e-6)
    for _ in range(1200):
        flight.step(Controls(), (12 - 2e-4) / 1200, 0.1)
    assert flight.position == pytest.approx(before, abs=1e-8) and not np.allclose(there, before)


def test_told_rates_fit_what_is_told():
    """Positions and velocities of a wild flight agree: the path between two poses is nearly straight."""
    random, flight = np.random.default_rng(4), Flight(level(), (0, 0, 4), (0, -1, 0), 2.0, 1.0)
    for _ in range(500):
        p0, q0, v0, w0 = (np.array(one) for one in flight.pose())
        p1, q1, v1, w1 = flight.step(Controls(random.uniform(-1, 1, 3), random.uniform(-1, 1, 3), orbit=False), 0.02, 0.1)
        assert (p1 - p0) == pytest.approx(0.01 * (v0 + v1), abs=1e-12)
        turned = 2 * np.arccos(min(1, abs(q0 @ q1)))
        assert turned == pytest.approx(np.linalg.norm(0.01 * (w0 + w1)), abs=1e-6)


# -- the run behind it ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("preset, threshold, speed", [("davis240", 1, 1), ("dvs128", 0.5, 0.1), ("imx636", 0.4, 0.04)])
def test_a_recording_is_the_run_that_it_says(scene, tmp_path, preset, threshold, speed):
    random = np.random.default_rng(5)
    world = World(scene, size=SIZE, out=tmp_path)
    world.step(Controls())
    world.change(preset=preset, threshold=threshold, speed=speed)
    world.step(Controls(move=(1, 0, 0)))
    world.record()
    seen = []
    for k in range(12):
        controls = Controls() if k < 3 else Controls(random.uniform(-1, 1, 3), random.uniform(-1, 1, 3), orbit=False)
        seen.append(world.step(controls))
        assert world.picture().shape == (SIZE[1], SIZE[0], 3)
    with pytest.raises(ValueError, match="stop it first"):
        world.change(speed=0.5)
    kept = world.keep()
    assert kept["events"] >= sum(map(len, seen)) > 50 and kept["seconds"] == pytest.approx(12 * speed / 15)
    assert event_hash(Path(kept["folder"]) / "events.h5") == kept["hash"] == again(kept)
    world.step(Controls())
    world.close()


def test_a_run_file_flies_too_and_is_kept_whole(scene, tmp_path):
    """Its keys, and its paths, which are relative to it; a scene that moves begins again where it ends."""
    moving = tides.Scene()
    path = tides.Trajectory([0.0, 0.5, 1.0], [(0, 0, 0), (0.5, 0, 0), (0, 0, 0)], [(1, 0, 0, 0)] * 3)
    moving.add(tides.Scene(scene)[0].gaussians, path, name="swings")
    (tmp_path / "a").mkdir()
    moving.save(tmp_path / "a" / "moving.h5")
    (tmp_path / "a" / "run.json").write_text(
        json.dumps({"scene": {"file": "moving.h5", "background": [0.1, 0.2, 0.3]}, "camera": {"orbit_s": 5, "width": 40, "height": 30},
                    "time": {"start": 0.9, "stop": 1}, "sensor": {"threshold_on": 0.1}, "seed": 7})
    )  # fmt: skip
    world = World(tmp_path / "a" / "run.json", {"sensor.threshold_off": 0.15}, out=tmp_path)
    assert world.preset == "ideal" and (world.intrinsics.width, world.intrinsics.height) == (40, 30)
    world.record()
    world.step(Controls())
    kept = world.keep()
    assert kept["hash"] == again(kept) and kept["events"] > 10
    run = tides.Run(Path(kept["folder"]) / "run.json")
    assert run.seed == "7" and run.sensor.threshold_off == 0.15 and run.sensor.threshold_on == 0.1
    assert run.start == 0.9 and run.stop == pytest.approx(0.9 + 1 / 15)
    for _ in range(3):  # its motion is over after 0.1 s
        world.step(Controls())
        assert world.live.time == pytest.approx(0.9 + 1 / 15)
    world.close()


def test_refusals(scene, tmp_path):
    world = World(scene, size=SIZE, out=tmp_path)
    for wrong, words in [
        ({"preset": "no"}, "none of"), ({"speed": 0}, "speed"), ({"speed": 2}, "speed"), ({"threshold": float("nan")}, "threshold"),
        ({"threshold": "1"}, "threshold"),
    ]:  # fmt: skip
        with pytest.raises(ValueError, match=words):
            world.change(**wrong)
    with pytest.raises(ValueError, match="nothing is recorded"):
        world.keep()
    world.close()
    (tmp_path / "list.json").write_text("[1]")
    (tmp_path / "broken.json").write_text("{")
    short = tides.Scene()
    short.add(tides.Scene(scene)[0].gaussians, tides.Trajectory([0.0, 0.03], [(0, 0, 0), (0.1, 0, 0)], [(1, 0, 0, 0)] * 2))
    short.save(tmp_path / "short.h5")
    taken = socket.create_server(("127.0.0.1", 0))
    for arguments, words in [
        ([], "a scene or a run file is needed"), ([scene, "--size", "9"], "WxH"), ([scene, "--rate", "0"], "above 0"),
        ([tmp_path / "list.json"], "list.json: is no run file"), ([tmp_path / "broken.json"], "broken.json: is no run file"),
        ([tmp_path / "short.h5"], "lasts 0.03 s"), ([scene, "--bench", "0"], "--bench 0"), ([scene, "--rate", "inf"], "above 0"),
        ([scene, "--port", "99999"], "0 (any) to 65535"), ([scene, "--size", "8x6", "--port", taken.getsockname()[1]], "in use"),
        ([scene, "--size", "0x6"], "camera.width = 0"), ([scene, "--size", "100000x6"], "camera.width = 100000"),
        ([tmp_path / "none.ply"], "none.ply"), ([scene, "--set", "x"], "KEY=VALUE"), ([scene, "--set", "sensor.nope=1"], "nope"),
    ]:  # fmt: skip
        done = subprocess.run([sys.executable, "-m", "tides.play", *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode != 0 and words in done.stderr and "Traceback" not in done.stderr, done.stderr


def test_pictures_a_second(scene):
    """A row for each way to fly, of numbers above 0."""
    command = [sys.executable, "-m", "tides.play", str(scene), "--size", "32x24", "--bench", "2"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    rows = [line.split() for line in done.stdout.splitlines()[1:]]
    assert [row[0] for row in rows] == ["circling", "ahead", "sideways", "turning"]
    assert all(float(one) > 0 for row in rows for one in row[1:5]) and done.stderr == ""


@pytest.mark.parametrize("end", ["closed", "interrupted"])
def test_a_recording_is_kept_where_the_run_ends(scene, tmp_path, end):
    """The page is closed, or Ctrl-C pressed, while it runs: what was recorded is said, and made again by its lines."""
    command = [sys.executable, "-m", "tides.play", str(scene), "--no-browser", "--out", str(tmp_path / "kept"), "--size", "64x48"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    async def record():
        origin, token = process.stdout.readline().strip().split("/#")
        async with client.connect(f"{origin.replace('http', 'ws')}/live", origin=origin) as socket:
            await socket.send(token)
            await socket.send(json.dumps({"do": "record"}))
            while isinstance(said := await asyncio.wait_for(socket.recv(), 60), str) or b'"recording": true' not in said:
                pass
            for _ in range(5):
                await asyncio.wait_for(socket.recv(), 60)
            if end == "interrupted":
                process.send_signal(signal.SIGINT)
                await asyncio.to_thread(process.wait, 60)

    try:
        asyncio.run(record())
        said, errors = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 0 and errors == ""
    folder = next((tmp_path / "kept").iterdir())
    lines = [line.strip() for line in said.splitlines()[-2:]]
    assert f"are in {folder}" in said and tides.events_summary(folder / "events.h5").count > 50
    assert event_hash(folder / "events.h5") == again({"folder": folder, "lines": lines})


def test_without_the_package_it_says_how_to_have_it(scene):
    program = "import sys; sys.modules['websockets'] = None\nfrom tides.play.__main__ import main\nmain([sys.argv[1]])"
    done = subprocess.run([sys.executable, "-c", program, str(scene)], capture_output=True, text=True)
    assert done.returncode == 1 and "pip install tides[play]" in done.stderr and "Traceback" not in done.stderr


# -- who may drive it -------------------------------------------------------------------------------------------------------


def listening(port):
    """Addresses of this machine that `port` is listened at, as /proc has them."""
    rows = [line.split() for name in ("tcp", "tcp6") for line in Path("/proc/net", name).read_text().splitlines()[1:]]
    return [row[1].split(":")[0] for row in rows if row[3] == "0A" and int(row[1].split(":")[1], 16) == port]


def drive(scene, out, script):
    """Runs `script(server)` beside a server, which must end by itself then."""

    async def both():
        world = World(scene, size=SIZE, out=out)
        one, started = server.Server(world), asyncio.Event()
        serving = asyncio.create_task(one.run(lambda url: started.set()))
        await started.wait()
        try:
            return await script(one)
        finally:
            await asyncio.wait_for(serving, 30)

    return asyncio.run(both())


async def refused(url, origin, code, first=None, headers=None):
    """Whether it is refused: by a status, or by a closing code after `first` was said."""
    try:
        async with client.connect(url, origin=origin, additional_headers=headers) as socket:
            if first is not None:
                await socket.send(first)
            while True:
                await socket.recv()
    except InvalidStatus as error:
        return error.response.status_code == code
    except ConnectionClosed as error:
        return error.rcvd is not None and error.rcvd.code == code


def test_only_its_own_page_with_the_token_drives_it(scene, tmp_path):
    async def script(one):
        live, own = f"ws://127.0.0.1:{one.port}/live", one.origins[0]
        assert listening(one.port) == ["0100007F"]
        assert await refused(live, "http://evil.example", 403, one.token)
        assert await refused(live, "null", 403, one.token)
        assert await refused(live, None, 403, one.token)  # no browser, and no page
        assert await refused(live, f"http://127.0.0.1:{one.port + 1}", 403, one.token)
        assert await refused(live.replace("/live", "/other"), own, 404, one.token)
        assert await refused(live, own, 4403, one.token[:-1])
        assert await refused(live, own, 4403, "")
        assert await refused(live, own, 4403, b"\xff")
        async with client.connect(live, origin=own) as socket:
            await socket.send(one.token)
            assert "hello" in json.loads(await socket.recv())
            assert await refused(live, own, 4409, one.token)
            await socket.send("x" * (server.LONGEST_MESSAGE + 1))
            with pytest.raises(ConnectionClosed):
                while True:
                    await socket.recv()
        async with client.connect(live, origin=own) as socket:  # a page that is loaded anew comes back
            await socket.send(one.token)
            assert "hello" in json.loads(await socket.recv())

    drive(scene, tmp_path, script)


def ask(port, path, host):
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", headers={"Host": host})
    try:
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=10) as answer:
            return answer.status, answer.read().decode(), dict(answer.headers)
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), dict(error.headers)


def test_the_page_holds_no_secret_and_loads_nothing(scene, tmp_path):
    async def script(one):
        def get(path, host):
            return asyncio.get_running_loop().run_in_executor(None, ask, one.port, path, host)

        status, text, headers = await get("/", f"127.0.0.1:{one.port}")
        assert status == 200 and one.token not in text and not re.search(r"""src\s*=|@import|url\(|https?://""", text)
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "frame-ancestors 'none'" in policy and "unsafe" not in policy
        assert (await get("/", f"localhost:{one.port}"))[0] == 200
        assert (await get("/", "evil.example"))[0] == 421  # a name that was made to lead here
        assert (await get("/x", f"127.0.0.1:{one.port}"))[0] == 404
        async with client.connect(f"ws://127.0.0.1:{one.port}/live", origin=one.origins[1]) as socket:
            await socket.send(one.token)
            await socket.recv()

    drive(scene, tmp_path, script)


def test_wrong_messages_are_said_and_change_nothing(scene, tmp_path):
    async def script(one):
        async with client.connect(f"ws://127.0.0.1:{one.port}/live", origin=one.origins[0]) as socket:
            await socket.send(one.token)
            for wrong in ({"do": "x"}, {"do": "change", "speed": 7}, {"do": "keep"}):
                await socket.send(json.dumps(wrong))
                while isinstance(said := await asyncio.wait_for(socket.recv(), 30), bytes) or "refused" not in (said := json.loads(said)):
                    pass
            for wrong in ("[", "3", json.dumps({"move": [1]}), json.dumps({"look": ["a", 2]}), json.dumps({"move": [np.nan, 0, 0]})):
                await socket.send(wrong)
                while isinstance(said := await asyncio.wait_for(socket.recv(), 30), bytes) or "refused" not in json.loads(said):
                    pass
            while isinstance(said := await asyncio.wait_for(socket.recv(), 30), str):
                pass
            assert len(said) > SIZE[0] * SIZE[1] * 3

    drive(scene, tmp_path, script)


# -- the page -----------------------------------------------------------------------------------------------------------------


@browser
def test_the_window_in_a_browser(scene, tmp_path):
    profile = tmp_path / "profile"
    profile.mkdir()
    command = [sys.executable, "-m", "tides.play", str(scene), "--no-browser", "--out", str(tmp_path), "--size", "64x48", "--alone", "120", "--preset", "ideal"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        with Chromium(process.stdout.readline().strip(), profile) as page:
            place = "JSON.stringify(state.facts.position)"

            def later(n=4):
                count = page.do("state.pictures")
                page.wait(f"state.pictures > {count + n}")

            page.wait("window.state && state.pictures > 3")
            circling = page.do(place)
            later()
            assert page.do(place) != circling
            page.key("o", code="KeyO")  # it stands
            page.wait("!state.orbit")
            later(30)
            still = page.do(place)
            later()
            assert page.do(place) == still
            page.wait("document.getElementById('rate').textContent === '0'")  # nothing leaks in an ideal pixel
            red_blue = "(() => { const d = screen.data; let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] > 230 && d[i + 2] < 90 || d[i + 2] > 230 && d[i] < 90; return n; })()"
            quiet = page.do(red_blue)
            page.click("#record")
            page.wait("state.recording")
            page.do("view.focus()")
            page.send("Input.dispatchKeyEvent", type="keyDown", key="d", code="KeyD")
            page.wait("state.facts.events > 20")
            page.wait(f"{red_blue} > {quiet} + 10")
            later()
            page.send("Input.dispatchKeyEvent", type="keyUp", key="d", code="KeyD")
            moved = json.loads(page.do(place))
            assert np.linalg.norm(np.subtract(moved, json.loads(still))) > 0.05
            page.drag(page.place("#view", 0.4, 0.5), page.place("#view", 0.6, 0.5))
            later()
            page.click("#record")
            page.wait("state.kept")
            kept = page.do("state.kept")
            assert page.do("document.getElementById('hash').textContent") == kept["hash"]
            assert page.do("document.getElementById('lines').textContent").split("\n") == kept["lines"]
            for name, value, says in [("speed", "-1", "1/10"), ("threshold", "-1", "0.5")]:
                page.do(f"(e => {{ e.value = {value}; e.dispatchEvent(new Event('change')); }})(document.getElementById('{name}'))")
                page.wait(f"document.getElementById('{name}-said').textContent.includes('{says}')")
            page.do("(e => { e.value = 'dvs128'; e.dispatchEvent(new Event('change')); })(document.getElementById('preset'))")
            page.wait("document.getElementById('rows').textContent.includes('0.099')")  # half of its 0.198
            page.wait("Math.abs(state.facts.length - 1 / 150) < 1e-6")
            later()
            assert page.errors == []
        closed = time.monotonic()
        assert process.wait(30) == 0 and time.monotonic() - closed < 20
    finally:
        process.kill()
        process.wait()
    assert kept["events"] > 50 and kept["hash"] == again(kept)


@browser
def test_a_page_of_another_origin_cant_drive_it(scene, tmp_path):
    """It has the address and even the token, and is in the same browser."""
    profile = tmp_path / "profile"
    profile.mkdir()
    (tmp_path / "other.html").write_text("<!DOCTYPE html><title>other</title>")

    async def script(one):
        def visit():
            with Chromium.open(tmp_path / "other.html", profile) as page:
                page.wait("document.title === 'other'")
                return page.do(
                    f"new Promise(end => {{ const s = new WebSocket('ws://127.0.0.1:{one.port}/live');"
                    f" s.onopen = () => s.send('{one.token}'); s.onmessage = () => end('drove'); s.onclose = c => end('closed ' + c.code); }})"
                )

        said = await asyncio.get_running_loop().run_in_executor(None, visit)
        assert one._driver is None
        async with client.connect(f"ws://127.0.0.1:{one.port}/live", origin=one.origins[0]) as socket:
            await socket.send(one.token)
            await socket.recv()
        return said

    assert drive(scene, tmp_path, script) == "closed 1006"


@browser
@pytest.mark.skipif(not os.environ.get("TIDES_PAGE_PICTURES"), reason="TIDES_PAGE_PICTURES=FOLDER takes docs/play.png there")
def test_the_guides_picture(tmp_path):
    profile = tmp_path / "profile"
    profile.mkdir()
    make = [os.environ["TIDES"], "scene", "fan", "--size", "346x260", "--speed", "0.02", "--duration", "60", "-q", "-o", "fan.h5", "--run", "fan.json"]
    subprocess.run(make, check=True, cwd=tmp_path)
    command = [sys.executable, "-m", "tides.play", str(tmp_path / "fan.json"), "--no-browser", "--out", str(tmp_path), "--alone", "120"]
    process = subprocess.Popen([*command, "--preset", "davis346"], stdout=subprocess.PIPE, text=True, cwd=tmp_path)
    try:
        with Chromium(process.stdout.readline().strip(), profile, limit=300) as page:
            page.send("Emulation.setDeviceMetricsOverride", width=1360, height=940, deviceScaleFactor=1, mobile=False)
            page.wait("window.state && state.pictures > 3")
            for name, value in [("speed", -1), ("fade", -0.4)]:
                for kind in ("input", "change"):
                    page.do(f"(e => {{ e.value = {value}; e.dispatchEvent(new Event('{kind}')); }})(document.getElementById('{name}'))")
            page.click("#record")
            page.wait("state.recording")
            page.do("view.focus()")
            for pictures in (12, 30):  # at rest, where the fan alone gives events; then around it
                page.key("o", code="KeyO")
                count = page.do("state.pictures")
                page.wait(f"state.pictures > {count + pictures}")
            page.picture(Path(os.environ["TIDES_PAGE_PICTURES"]) / "play.png")
            assert page.errors == []
    finally:
        process.kill()
        process.wait()
