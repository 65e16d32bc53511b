"""The page of events: the file's content, and its behaviour in headless Chromium, which is skipped without a browser; errors
in the console fail. TIDES_PAGE_PICTURES=FOLDER keeps pictures of it."""

import base64
import json
import os
import re
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
import tides
from chromium import Chromium, found
from conftest import SIZE

browser = pytest.mark.skipif(not found(), reason="no Chromium: apt-get install chromium, or set TIDES_CHROMIUM")
START = 1_700_000_000_000_000_123  # [ns]: beyond what a script's numbers hold


def random_events(n=300_000, seed=3, start=START, span=2_000_000_000):
    print("seed", seed)
    random = np.random.default_rng(seed)
    events = np.zeros(n, tides.EVENT)
    events["t"] = start + np.cumsum(random.integers(1, 2 * span // max(n, 1), n))
    events["x"], events["y"] = random.integers(0, 300, n), random.integers(0, 200, n)
    events["p"], events["cause"] = random.choice([-1, 1], n), random.integers(0, 4, n)
    return events


def random_truth(n, seed=4):
    random = np.random.default_rng(seed)
    truth = np.zeros(n, tides.EVENT_TRUTH)
    truth["flow_u"], truth["flow_v"] = random.normal(0, 90, (2, n)).astype("f4")
    truth["depth"], truth["instance"] = random.uniform(2, 9, n).astype("f4"), random.integers(-1, 5, n)
    return truth


def unpacked(page):
    """The events of a page, by another reader than the page's: columns t, x, y, p, cause, and of truth."""
    columns = []
    for count, first, text in re.findall(r'class="events" data-count="(\d+)" data-first="(-?\d+)">([^<]*)<', page):
        n, planes = int(count), zlib.decompress(base64.b64decode(text))
        at = 0

        def column(size, kind):
            nonlocal at
            rows = np.frombuffer(planes, "u1", size * n, at).reshape(size, n)
            at += size * n
            return np.ascontiguousarray(rows.T).view(kind).ravel()

        made = {"t": int(first) + np.cumsum(column(4, "<u4").astype(np.int64)), "x": column(2, "<u2"), "y": column(2, "<u2")}
        label = column(1, "u1")
        made |= {"p": 2 * (label & 1).astype("i1") - 1, "cause": label >> 1}
        if at < len(planes):
            made |= {name: column(4, "<f4") for name in ("depth", "flow_u", "flow_v")} | {"instance": column(2, "<u2")}
        assert at == len(planes)
        columns.append(made)
    return {name: np.concatenate([one[name] for one in columns]) for name in columns[0]}


def facts_of(page):
    return json.loads(re.search(r'id="facts">([^<]*)<', page)[1])


# -- the file ---------------------------------------------------------------------------------------------------------------


def test_holds_the_events_to_the_bit(tmp_path):
    events, file = random_events(), tmp_path / "page.html"
    truth = random_truth(len(events))
    report = tides.write_page(file, events, truth, title="</script><b>&", width=320)
    got, facts = unpacked(file.read_text()), facts_of(file.read_text())
    for name in ("t", "x", "y", "p", "cause"):
        assert (got[name] == events[name]).all(), name
    for name in ("depth", "flow_u", "flow_v"):
        assert (got[name] == truth[name]).all(), name
    assert (got["instance"] == np.where(truth["instance"] < 0, 65535, truth["instance"])).all()
    assert facts["title"] == "</script><b>&" and facts["events"] == report.events == len(events)
    assert (facts["width"], facts["height"]) == (report.width, report.height) == (320, 200)
    assert int(facts["start"]) == events["t"][0] and int(facts["stop"]) == report.stop_ns == events["t"][-1] + 1


def test_loads_nothing_and_is_whole(tmp_path):
    tides.write_page(tmp_path / "page.html", random_events(100))
    text = (tmp_path / "page.html").read_text()
    assert not re.search(r"""(src|href)\s*=|@import|url\(|\n@ |https?://""", text)
    assert text.startswith("<!DOCTYPE html>") and text.endswith("</html>\n")


def test_of_a_file_in_any_order(tmp_path):
    """Late events of another's file are put in order, as far as a chunk goes."""
    events = random_events(start=0)
    rows = np.stack([events[name].astype(np.int64) for name in ("t", "x", "y", "p")], 1)
    order = np.argsort(np.arange(len(events)) + np.random.default_rng(5).integers(0, 60_000, len(events)), kind="stable")
    np.savetxt(tmp_path / "late.csv", rows[order], "%d", ",", header="t_ns,x,y,polarity", comments="")
    got = tides.events_summary(tmp_path / "late.csv")
    assert got.disorder > 0 and got.count == len(events)
    tides.write_page(tmp_path / "page.html", tmp_path / "late.csv")
    assert (unpacked((tmp_path / "page.html").read_text())["t"] == events["t"]).all()


def test_stretch_and_end(tmp_path):
    events = random_events(start=0)
    tides.write_events(tmp_path / "e.h5", events, 300, 200)
    whole = dict(start_ns=500_000_000, stop_ns=1_500_000_000)
    kept = events[(events["t"] >= whole["start_ns"]) & (events["t"] < whole["stop_ns"])]
    report = tides.write_page(tmp_path / "page.html", tmp_path / "e.h5", **whole)
    got = unpacked((tmp_path / "page.html").read_text())
    assert (got["t"] == kept["t"]).all() and report.ended == 0 and len(kept) == report.events
    report = tides.write_page(tmp_path / "page.html", tmp_path / "e.h5", most=1000, **whole)
    got = unpacked((tmp_path / "page.html").read_text())
    assert (got["t"] == kept["t"][:1000]).all() and report.ended == 1 and report.stop_ns == kept["t"][999] + 1
    assert facts_of((tmp_path / "page.html").read_text())["ended"] is True
    assert tides.write_page(tmp_path / "page.html", tmp_path / "e.h5", most=len(events)).ended == 0


def test_gaps_beyond_32_bits_and_nothing_at_all(tmp_path):
    events = tides.make_events([0, 4_294_967_295, 4_294_967_296, 2**60], [1, 2, 3, 4], [0, 0, 0, 0], [1, 1, -1, -1])
    tides.write_page(tmp_path / "page.html", events)
    assert (unpacked((tmp_path / "page.html").read_text())["t"] == events["t"]).all()
    report = tides.write_page(tmp_path / "page.html", events[:0])
    assert report.events == 0 and facts_of((tmp_path / "page.html").read_text())["events"] == 0


def test_refusals(tmp_path):
    events = random_events(100)
    with pytest.raises(tides.errors.BadArgument, match="event 1 is before"):
        tides.write_page(tmp_path / "page.html", events[::-1].copy())
    with pytest.raises(tides.errors.BadArgument, match="isn't before stop_ns"):
        tides.write_page(tmp_path / "page.html", events, start_ns=5, stop_ns=5)
    with pytest.raises(ValueError, match="truth"):
        tides.write_page(tmp_path / "page.html", events, random_truth(3))
    with pytest.raises(FileNotFoundError):
        tides.write_page(tmp_path / "page.html", tmp_path / "none.h5")
    assert not list(tmp_path.iterdir())


def test_truth_of_a_recording(tmp_path):
    """Columns of a file are read as h5py reads them, and go into its page."""
    h5py = pytest.importorskip("h5py")
    events, file = random_events(70_000, start=0), tmp_path / "e.h5"
    truth = random_truth(len(events))
    tides.write_events(file, events, 300, 200)
    with pytest.raises(tides.errors.Unsupported, match="sensor.truth"):
        tides.read_truth(file)
    with h5py.File(file, "a") as h5:
        for name in ("flow_u", "flow_v", "depth", "alpha"):
            h5[f"events/{name}"] = truth[name].astype("f4")
        h5["events/instance"] = truth["instance"]
    assert (tides.read_truth(file) == truth).all()
    assert (tides.read_truth(file, 65_530, 20) == truth[65_530:65_550]).all()
    with pytest.raises(tides.errors.BadFile, match="not one number per event"):
        tides.read_truth(file, 69_990, 20)
    assert tides.write_page(tmp_path / "page.html", file).truth == 1
    got = unpacked((tmp_path / "page.html").read_text())
    assert (got["depth"] == truth["depth"]).all() and (got["cause"] == events["cause"]).all()


def test_show(tmp_path):
    shown = tides.show(random_events(50), tmp_path / "page.html")
    assert shown.facts.events == 50 and str(tmp_path) in repr(shown)
    assert "srcdoc=" in shown._repr_html_() and '"UTF' not in shown._repr_html_()
    temporary = tides.show(random_events(50), title="one")
    assert "one" in temporary.path.read_text()
    temporary.path.unlink()


def test_show_leaves_nothing_behind(tmp_path):
    """A page among the temporary files goes when Python ends, also where it was moved away before."""
    code = """
import tides
events = tides.make_events([1000, 2000], [1, 2], [3, 4], [1, 0])
one, two = tides.show(events), tides.show(events)
assert one.path.exists() and two.path.exists()
two.path.unlink()
"""
    environment = {**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": str(Path(tides.__file__).parent.parent)}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)
    assert not list(tmp_path.iterdir())


# -- in a browser -----------------------------------------------------------------------------------------------------------


def picture(page, name):
    folder = os.environ.get("TIDES_PAGE_PICTURES")
    if folder:
        page.picture(Path(folder) / f"{name}.png")


def spiral(n=60_000):
    """Something that looks like something, with every kind of colour."""
    turn = np.linspace(0, 6 * np.pi, n)
    events = np.zeros(n, tides.EVENT)
    events["t"], events["p"] = START + np.linspace(0, 1e9, n).astype(np.int64), np.where(np.arange(n) % 5 < 3, 1, -1)
    spread = np.random.default_rng(1).normal(0, 4, (2, n))
    events["x"] = np.clip(150 + 90 * np.cos(turn) + spread[0], 0, 299)
    events["y"] = np.clip(100 + 60 * np.sin(turn) + spread[1], 0, 199)
    events["cause"] = np.arange(n) % 97 == 0
    truth = np.zeros(n, tides.EVENT_TRUTH)
    truth["flow_u"], truth["flow_v"] = -90 * np.sin(turn), 60 * np.cos(turn)
    truth["depth"], truth["instance"] = 4 + np.cos(turn), np.arange(n) % 3 - 1
    return events, truth


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    events, truth = spiral()
    tides.write_page(folder / "page.html", events, truth, title="spiral", width=300, height=200)
    with Chromium.open(folder / "page.html", folder) as page:
        page.wait("window.page && page.pictures > 0")
        page.events = events
        yield page


@pytest.fixture
def page(opened):
    """With the window that it began with, and without an error so far."""
    opened.do("page.play(false), page.choose('polarity'), page.look('slant'), page.show(0, page.recording.span / 50)")
    yield opened
    assert opened.errors == []


@browser
def test_decodes_what_the_file_holds(page):
    sums = page.do(
        """(() => { const s = {n: 0, x: 0, y: 0, on: 0, cause: 0, t: 0n, depth: 0, u: 0, instance: 0};
        for (const c of page.recording.chunks) for (let i = 0; i < c.count; i++) {
            s.n++; s.x += c.xy[2 * i]; s.y += c.xy[2 * i + 1]; s.on += c.label[i] & 1; s.cause += c.label[i] >> 1;
            s.t += BigInt(c.first + c.t[i]); s.depth += c.depth[i]; s.u += c.u[i]; s.instance += c.instance[i] === 65535; }
        const c = page.recording.chunks, last = c[c.length - 1];
        s.first = String(page.recording.start + BigInt(c[0].first));
        s.last = String(page.recording.start + BigInt(last.first + last.t[last.count - 1]));
        s.t = String(s.t); return s; })()"""
    )
    events, truth = spiral()
    assert sums["n"] == len(events) and int(sums["first"]) == events["t"][0] and int(sums["last"]) == events["t"][-1]
    assert (sums["x"], sums["y"]) == (events["x"].sum(), events["y"].sum())
    assert (sums["on"], sums["cause"]) == ((events["p"] > 0).sum(), events["cause"].sum())
    assert int(sums["t"]) == (events["t"] - events["t"][0]).sum() and sums["instance"] == (truth["instance"] < 0).sum()
    assert sums["depth"] == pytest.approx(truth["depth"].sum()) and abs(sums["u"] - truth["flow_u"].sum()) < 1


@browser
def test_windows_hold_what_lies_in_them(page):
    since = page.events["t"] - START
    for start, stop in ((0, 1), (0, 10**9 + 1), (123_456_789, 223_456_789), (10**9, 10**9 + 1)):
        count = page.do(f"page.recording.window({start}, {stop}).count")
        assert count == ((since >= start) & (since < stop)).sum(), (start, stop)


@browser
def test_frame_shows_the_windows_events(page):
    """ON minus OFF of every pixel, and the count under the pointer."""
    since = page.events["t"] - START
    seen = page.events[since < int(page.do("page.length"))]
    balance = np.zeros((200, 300), int)
    np.add.at(balance, (seen["y"], seen["x"]), seen["p"])
    page.wait("!page.windowChanged")
    assert page.do("Array.from(page.frame.balance)") == balance.ravel().tolist()
    y, x = np.argwhere(balance > 0)[0]
    page.mouse("mouseMoved", page.place("#frame", (x + 0.5) / 300, (y + 0.5) / 200))
    on = ((seen["x"] == x) & (seen["y"] == y) & (seen["p"] > 0)).sum()
    assert page.do("document.getElementById('pixel').textContent").startswith(f"pixel ({x}, {y}): {on} ON")


@browser
def test_cloud_draws_points_of_each_colour(page):
    """Pixels of the cloud's canvas: those of the table's two colours are there, and in shares as in one go."""
    colours = "page.colourings[0].table(page.dark)"
    count = f"""(() => {{ page.show(0, page.recording.span); page.begin(); while (page.phase < page.step) page.share();
        const gl = page.cloud.gl, w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, data = new Uint8Array(4 * w * h);
        gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, data);
        const of = [0, 0, 0], c = {colours};
        for (let i = 0; i < data.length; i += 4) if (data[i + 3]) {{
            const k = [0, 1].find((k) => [0, 1, 2].every((j) => Math.abs(data[i + j] - c[3 * k + j]) < 2));
            of[k ?? 2]++; }}
        return of; }})()"""
    whole = page.do(count)
    assert whole[0] > 500 and whole[1] > 500 and whole[2] == 0
    page.do("page.budget.stepFor = () => 7")
    shares = page.do(count)  # which of two points at one place and depth is seen, the order of drawing decides
    assert page.do("page.step") == 7 and sum(shares) == sum(whole) and abs(shares[0] - whole[0]) < 20
    page.do("delete page.budget.stepFor")


@browser
@pytest.mark.parametrize("name", ["polarity", "cause", "depth", "flow", "instance"])
def test_colours(page, name):
    page.do(f"page.show(0, page.recording.span), page.choose('{name}')")
    page.wait("!page.windowChanged && page.phase >= page.step")
    assert page.do("document.getElementById('legend').textContent.length") > 4
    assert page.do("page.cloud.gl.getError()") == 0
    picture(page, name)


@browser
def test_drag_moves_and_stretches_the_window(page):
    page.do("page.show(4e8, 2e8)")
    page.wait("!page.windowChanged")
    page.drag(page.place("#timeline", 0.5), page.place("#timeline", 0.7))
    start, length = page.do("[page.from, page.length]")
    assert start == pytest.approx(6e8, abs=3e6) and length == 2e8
    page.wait("!page.windowChanged")
    page.drag(page.place("#timeline", 0.8), page.place("#timeline", 0.9))
    start, length = page.do("[page.from, page.length]")
    assert start == pytest.approx(6e8, abs=3e6) and length == pytest.approx(3e8, abs=5e6)
    page.wait("!page.windowChanged")
    page.drag(page.place("#timeline", 0.1), page.place("#timeline", 0.0))
    assert page.do("page.from") == 0


@browser
def test_plays_loops_and_stops(page):
    page.do("page.setSpeed(0.1)")
    page.click("#play")
    page.wait("page.from > 2e7")
    assert page.do("document.getElementById('play').textContent") == "stop"
    page.do("page.show(Infinity, page.length)")
    page.wait("page.from < 5e8")
    page.click("#play")
    assert page.do("page.playing") is False
    page.click("#loop")
    page.do("page.show(Infinity, page.length), page.play(true), page.show(Infinity, page.length)")
    page.wait("!page.playing")
    page.click("#loop")


@browser
def test_turns_zooms_and_moves(page):
    before = page.do("page.eye.state")
    page.drag(page.place("#points", 0.5), page.place("#points", 0.6, 0.4))
    turned = page.do("page.eye.state")
    assert turned[0] != before[0] and turned[1] != before[1] and turned[2:] == before[2:]
    page.mouse("mouseWheel", page.place("#points"), deltaX=0, deltaY=-200)
    page.wait(f"page.eye.distance < {before[2]} - 0.1")
    page.do("document.getElementById('points').focus()")
    page.key("ArrowLeft")
    page.key("-")
    assert page.do("page.eye.state")[0] != turned[0]
    aside = page.do("page.eye.state")[3:]
    page.do("points.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', shiftKey: true, bubbles: true }))")
    assert page.do("page.eye.state")[3:] != aside
    picture(page, "turned")


@browser
def test_pixels_are_told_by_keys(page):
    page.do("document.getElementById('frame').focus()")
    start = page.do("page.tell(10, 20), page.from")
    page.key("ArrowRight")
    page.key("ArrowDown")
    assert page.do("page.pixel") == [11, 21] and page.do("page.from") == start
    assert page.do("document.getElementById('pixel').textContent").startswith("pixel (11, 21): ")
    page.do("document.activeElement.blur()")


@browser
def test_a_first_window_that_holds_something(page):
    """Of a recording that begins long before its first event."""
    page.do("page.kept = page.recording.window.bind(page.recording), 0")
    page.do("page.recording.window = (from, to) => page.kept(Math.max(from, 6e8), Math.max(to, 6e8)), 0")
    first = page.do("page.firstEvent()")
    page.do("delete page.recording.window")
    assert first == pytest.approx(6e8, abs=1e6)


@browser
def test_labels_have_room(page):
    """On a narrow screen no label of the axes lies on another."""
    page.do("page.look('slant'), page.show(0, page.recording.span)")
    page.wait("!page.windowChanged && page.phase >= page.step")
    for width in (1200, 400):
        page.do(f"document.getElementById('cloud').style.width = '{width}px'")
        page.wait(f"document.getElementById('cloud').clientWidth === {width} && page.axes.context.canvas.width === Math.round({width} * devicePixelRatio)")
        apart = page.do(
            "page.axes.taken.every((a, i) => page.axes.taken.every((b, k) => k <= i || "
            "Math.abs(a.x - b.x) >= a.half + b.half || Math.abs(a.y - b.y) >= 16 * devicePixelRatio))"
        )
        assert apart and page.do("page.axes.taken.length") >= 2
    page.do("document.getElementById('cloud').style.width = ''")


@browser
def test_keys(page):
    page.do("document.activeElement.blur()")
    page.do("page.show(0, 1e8)")
    for key, condition in (
        ("ArrowRight", "page.from === 1e8"), ("[", "page.length < 7e7"), ("a", "page.length === page.recording.span"),
        ("c", "page.colouring.name === 'cause'"), ("2", "page.eye.tilt === 0"), ("r", "page.eye.tilt > 0"),
        (".", "page.speed > 0"), ("[", "page.length < page.recording.span"),
        # It plays again and again; of the whole recording, whose end it is at, it would be over before that is looked at.
        (" ", "page.playing"), (" ", "!page.playing"),
        ("l", "!document.getElementById('loop').checked"), ("l", "document.getElementById('loop').checked"),
    ):  # fmt: skip
        page.key(key)
        page.wait(condition)
    page.do("document.querySelector('summary').focus()")  # Space opens it, and plays nothing
    page.key(" ")
    assert not page.do("page.playing")
    page.do("document.activeElement.blur()")
    page.do("page.show(0, 1e8)")
    dark = page.do("page.dark")
    page.key("t")
    page.wait(f"page.dark === {str(not dark).lower()} && !page.windowChanged")
    picture(page, "other_theme")
    page.key("t")


@browser
def test_length_is_typed(page):
    page.do("document.getElementById('length').focus(), document.getElementById('length').select()")
    page.send("Input.insertText", text="2.5 ms")
    page.do("document.getElementById('length').blur()")
    assert page.do("page.length") == 2_500_000


@browser
def test_address_keeps_what_is_looked_at(page, tmp_path):
    page.do("page.choose('depth'), page.look('side'), page.show(3e8, 1e8)")
    page.wait("location.hash.includes('w=300000000,100000000&c=depth')")
    page.do("history.replaceState(null, '', location.hash), page.readHash(), page.paint()")
    assert page.do("[page.from, page.length, page.colouring.name]") == [300000000, 100000000, "depth"]


@browser
def test_small_and_empty_pages(tmp_path):
    tides.write_page(tmp_path / "none.html", random_events(0), width=SIZE[0], height=SIZE[1])
    with Chromium.open(tmp_path / "none.html", tmp_path) as page:
        page.wait("window.page && page.pictures > 0")
        page.do("page.show(0, 1e9), page.play(true)")
        assert page.do("page.recording.count") == 0 and page.errors == []
        tides.write_page(tmp_path / "one.html", random_events(1, start=0), width=SIZE[0], height=SIZE[1])
        page.send("Page.navigate", url=(tmp_path / "one.html").as_uri())
        page.wait("window.page?.recording.count === 1 && page.pictures > 0")
        assert page.errors == []


@browser
@pytest.mark.skipif("TIDES" not in os.environ, reason="TIDES, the tool, isn't set")
def test_page_of_a_comparison(tmp_path):
    """Its tables sort by the head that is clicked, and it leads to pages of the streams."""
    run = Path(__file__).parents[2] / "install/run.json"
    made = [os.environ["TIDES"], "compare", run, "-o", tmp_path / "c", "--methods", "tides,esim,v2e", "--keep", "-q"]
    subprocess.run([*map(str, made), "--set", "time.stop=0.01"], check=True)
    with Chromium.open(tmp_path / "c/index.html", tmp_path) as page:
        page.wait("document.readyState === 'complete'")
        column = "[...document.querySelectorAll('tbody')[0].rows].map((row) => row.cells[1].textContent)"
        page.click("table th:nth-child(2)")
        events = [float(one) for one in page.do(column)]
        assert len(events) == 4 and events == sorted(events)
        page.do("document.querySelector('table th:nth-child(2)').focus()")
        page.key("Enter")
        assert [float(one) for one in page.do(column)] == sorted(events, reverse=True)
        picture(page, "comparison")
        page.click("a[href='esim.html']")
        page.wait("window.page?.pictures > 0")
        assert page.do("page.recording.count") in events
        picture(page, "comparison_esim")
        assert page.errors == []


@browser
def test_notebook_frame(tmp_path):
    """As a notebook shows it: within a frame that has no address of its own."""
    events, _ = spiral(5000)
    shown = tides.show(events, tmp_path / "page.html", most=4000)
    (tmp_path / "notebook.html").write_text(f"<!DOCTYPE html><title>n</title>{shown._repr_html_()}")
    with Chromium.open(tmp_path / "notebook.html", tmp_path) as page:
        page.wait("frames[0]?.page?.pictures > 0")
        assert page.do("frames[0].page.recording.count") == 4000
        page.do("frames[0].page.show(0, 1000)")
        page.wait("!frames[0].page.windowChanged")
        assert "more were too many" in page.do("frames[0].document.getElementById('summary').textContent")
        assert page.errors == []
