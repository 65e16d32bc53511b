#!/usr/bin/env python3
"""Makes tides/_api.py from the public headers: constants, structs, callback types and prototypes for ctypes.

    python3 generate.py                writes tides/_api.py
    python3 generate.py --offsets      prints a C program that prints the size of each struct and each field's offset

The compiler's preprocessor ($CC, else cc) reads the headers; what is left of C is small enough for a few expressions. Anything
that isn't understood ends the program: a header never changes without this file being asked.
"""

import keyword
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
INCLUDE = HERE.parent / "include"
OUTPUT = HERE / "tides" / "_api.py"
WIDTH = 120

SCALARS = {
    "char": "c_char", "int": "c_int", "float": "c_float", "double": "c_double", "size_t": "c_size_t",
    **{f"{sign}int{bits}_t": f"c_{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}  # fmt: skip
HINTS = {"c_char": "bytes", "c_char_p": "bytes | None", "c_float": "float", "c_double": "float"}


def preprocessed():
    """What the headers of tides say after the preprocessor, comments kept, system headers left out."""
    command = os.environ.get("CC", "cc").split() + ["-E", "-C", "-U__GNUC__", f"-I{INCLUDE}", str(INCLUDE / "tides.h")]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    ours, lines = False, []
    for line in text.splitlines():
        marker = re.match(r'# \d+ "([^"]*)"', line)
        if marker:
            ours = str(INCLUDE) in marker[1]
        elif ours and not line.startswith("#"):
            lines.append(line)
    return "\n".join(lines)


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.S)


def statements(text):
    """Declarations at file scope, with their comments: split at semicolons that are in no braces and in no comment."""
    start = depth = i = 0
    while i < len(text):
        if text.startswith("/*", i):
            i = text.index("*/", i) + 2
            continue
        depth += {"{": 1, "}": -1}.get(text[i], 0)
        if text[i] == ";" and depth == 0:
            yield text[start:i]
            start = i + 1
        i += 1
    if without_comments(text[start:]).strip():
        sys.exit(f"generate.py: this isn't finished: {text[start:][:200]}")


class Api:
    def __init__(self):
        self.constants, self.opaque, self.structs, self.callbacks, self.functions, self.aliases = {}, [], {}, {}, {}, {}
        self.order = []  # of structs and callbacks, as declared

    def number(self, text):
        names = {name: value for name, value in self.constants.items() if isinstance(value, int)}
        return int(eval(text, {"__builtins__": {}}, names))  # the text is ours: a header's constant

    # -- types ------------------------------------------------------------------------------------------------------
    def type_of(self, text):
        """A C type as a ctypes expression; None for void."""
        base = re.sub(r"\b(const|struct)\b", " ", text)
        stars = base.count("*")
        base = base.replace("*", " ").strip()
        base = self.aliases.get(base, base)
        if base == "void" and stars:
            name, stars = "c_void_p", stars - 1
        elif base == "char" and stars:
            name, stars = "c_char_p", stars - 1
        elif base == "void":
            return None
        elif base in SCALARS:
            name = SCALARS[base]
        elif base in self.structs or base in self.opaque or base in self.callbacks:
            name = base
        else:
            sys.exit(f"generate.py: unknown type: {text}")
        return "P(" * stars + name + ")" * stars

    def declarators(self, text):
        """'const double *a, b[3]' as [(name, ctypes expression)]."""
        head = re.match(r"\s*((?:const\s+)?(?:struct\s+)?\w+(?:\s+const)?)\s*(.*)", text, re.S)
        result = []
        for one in head[2].split(","):
            stars, name, sizes = re.match(r"([\s*]*(?:const\s*)?[\s*]*)(\w+)((?:\s*\[[^\]]*\])*)\s*$", one).groups()
            kind = self.type_of(head[1] + stars)
            for size in reversed(re.findall(r"\[([^\]]*)\]", sizes)):
                kind = f"{kind} * {self.number(size)}"
            result.append((name, kind))
        return result

    def parameters(self, text):
        """A parameter list as [ctypes expression]: arrays are pointers, as in C."""
        if text.strip() == "void":
            return []
        kinds = []
        for one in text.split(","):
            array = re.search(r"\[[^\]]*\]\s*$", one)
            bare = re.sub(r"\w+\s*(\[[^\]]*\])?\s*$", "", one)
            kinds.append(self.type_of(bare + ("*" if array else "")))
        return kinds

    @staticmethod
    def names(text):
        """What a parameter list calls them, with blanks between."""
        return " ".join(re.findall(r"(\w+)\s*(?:\[[^\]]*\])?\s*(?:,|$)", "" if text.strip() == "void" else text))

    # -- declarations -----------------------------------------------------------------------------------------------
    def add_enum(self, body):
        value = -1
        for one in filter(None, (part.strip() for part in body.split(","))):
            name, _, given = one.partition("=")
            value = self.number(given) if given else value + 1
            self.constants[name.strip()] = value

    def add_struct(self, name, text):
        body = text[text.index("{") + 1 : text.rindex("}")]
        fields = []
        for one in filter(None, (part.strip() for part in without_comments(body).split(";"))):
            fields += self.declarators(one)
        lines = (" ".join(line.split()) for line in body.splitlines())  # compilers differ in the spaces that they keep
        self.structs[name] = (fields, "\n".join(line for line in lines if line))
        self.order.append(name)

    def add(self, text):
        plain = " ".join(without_comments(text).split())
        if not plain:
            return
        if match := re.fullmatch(r"typedef struct (\w+) (\w+)", plain):
            self.opaque.append(match[2])
        elif match := re.fullmatch(r"typedef struct (\w+) \{.*\} (\w+)", plain):
            self.add_struct(match[2], text[text.index("typedef") :])
        elif match := re.fullmatch(r"(?:typedef )?enum(?: \w+)? \{(.*)\}(?: \w+)?", plain):
            self.add_enum(match[1])
        elif match := re.fullmatch(r"typedef (.+?)\(\*(\w+)\)\((.*)\)", plain):
            self.callbacks[match[2]] = (self.type_of(match[1]), self.parameters(match[3]))
            self.order.append(match[2])
        elif match := re.fullmatch(r"typedef (\w+) (\w+)", plain):
            self.aliases[match[2]] = match[1]
        elif match := re.fullmatch(r"([\w\s*]+?)(tides_\w+)\s?\((.*)\)", plain):
            self.functions[match[2]] = (self.type_of(match[1]), self.parameters(match[3]), self.names(match[3]), plain)
        else:
            sys.exit(f"generate.py: this isn't understood: {plain}")

    def read(self):
        for header in sorted((INCLUDE / "tides").glob("*.h")):
            for name, value in re.findall(r"^#define (TIDES_\w+) (\d+)$", header.read_text(), re.M):
                self.constants[name] = int(value)
        for text in statements(preprocessed()):
            self.add(text)
        return self


# -- output -------------------------------------------------------------------------------------------------------------
def hint(kind, callbacks):
    if " * " in kind or kind.startswith("P(") or kind in callbacks:
        return "Any"
    return HINTS.get(kind, "int" if kind.startswith("c_") else kind)


def write_struct(name, fields, body, callbacks):
    lines = [
        "",
        "",
        f"class {name}(Structure):",
        '    """' + body.replace("\\", "\\\\").replace("\n", "\n    ") + '\n    """',
        "",
    ]
    lines += [f"    {field}: {hint(kind, callbacks)}" for field, kind in fields if not keyword.iskeyword(field)]
    lines += ["", "    _fields_ = ["]
    return lines + [f'        ("{field}", {kind}),' for field, kind in fields] + ["    ]"]


def write_function(name, result, kinds, names, plain):
    comment = textwrap.wrap(plain, WIDTH - 6, break_long_words=False)
    lines = [f"    # {one}" for one in comment]
    whole = f'    "{name}": ({result}, [{", ".join(kinds)}], "{names}"),'
    if len(whole) <= WIDTH:
        return lines + [whole]
    wrapped = textwrap.wrap(", ".join(kinds), WIDTH - 12, break_long_words=False)
    return lines + [f'    "{name}": ({result}, ['] + [f"        {one}" for one in wrapped] + [f'    ], "{names}"),']


HEAD = '''"""The C interface, made by generate.py from include/tides/*.h: `make python` where one changed. Do not edit."""

# fmt: off
# flake8: noqa
from __future__ import annotations

from ctypes import CFUNCTYPE, POINTER as P, Structure
from ctypes import c_char, c_char_p, c_double, c_float, c_int, c_int8, c_int16, c_int32, c_int64
from ctypes import c_size_t, c_uint8, c_uint16, c_uint32, c_uint64, c_void_p
from typing import Any

'''


def python(api):
    lines = HEAD.splitlines()
    lines += [f"{name} = {value}" for name, value in api.constants.items()]
    lines += ["", "# Opaque objects: only pointers to them exist here."]
    for name in api.opaque:
        lines += ["", "", f"class {name}(Structure):", "    pass"]
    for name in api.order:
        if name in api.structs:
            lines += write_struct(name, *api.structs[name], api.callbacks)
        else:
            result, kinds = api.callbacks[name]
            lines += ["", "", f"{name} = CFUNCTYPE({', '.join([str(result)] + kinds)})"]
    lines += [
        "",
        "",
        "# name: (type of the result, types of the arguments, their names)",
        "FUNCTIONS: dict[str, tuple[Any, list[Any], str]] = {",
    ]
    for name in sorted(api.functions):
        lines += write_function(name, *api.functions[name])
    lines += [
        "}",
        "",
        "STRUCTS = (",
        *textwrap.wrap(", ".join(api.structs) + ",", WIDTH, initial_indent="    ", subsequent_indent="    "),
        ")",
    ]
    return "\n".join(lines) + "\n"


def offsets(api):
    lines = ["#include <stddef.h>", "#include <stdio.h>", "#include <tides.h>", "int main(void) {"]
    for name, (fields, _) in api.structs.items():
        lines.append(f'    printf("{name} %zu\\n", sizeof({name}));')
        lines += [f'    printf("{name}.{field} %zu\\n", offsetof({name}, {field}));' for field, _ in fields]
    return "\n".join(lines + ["    return 0;", "}"]) + "\n"


if __name__ == "__main__":
    if sys.argv[1:] == ["--offsets"]:
        print(offsets(Api().read()), end="")
    elif sys.argv[1:] == ["--print"]:
        print(python(Api().read()), end="")
    elif not sys.argv[1:]:
        made = python(Api().read())
        OUTPUT.write_text(made)
    else:
        sys.exit(__doc__)
