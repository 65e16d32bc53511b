"""The generated interface is that of the headers and of the library: functions, constants, struct layouts."""

import ctypes
import dataclasses
import inspect
import os
import subprocess
import sys
from pathlib import Path

import pytest
import tides
api = tides.api

ROOT = Path(__file__).resolve().parents[3]
GENERATE = ROOT / "python_ctypes" / "generate.py"
COMPILER = os.environ.get("CC", "cc").split()


def generate(*options):
    return subprocess.run([sys.executable, GENERATE, *options], check=True, capture_output=True, text=True).stdout


def test_generated_file_is_current():
    assert generate("--print") == (ROOT / "python_ctypes" / "tides" / "_api.py").read_text(), "run `make python`"


def test_struct_layouts(tmp_path):
    program = tmp_path / "offsets"
    (tmp_path / "offsets.c").write_text(generate("--offsets"))
    subprocess.run([*COMPILER, "-I", ROOT / "include", "-o", program, tmp_path / "offsets.c"], check=True)
    lines = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    for line in lines:
        name, number = line.split()
        struct, _, field = name.partition(".")
        kind = getattr(api, struct)
        assert (getattr(kind, field).offset if field else ctypes.sizeof(kind)) == int(number), name
    assert len(lines) == sum(1 + len(kind._fields_) for kind in api.STRUCTS) > 300


def test_every_exported_symbol_is_bound():
    path = tides.library_path
    lines = subprocess.run(["nm", "-D", "--defined-only", path], check=True, capture_output=True, text=True).stdout
    linkers = {"_end", "_edata", "__bss_start"}  # gold and lld export what they say of sections
    exported = {line.split()[-1].split("@")[0] for line in lines.splitlines()} - linkers
    if "__gcov_var" in exported:  # make coverage: gcc's own, which it can't hide
        exported = {name for name in exported if not name.startswith("__gcov_") and name != "mangle_path"}
    assert exported == set(api.FUNCTIONS)
    assert all(hasattr(tides.lib, name) for name in exported)


def test_functions_are_those_of_the_headers():
    lines = subprocess.run(["sh", "scripts/public_functions.sh"], check=True, capture_output=True, text=True, cwd=ROOT).stdout
    assert set(lines.split()) == set(api.FUNCTIONS)


def test_types_of_functions():
    for name, (result, arguments, names) in api.FUNCTIONS.items():
        assert len(names.split()) == len(set(names.split())) == len(arguments), name
        fallible = bool(arguments) and arguments[-1] is ctypes.POINTER(api.tides_error)
        assert not fallible or result is ctypes.c_int32, name


def test_unknown_c_is_refused(tmp_path):
    """The generator doesn't guess."""
    sys.path.insert(0, str(GENERATE.parent))
    import generate as generator

    one = generator.Api()
    for text in ("union { int a; } b", "typedef unsigned strange", "tides_status tides_f(tides_unknown *a)"):
        with pytest.raises(SystemExit):
            one.add(text)
            one.add("tides_status tides_g(strange a)")


def functions_of(owner):
    for name, value in vars(owner).items():
        made = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
        if not name.startswith("_") and inspect.isfunction(made):
            yield f"{owner.__name__}.{name}", made


def test_help_gives_shapes():
    """help() shows docstrings, not comments: fields stand in those, and arrays with their shapes."""
    lacking = []
    for name in tides.__all__:
        value = getattr(tides, name)
        functions = [(name, value)] if inspect.isfunction(value) else []
        functions += functions_of(value) if inspect.isclass(value) else []
        for where, function in functions:
            text = inspect.getdoc(function) or ""
            if "ndarray" in str(function.__annotations__.get("return")) and "(" not in text:
                lacking.append(where)
        if dataclasses.is_dataclass(value):
            lacking += [f"{name}.{f.name}" for f in dataclasses.fields(value) if f.name not in (inspect.getdoc(value) or "")]
    assert not lacking


def test_status_and_version():
    assert tides.lib.tides_version().decode() == tides.__version__
    statuses = {value: name for name, value in vars(api).items() if name in status_names()}
    assert set(statuses) - {api.TIDES_OK} == set(tides.errors.BY_STATUS)
    for value, name in statuses.items():
        assert tides.lib.tides_status_name(value).decode() == name
        assert tides.lib.tides_status_text(value)
        made = tides.errors.make(value, name, "a line") if value else None
        assert value == 0 or (isinstance(made, tides.TidesError) and str(made) == "a line")
    assert tides.lib.tides_status_name(12345) == b"TIDES_UNKNOWN_STATUS"


def status_names():
    text = (ROOT / "include" / "tides" / "base.h").read_text()
    body = text[text.index("#define TIDES_STATUS_LIST") : text.index("typedef int32_t tides_status")]
    return {"TIDES_" + line.split("X(")[1].split(",")[0] for line in body.splitlines() if " X(" in line}


def import_with(**environment):
    code = "import tides; print(tides.library_path)"
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, **environment}, cwd="/"
    )


def test_library_is_found_where_named():
    package = str(ROOT / "python_ctypes")
    here = import_with(PYTHONPATH=package, TIDES_LIBRARY=tides.library_path)
    assert here.stdout.strip() == tides.library_path
    lost = import_with(PYTHONPATH=package, TIDES_LIBRARY="/nowhere/libtides.so")
    assert lost.returncode and "ImportError" in lost.stderr and "/nowhere/libtides.so" in lost.stderr


def test_other_library_is_refused(tmp_path):
    """One of another version, and one whose structs have grown."""
    package = str(ROOT / "python_ctypes")
    for version, message in (("9.9.9", "is version 9.9.9"), (tides.__version__, "has no tides_")):
        source, library = tmp_path / "fake.c", tmp_path / "fake.so"
        source.write_text(f'const char *tides_version(void) {{ return "{version}"; }}\n')
        subprocess.run([*COMPILER, "-shared", "-fPIC", "-o", library, source], check=True)
        tried = import_with(PYTHONPATH=package, TIDES_LIBRARY=str(library))
        assert tried.returncode and message in tried.stderr, tried.stderr


def test_grown_struct_is_refused():
    from types import SimpleNamespace

    from tides import _library

    def grown(struct, *_):
        struct.contents.size = ctypes.sizeof(struct.contents) + 8

    functions = SimpleNamespace(**{name: grown for name in api.FUNCTIONS})
    with pytest.raises(ImportError, match="another size"):
        _library._check_sizes(functions, "here")
