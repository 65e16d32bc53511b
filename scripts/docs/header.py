#!/usr/bin/python3
"""Doxygen's input filter: a public header as it stands, with its comments as Doxygen wants them.

usage: header.py HEADER.h              prints it
       header.py --check HEADER.h...   says which declarations have no comment, and fails where there are any

The headers are written to be read: plain comments, equations and tables set by hand, one comment for what belongs together. So
here the file's first comment becomes \\file's; the comment in front of a paragraph of declarations becomes that of each of them;
a comment behind a declaration or a field is its own; indented lines stay as they are set.
"""
import re
import sys

LINES_OF_DASHES = re.compile(r"^/\* -- (.*?) -+ \*/$")


def escaped(text):
    """Words that Doxygen and Markdown would take for theirs, but for `code`."""
    parts = text.split("`")
    if len(parts) % 2 == 0:  # a backquote is open across lines: no code
        parts = ["'".join(parts)]
    safe = [re.sub(r"([\\@<>#%*|\[\]&~])", r"\\\1", part) for part in parts]
    return "".join(part if number % 2 == 0 else f"<code>{part}</code>" for number, part in enumerate(safe))


def comment(lines, opening="/**"):
    """The lines of a comment's text, of which some are indented: those are kept as they are."""
    out, kept = [], False
    for number, line in enumerate(lines):
        indented = number > 0 and line.startswith("  ") and line.strip() != ""
        continued = kept and line.strip() == "" and number + 1 < len(lines) and lines[number + 1].startswith("  ")
        if indented and not kept:
            out.append("@code{.unparsed}")
        elif kept and not indented and not continued:
            out.append("@endcode")
        kept = indented or continued
        out.append(line if kept else escaped(line))
    if kept:
        out.append("@endcode")
    return [f"{opening} {out[0]}"] + [f" * {line}" for line in out[1:]] + [" */"]


def text_of(block):
    """The lines between /* and */, without the stars in front of them."""
    body = "\n".join(block).strip()[2:-2].rstrip()
    lines = body.split("\n")
    return [lines[0].strip()] + [re.sub(r"^\s*\* ?", "", line) for line in lines[1:]]


FIELDS = re.compile(r"^(\s+)((?:const )?\w+ (?:\*(?:const )?\**)?)(\w+(?:\[\w+\])*(?:, \**\w+(?:\[\w+\])*)*);$")
KNOWN = {"size": ["sizeof this struct"], "reserved": ["0"]}


def fields(code, words):
    """`double a, b;` in a struct, with one comment: a declaration and the comment for each; what is always the same is known."""
    found = FIELDS.match(code)
    if not found:
        return [code] + (comment(words, "/**<") if words else [])
    out = []
    for name in found[3].split(", "):
        said = KNOWN.get(name, words)
        out += [f"{found[1]}{found[2]}{name};"] + (comment(said, "/**<") if said else [])
    return out


def declarations(lines):
    """What follows a paragraph's comment: a comment behind code is that code's; one within braces, of the field behind it."""
    out, at, before = [], 0, None
    while at < len(lines):
        line = lines[at]
        at += 1
        found = re.match(r"^(\s*\S.*?)\s*/\*\s?(.*)$", line)
        alone = re.match(r"^(\s+)/\*\s?(.*)$", line)
        if line.startswith("#") or not (found or alone):
            while line.startswith("    ") and line.endswith(",") and "(" not in line and at < len(lines):  # fields over lines
                line += " " + lines[at].strip()
                at += 1
            out += fields(line, before)
            before = None
            continue
        words = [(alone or found)[2]]
        while "*/" not in words[-1]:
            words.append(re.sub(r"^\s*\* ?", "", lines[at]).strip())
            at += 1
        words[-1] = words[-1][: words[-1].index("*/")].rstrip()
        if alone:
            before = words
        else:
            out += fields(found[1], words)
    return out


def paragraphs(lines):
    """Runs of lines between blank ones, outside comments and braces."""
    run, depth, inside = [], 0, False
    for line in lines:
        if not line.strip() and depth == 0 and not inside:
            if run:
                yield run
            run = []
            continue
        run.append(line)
        code = re.sub(r"/\*.*?\*/", "", line)
        inside = (inside or "/*" in code) and "*/" not in code
        depth += 0 if inside or line.startswith("#") or 'extern "C"' in line else code.count("{") - code.count("}")
        depth = max(depth, 0)
    if run:
        yield run


def parts_of(lines):
    """The declarations of a paragraph, each with its lines; what isn't one (#if, braces) goes with what is before it."""
    part, depth = [], 0
    for line in lines:
        if depth == 0 and re.match(r"TIDES_|typedef|enum|#define", line) and part:
            yield part
            part = []
        part.append(line)
        depth += line.count("{") - line.count("}")
    yield part


def documented(run):
    """A paragraph: its comment in front of each of its declarations."""
    if not run[0].startswith("/*") or LINES_OF_DASHES.match(run[0]):
        return declarations(run)
    end = next(number for number, line in enumerate(run) if "*/" in line)
    words, rest = text_of(run[: end + 1]), declarations(run[end + 1:])
    if not rest:  # of what follows, not of one declaration
        return run
    return [line for part in parts_of(rest) for line in comment(words) + part]


def wordless(runs):
    """First lines of the declarations that no comment is in front of or behind."""
    for run in runs:
        code = re.sub(r"/\*.*?\*/", "/**/", "\n".join(run), flags=re.S)
        if re.match(r"(TIDES_|typedef|enum)", code) and "/**/" not in code:
            yield run[0]


def main():
    check = sys.argv[1] == "--check"
    bad = 0
    for name in sys.argv[1 + check:]:
        with open(name, encoding="utf-8") as file:
            runs = list(paragraphs(file.read().split("\n")))
        if check:
            for line in wordless(runs):
                print(f"{name}: no comment says what this is: {line}")
                bad = 1
            continue
        first = runs[0]
        end = next(number for number, line in enumerate(first) if "*/" in line)
        out = comment(text_of(first[: end + 1]), "/** @file\n *") + first[end + 1:]
        for run in runs[1:]:
            out += [""] + documented(run)
        print("\n".join(out))
    return bad


sys.exit(main())
