#!/usr/bin/python3
"""Runs every fenced block of README.md and of the guide as a reader would: in order, in an empty folder for each page, with the
built tides.

usage: check_readme.py [PAGE.md...]    default README.md and docs/guide; README_QUICK=1 leaves out the blocks that are marked slow
environment: TIDES the command line tool, OUT the folder of its library, MAKE, PYTHON, CC

sh blocks run in bash and end at the first command that fails; `make` is the repository's, and `build` and `kernels` are its
folders. Every file that a command names as an output (-o, --run, --stats, --png, >) must be there afterwards. json blocks must
be JSON (with // comments); python blocks run with the package. A comment before a block, which readers don't see, says more:
    <!-- check: file NAME -->           the block is the content of NAME, for the blocks that follow
    <!-- check: without TEXT, WHY -->   lines that begin with TEXT aren't run
    <!-- check: slow -->                left out where README_QUICK is set
    <!-- check: writes A B -->          these too must be there afterwards
    <!-- check: splats NAME -->         NAME is there before, a splat file as readers bring their own
    <!-- check: skip, WHY -->           not run at all
Several are parted by ";". Blocks of no language are text. Paths of the repository that a page names must exist, and every
command of `tides --help` must be in the README.
"""
import glob
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
QUICK = bool(os.environ.get("README_QUICK"))
PYTHON = os.environ.get("PYTHON") or "/usr/bin/python3"
LIMIT_S = 600  # for one block
OUTPUTS = {"-o", "--output", "--run", "--stats", "--png", "--preview"}
# Pages that `make docs` makes, and checks links to.
BUILT = re.compile(r"(files|\w+_8h|python/[\w.]+|man/[\w.-]+)\.html")
FOLDERS = "include|kernels|lib|cli|share|docs|scripts|tests|python_ctypes"


class Failure(Exception):
    """What is wrong with a block, and what its command said."""


class Block:
    def __init__(self, language, text, line, marks):
        self.language, self.text, self.line = language, text, line
        self.marks = dict(self.parse(mark) for mark in marks.split(";") if mark.strip())

    @staticmethod
    def parse(mark):
        word, _, rest = mark.strip().partition(" ")
        if word.rstrip(",") not in ("file", "without", "slow", "writes", "splats", "skip"):
            raise SystemExit(f"unknown mark '{mark.strip()}'")
        return word.rstrip(","), rest

    def __str__(self):
        first = next((line for line in self.text.splitlines() if line.strip()), "")
        return f"line {self.line}: {self.language} {first[:60]}"


def blocks_of(text):
    marks, fence, lines, begun, language = "", None, [], 0, ""
    for number, line in enumerate(text.splitlines(), 1):
        if fence is None and (found := re.match(r"\s*<!-- check: (.*) -->$", line)):
            marks = found[1]
        elif fence is None and (found := re.match(r"(```+)(\w*)", line)):
            fence, language, lines, begun = found[1], found[2], [], number
        elif fence is not None and line.startswith(fence):
            yield Block(language, "\n".join(lines) + "\n", begun, marks)
            fence, marks = None, ""
        elif fence is not None:
            lines.append(line)
        elif line.strip():
            marks = ""


# -- the reader's folder ---------------------------------------------------------------------------------------------------


def write_program(path, text):
    path.write_text("#!/bin/sh\n" + text + "\n")
    path.chmod(0o755)


def environment(work):
    """PATH with tides, a `make` that works in the repository, and a virtual environment for pip; a home of its own."""
    programs, home = work / ".bin", work / ".home"
    programs.mkdir()
    home.mkdir()
    tides = Path(os.environ.get("TIDES") or REPOSITORY / "build/tides").resolve()
    if not os.access(tides, os.X_OK):
        raise SystemExit(f"{tides}: not built; run make")
    (programs / "tides").symlink_to(tides)
    make = shutil.which(os.environ.get("MAKE") or "make")
    write_program(programs / "make", f'exec {make} --no-print-directory -C {shlex.quote(str(REPOSITORY))} "$@"')
    for folder in ("build", "kernels"):
        (work / folder).symlink_to(REPOSITORY / folder)
    subprocess.run([PYTHON, "-m", "venv", "--system-site-packages", work / ".venv"], check=True)
    values = {**os.environ, "HOME": str(home), "PATH": f"{programs}:{work}/.venv/bin:{os.environ['PATH']}"}
    # A make inside a test has no share in the outer make's job server; its variables (CFLAGS=...) stay.
    values["MAKEFLAGS"] = re.sub(r" -j\d*| --jobserver-\S*", "", " " + values.get("MAKEFLAGS", ""))
    values.setdefault("POCL_CACHE_DIR", str(REPOSITORY / "build/pocl-cache"))
    # The package as it lies there, until a block installs the wheel.
    library = REPOSITORY / (os.environ.get("OUT") or "build/release") / "libtides.so"
    values.update(TIDES_LIBRARY=str(library), PYTHONPATH=str(REPOSITORY / "python_ctypes"), PYTHONDONTWRITEBYTECODE="1")
    return values


def run(command, work, values):
    try:
        done = subprocess.run(command, cwd=work, env=values, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=LIMIT_S, check=False)
    except subprocess.TimeoutExpired as late:
        raise Failure(f"stopped after {LIMIT_S} s") from late
    if done.returncode != 0:
        raise Failure(f"exit code {done.returncode}\n{done.stdout[-3000:]}")


# -- blocks ----------------------------------------------------------------------------------------------------------------


def outputs_of(line):
    """Files that a line of sh says it writes: the values of known options, and where > leads."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    try:
        words = list(lexer)
    except ValueError:
        return []
    pairs = zip(words, words[1:])
    return [name for word, name in pairs if (word in OUTPUTS or word == ">") and not re.search(r"[$%*]|^-", name)]


def bring_splats(name, work, values):
    made = work / ".home/own.ply"
    run(["tides", "scene", "plane", "--size", "173x130", "-qo", made], work, values)
    run(["tides", "convert", "-q", made, name], work, values)


def run_sh(block, work, values):
    if "splats" in block.marks:
        bring_splats(block.marks["splats"], work, values)
    if "pip install" in block.text:
        for name in ("TIDES_LIBRARY", "PYTHONPATH"):
            values.pop(name, None)
    without = block.marks.get("without", "").split(",")[0]
    lines = [line for line in block.text.splitlines() if not (without and line.startswith(without))]
    run(["bash", "-euo", "pipefail", "-c", "\n".join(lines)], work, values)
    wanted = [name for line in lines for name in outputs_of(line)]
    for name in wanted + block.marks.get("writes", "").split():
        path = work / name
        if not path.exists() or (path.is_file() and path.stat().st_size == 0):
            raise Failure(f"{name} wasn't written")


def run_json(block, work, _):
    try:
        json.loads(re.sub(r"//[^\"\n]*$", "", block.text, flags=re.M))
    except json.JSONDecodeError as error:
        raise Failure(str(error)) from error
    if "file" not in block.marks:
        raise Failure("JSON that nothing runs: name its file (check: file NAME)")


def run_python(block, work, values):
    run([work / ".venv/bin/python", "-c", block.text], work, values)


def run_c(block, *_):
    if "file" not in block.marks:
        raise Failure("C that nothing compiles: name its file (check: file NAME)")


RUNNERS = {"sh": run_sh, "json": run_json, "python": run_python, "c": run_c}


def check_block(block, work, values):
    """The reason for leaving it out, or None; raises Failure."""
    if "skip" in block.marks:
        return block.marks["skip"]
    if QUICK and "slow" in block.marks:
        return "slow: make check-readme runs it"
    if block.language not in RUNNERS:
        raise Failure(f"blocks of {block.language} are unknown here")
    if "file" in block.marks:
        (work / block.marks["file"]).write_text(block.text)
    RUNNERS[block.language](block, work, values)
    return None


# -- names -----------------------------------------------------------------------------------------------------------------


def missing_paths(page, text):
    """What the page names of the repository, or beside itself, and isn't there."""
    inside = set(re.findall(rf"[`(]((?:{FOLDERS})/[\w./*-]*)[`)#]", text))
    beside = set(re.findall(r"\]\(([\w./-]+)\)", text))
    yield from (f"{path}: isn't in the repository" for path in sorted(inside) if not glob.glob(str(REPOSITORY / path)))
    yield from (f"{path}: isn't there" for path in sorted(beside)
               if not (BUILT.fullmatch(path) or (page.parent / path).exists()))


def missing_commands(text, values):
    help_text = subprocess.run(["tides", "--help"], env=values, capture_output=True, text=True, check=True).stdout
    for command in re.findall(r"^  (\w+) ", help_text, flags=re.M):
        if f"tides {command}" not in text:
            yield f"tides {command} isn't mentioned"


def check_page(page):
    """Numbers of blocks that passed, failed and were left out."""
    text = page.read_text()
    passed = failed = skipped = 0
    with tempfile.TemporaryDirectory(prefix="tides-readme-") as folder:
        work = Path(folder)
        values = environment(work)
        for block in blocks_of(text):
            if not block.language:
                continue
            try:
                reason = check_block(block, work, values)
            except Failure as failure:
                failed += 1
                print(f"FAIL {page.name} {block}: {failure}", flush=True)
                continue
            without = f" (without {block.marks['without']})" if "without" in block.marks else ""
            passed, skipped = passed + (reason is None), skipped + (reason is not None)
            print(f"skip {page.name} {block}: {reason}" if reason else f"ok   {page.name} {block}{without}", flush=True)
        missing = list(missing_paths(page, text))
        missing += missing_commands(text, values) if page.name == "README.md" else []
        for name in missing:
            print(f"FAIL {page.name} {name}")
    return passed, failed + len(missing), skipped


def main():
    pages = [Path(name) for name in sys.argv[1:]]
    pages = pages or [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs/guide").glob("*.md"))]
    passed, failed, skipped = (sum(numbers) for numbers in zip(*(check_page(page.resolve()) for page in pages)))
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return failed != 0


if __name__ == "__main__":
    sys.exit(main())
