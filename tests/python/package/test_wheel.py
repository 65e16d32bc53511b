"""The wheel in a fresh virtual environment, the README's example, the example scripts, the first use of OpenCL."""

import json
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import tides

ROOT = Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "python_ctypes" / "examples"


def outside(**more):
    """An environment that knows nothing of this tree; OpenCL where there is a device: the reference is slow."""
    kept = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "TIDES_LIBRARY", "TIDES_DEVICE")
    }
    return {**kept, "TIDES_DEVICE": "auto" if tides.devices() else "reference", **more}


def run(*command, **more):
    done = subprocess.run(command, capture_output=True, text=True, **more)
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


def source_files():
    return {path for path in (ROOT / "python_ctypes").rglob("*") if "__pycache__" not in path.parts}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    pytest.importorskip("pip")
    pytest.importorskip("wheel")
    folder, before = tmp_path_factory.mktemp("wheel"), source_files()
    pip = [sys.executable, "-m", "pip", "wheel", "--no-build-isolation", "--no-deps", "--no-index", "-w", folder]
    run(*pip, ROOT / "python_ctypes", env=outside(TIDES_LIBRARY=tides.library_path), cwd=folder)
    assert source_files() == before  # nothing is left in the source tree
    (made,) = folder.glob("*.whl")
    return made


def test_wheel_holds_the_package(wheel):
    assert wheel.name == f"tides-{tides.__version__}-py3-none-linux_x86_64.whl"
    with zipfile.ZipFile(wheel) as file:
        names = {name for name in file.namelist() if not name.endswith((".dist-info/", "/"))}
        assert file.read("tides/libtides.so.0") == Path(tides.library_path).read_bytes()
    package = ROOT / "python_ctypes"
    modules = {path.relative_to(package).as_posix() for path in (package / "tides").rglob("*.py")}
    others = {"tides/py.typed", "tides/libtides.so.0", "tides/tides", "tides/play/page.html"}
    assert modules | others == {name for name in names if ".dist-info/" not in name}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """What `make wheel` packs: with all that library and tool link. A name, and the folder that it is unpacked in."""
    pytest.importorskip("wheel")
    folder = tmp_path_factory.mktemp("whole")
    flags = " ".join(word for word in os.environ.get("MAKEFLAGS", "").split() if not word.startswith(("-j", "--job")))
    named = [f"PYTHON={sys.executable}", f"WHEELS={folder}", "CONFIG=" + Path(tides.library_path).resolve().parent.name]
    run("make", "--no-print-directory", "-s", "wheel", *named, cwd=ROOT, env=outside(MAKEFLAGS=flags))
    (made,) = folder.glob("*.whl")
    with zipfile.ZipFile(made) as file:
        file.extractall(folder)
    return made.name, folder


def needed(path):
    return set(re.findall(r"\(NEEDED\) .*\[(.*)\]", run("readelf", "-d", path)))


def test_whole_wheel_needs_the_c_library_alone(whole):
    name, folder = whole
    libraries = {path.name for path in (folder / "tides").glob("lib*.so*")}
    programs = [folder / "tides" / name for name in (*libraries, "tides")]
    outer = set().union(*map(needed, programs)) - libraries
    assert outer <= {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"}
    newest = max(int(minor) for path in programs for minor in re.findall(r"\bGLIBC_2\.(\d+)", run("objdump", "-T", path)))
    assert name == f"tides-{tides.__version__}-py3-none-manylinux_2_{newest}_x86_64.whl"
    tool = folder / "tides" / "tides"
    tool.chmod(0o755)
    found = run("ldd", tool, env={})
    assert all(f"{folder}/tides/{library} " in found for library in libraries)
    assert run(tool, "--version", env={}) == f"tides {tides.__version__}\n"


def test_whole_wheel_labels_pictures_where_there_is_no_font(whole, tmp_path):
    """The same letters from its own font, whatever the system has: a .svg holds them as outlines."""
    _, folder = whole
    tool = folder / "tides" / "tides"
    tool.chmod(0o755)
    (tmp_path / "none.conf").write_text("<fontconfig><dir>/nowhere</dir></fontconfig>")
    run(tool, "scene", "disc", "--size", "32x24", "-o", "disc.h5", "--run", "disc.json", cwd=tmp_path)
    reference = ("--device", "reference", "-q", "--set", "time.stop=0.005")
    run(tool, "simulate", "disc.json", "-o", "events.h5", *reference, cwd=tmp_path)
    said = {}
    for name, fonts in (("none", tmp_path / "none.conf"), ("own", folder / "tides" / "fonts" / "fonts.conf")):
        drawn = subprocess.run(
            [tool, "view", "events.h5", "-o", f"{name}.svg", "-q"],
            env=outside(FONTCONFIG_FILE=str(fonts)),
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        assert drawn.returncode == 0, drawn.stderr
        said[name] = drawn.stderr
    assert "has no font" in said["none"] and said["own"] == ""


def test_whole_wheel_has_pages_and_licences_and_no_paths_of_this_machine(whole):
    _, folder = whole
    data = next(folder.glob("*.data")) / "data" / "share"
    assert (data / "man" / "man1" / "tides-simulate.1").stat().st_size > 1000
    assert (data / "man" / "man5" / "tides-run.5").exists()
    licences = {path.stem: path.read_text() for path in (folder / "tides" / "licences").iterdir()}
    for part in ("tides", "hdf5", "openexr", "png", "cjson", "zstd", "lz4", "webp", "deflate", "zlib", "ocl-icd", "aec", "cairo", "freetype", "dejavu"):
        assert any(part in name and "opyright" in text for name, text in licences.items()), part
    assert re.search(r"^cairo \d", licences["SOURCES"], re.M)
    for path in folder.rglob("*"):
        if path.is_file() and path.suffix != ".whl" and b".gcda" not in path.read_bytes():  # make coverage: where counts go
            assert str(ROOT).encode() not in path.read_bytes(), path
            assert str(Path.home()).encode() + b"/" not in path.read_bytes(), path


LISTED = "import importlib.metadata as m, json; print(json.dumps([d.name for d in m.distributions()]))"


def readme_example():
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
    (example,) = [block for block in blocks if "tides.Scene()" in block]
    return example


@pytest.mark.parametrize("numpy", ["from the system", "from the index"])
def test_fresh_environment_runs_the_readme(wheel, numpy, tmp_path):
    """With the wheel, numpy, and the system's shared libraries alone."""
    venv = tmp_path / "venv"
    seen = ["--system-site-packages"] if numpy == "from the system" else []
    run(sys.executable, "-m", "venv", "--without-pip", *seen, venv)
    python = venv / "bin" / "python"
    install = [sys.executable, "-m", "pip", "--python", python, "install", "--retries", "1", "--timeout", "20"]
    if not seen:
        index = subprocess.run([*install, "numpy"], capture_output=True, text=True, env=outside())
        if "from versions: none" in index.stderr:
            pytest.skip("no package index can be reached")
        assert index.returncode == 0, index.stderr
        assert json.loads(run(python, "-c", LISTED, env=outside())) == ["numpy"]
    run(*install, "--no-index", wheel, env=outside())  # with its dependencies, which are there
    program = readme_example() + "\nprint(tides.library_path, len(events), sorted(frame))\n"
    path, count, names = run(python, "-c", program, env=outside(), cwd=tmp_path).split(maxsplit=2)
    assert path.startswith(str(venv)) and int(count) > 1000 and names.strip() == "['L', 'L_dot']"
    assert (tmp_path / "events.raw").stat().st_size > 1000
    said = f"tides {tides.__version__}\n"
    assert run(venv / "bin" / "tides", "--version", env=outside()) == said
    assert run(python, "-m", "tides", "--version", env=outside(), cwd=tmp_path) == said


def first_block(page):
    """The commands with which a page of the guide begins, but pip's, as a shell runs them. What would wait for a person ends by
    itself, and nothing leaves this machine."""
    block = re.search(r"^```sh\n(.*?)^```", (ROOT / "docs" / "guide" / page).read_text(), re.M | re.S)[1]
    ends = {"tides.play": " --no-browser --alone 2", "tides.ros2": " --loopback", "--poses": " --silence 2"}
    for line in block.splitlines():
        command = re.sub(r"\s+#.*", "", line).replace("python_ctypes/", f"{ROOT}/python_ctypes/")
        if not command.startswith("pip "):
            yield command + "".join(more for word, more in ends.items() if word in command)


@pytest.mark.parametrize(
    "extra, page, program",
    [
        (
            "play",
            "play.md",
            "from tides.play.server import PAGE, page_headers; print('default-src' in str(page_headers(PAGE.read_text())))",
        ),
        ("usd", "usd.md", "import tides.usd; from pxr import UsdVol; print(hasattr(UsdVol, 'ParticleField3DGaussianSplat'))"),
        ("mujoco", "physics.md", "import catch_ball; print(catch_ball.catch()[-1, 0] > 0.8)"),
        ("ros2", "ros2.md", "import tides.ros2; print(len(tides.ros2.messages.evt3(*4 * [tides.ros2.np.ones(1, int)])) == 8)"),
    ],
)
def test_extra_installs_and_runs(wheel, extra, page, program, tmp_path):
    """From the index, into an environment of its own, with all that it depends on; then its page's first commands."""
    venv = tmp_path / "venv"
    run(sys.executable, "-m", "venv", "--without-pip", venv)
    python = venv / "bin" / "python"
    install = [sys.executable, "-m", "pip", "--python", python, "install", "--retries", "1", "--timeout", "20", f"{wheel}[{extra}]"]
    index = subprocess.run([*map(str, install)], capture_output=True, text=True, env=outside())
    if "from versions: none" in index.stderr:
        pytest.skip(f"no package index can be reached: pip install tides[{extra}]")
    assert index.returncode == 0, index.stderr
    assert run(python, "-c", program, env=outside(PYTHONPATH=str(EXAMPLES)), cwd=tmp_path) == "True\n"
    commands = [*first_block(page)]
    assert commands
    path = f"{venv / 'bin'}:{os.environ['PATH']}"
    run("sh", "-euc", "\n".join(commands), env=outside(PATH=path), cwd=tmp_path, timeout=120)


@pytest.mark.parametrize(
    "script, outputs",
    [
        ("simulate_and_plot", ["out.png"]),
        ("training_set", ["out/00000.h5", "out/00000.json", "out/00005.h5"]),
        ("sweep", ["out.csv"]),
        ("optical_flow", ["out.png"]),
        ("dask_batch", ["out/results/summary.csv"]),
    ],
)
def test_example(script, outputs, tmp_path):
    if not tides.devices():
        pytest.skip("no OpenCL device, and the reference takes a minute")
    if script == "dask_batch":
        pytest.importorskip("distributed")
    output = outputs[0].split("/")[0]
    environment = outside(PYTHONPATH=str(ROOT / "python_ctypes"), TIDES_LIBRARY=tides.library_path)
    said = run(sys.executable, EXAMPLES / f"{script}.py", output, env=environment, cwd=tmp_path)
    assert all((tmp_path / name).stat().st_size > 20 for name in outputs)
    if script == "optical_flow":
        assert float(re.search(r"median error of a block: ([\d.]+) %", said)[1]) < 10
    if script == "sweep":
        rows = [line.split(",") for line in (tmp_path / "out.csv").read_text().split()][1:]
        assert float(rows[-1][4]) < float(rows[0][4])  # dt_p95_us falls with the tolerance
    if script == "dask_batch":
        assert said.count(" done ") == 6
    if script == "training_set":
        assert said.count("batch (2, 5, 72, 96)") == 3 or "torch" in said


def test_threads_open_the_first_device_at_once():
    """Loading OpenCL's drivers isn't safe in two threads: the library takes turns there."""
    if not tides.devices():
        pytest.skip("no OpenCL device")
    program = (
        "import threading, tides\n"
        "ready, names = threading.Barrier(8), []\n"
        "def work():\n    ready.wait()\n    names.append(tides.Device('auto').facts.name)\n"
        "threads = [threading.Thread(target=work) for _ in range(8)]\n"
        "[thread.start() for thread in threads]\n[thread.join() for thread in threads]\n"
        "assert len(names) == 8 and len(set(names)) == 1, names\n"
    )
    environment = outside(PYTHONPATH=str(ROOT / "python_ctypes"), TIDES_LIBRARY=tides.library_path)
    for _ in range(3):
        run(sys.executable, "-c", program, env=environment)
