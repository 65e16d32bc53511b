#!/usr/bin/env python3
"""What `make lint` checks of the house as a whole. Prints findings, one line each, and exits 1 where there are any.

usage: house.py arrows|circles|wide|cites|openings|guards|libm [ROOT]     ROOT: a tree like this repository's (default: this repository)

arrows     every #include goes to a folder that scripts/arrows.txt allows
circles    no files of a folder of lib or cli use one another's functions in a circle, but for those of its `circle` lines; files
           of folders within another use those of the folders beside them as it allows
wide       no struct of lib or cli has more than 30 fields, and no function more than 8 parameters, but public ones, which every
           binding names (a declaration in include/), and those of its `wide` lines
cites      comments and pages cite files that are in the repository, and sections that docs/DESIGN.md has; each mutant of
           tests/mutants.txt finds its text, once
openings   every file of lib begins with a comment of a sentence or more
guards     no two headers hide each other
libm       lib and kernels call no function of <math.h> whose last bits differ from one C library to another
"""
import re
import sys
from pathlib import Path

SOURCE_FOLDERS = ("include", "lib", "cli", "kernels")
# Where the compiler looks (Makefile, TIDES_CPPFLAGS) for names without a folder, besides the file's own.
INCLUDE_PATHS = ("include", "lib/base", "lib/device", "lib", "", "kernels")
CITING = ("include", "lib", "cli", "kernels", "tests", "scripts", "python_ctypes", "docs", ".ci")
# Words in an opening comment below which it can't say what a file does and for whom.
OPENING_WORDS = 8


def files(root, folders, endings):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and path.suffix in endings and "__pycache__" not in path.parts:
                yield path


def folder_of(root, path, listed=()):
    """lib/solver/x.h -> lib/solver; cli/bench/x.c -> cli; lib/solver/run/run.c -> lib/solver/run where that is listed"""
    parts = path.resolve().relative_to(root).parts
    if "/".join(parts[:3]) in listed:
        return "/".join(parts[:3])
    return "/".join(parts[:2]) if parts[0] == "lib" and len(parts) > 2 else parts[0]


# -- arrows ------------------------------------------------------------------------------------------------------------


def read_order(path):
    """Folders -> those that they may include; the pairs that are still due; and what is wrong with the list itself."""
    allowed, everyone, due, wrong = {}, [], set(), []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        line = line.split("#")[0].strip()
        if not line:
            continue
        name, _, rest = line.partition(":")
        targets = rest.split()
        if name == "everyone":
            everyone = targets
        elif name == "due":
            due.add(tuple(targets))
        elif name in ("circle", "wide"):
            continue  # read_circles and check_wide
        else:
            late = [t for t in targets if t not in allowed]
            wrong += [f"{path.name}:{number}: {name} may include {t}, which doesn't stand above it" for t in late]
            allowed[name] = set(targets)
    for name, targets in allowed.items():
        targets |= set(everyone) | {name}
    return allowed, due, wrong


def target_of(root, path, name, listed):
    for base in (path.parent, *(root / p for p in INCLUDE_PATHS)):
        if (base / name).is_file():
            return folder_of(root, base / name, listed)
    return None


def check_arrows(root):
    allowed, due, found = read_order(root / "scripts/arrows.txt")
    used = set()
    for path in files(root, SOURCE_FOLDERS, {".c", ".h", ".cl"}):
        folder = folder_of(root, path, allowed)
        if folder not in allowed:
            found.append(f"{path.relative_to(root)}: scripts/arrows.txt has no line for {folder}")
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s+"([^"]+)"', line)
            target = match and target_of(root, path, match[1], allowed)
            if target and target not in allowed[folder]:
                used.add((folder, target))
                if (folder, target) not in due:
                    found.append(f'{path.relative_to(root)}:{number}: "{match[1]}": {folder} may not include {target}')
    found += [f"arrows.txt: {a} includes nothing of {b} any more: take the 'due' line out" for a, b in sorted(due - used)]
    return found


# -- circles -----------------------------------------------------------------------------------------------------------

# The head of a function that other files may call, up to its brace.
HEAD = re.compile(r"^(?!static\b|typedef\b)[A-Za-z_][\w \t*]*[\s*](\w+)\([^;{}]*\)\s*\{", re.M)


def code_of(path):
    return re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"', " ", path.read_text(), flags=re.S)


def circle_through(uses, start):
    """The shortest way from a file back to itself, by what each uses; [] where there is none."""
    ways, seen = [[start]], set()
    for way in ways:
        for target in sorted(uses[way[-1]]):
            if target == start:
                return way
            if target not in seen:
                seen.add(target)
                ways.append([*way, target])
    return []


def read_circles(path):
    """The files of each circle that is still there."""
    lines = (line.split("#")[0] for line in path.read_text().splitlines())
    return [set(line.split()[1:]) for line in lines if line.startswith("circle:")]


def uses_of(code):
    """What files use of one another, by their code."""
    home = {name: path for path, text in code.items() for name in HEAD.findall(text)}
    return {path: {home[word] for word in set(re.findall(r"\w+", text)) if word in home} - {path} for path, text in code.items()}


def check_circles(root):
    allowed, _, _ = read_order(root / "scripts/arrows.txt")
    code = {path: code_of(path) for path in files(root, ("lib", "cli"), {".c"})}
    found, told, uses = [], set(), {}
    inner = {path: text for path, text in code.items() if folder_of(root, path, allowed).count("/") == 2}
    groups = [inner] + [{p: code[p] for p in code if p.parent == folder} for folder in {p.parent for p in code if p not in inner}]
    for group in groups:
        uses.update(uses_of(group))
    for path in inner:
        folder = folder_of(root, path, allowed)
        for target in sorted(uses[path]):
            if folder_of(root, target, allowed) not in allowed[folder]:
                found.append(f"{path.relative_to(root)}: uses {target.relative_to(root)}, which {folder} may not")
    known = read_circles(root / "scripts/arrows.txt")
    circling = set()
    for path in sorted(uses):
        way = circle_through(uses, path)
        names = {str(p.relative_to(root)) for p in way}
        circling |= names
        if way and frozenset(way) not in told and not any(names <= circle for circle in known):
            told.add(frozenset(way))
            found.append("a circle: " + " -> ".join(str(p.relative_to(root)) for p in [*way, path]))
    for circle in known:
        found += [f"arrows.txt: {name} is in no circle any more: take it out" for name in sorted(circle - circling)]
    return found


# -- wide structs and functions -----------------------------------------------------------------------------------------

MOST_FIELDS, MOST_PARAMETERS = 30, 8
STRUCT = re.compile(r"\bstruct (\w+) \{")
HEAD_WITH_PARAMETERS = re.compile(r"^[A-Za-z_][\w \t*]*[\s*](\w+)\(([^;{}]*?)\)\s*\{", re.M)


def without_inner(text, opening, closing):
    """The text with all that stands between such brackets left out, whatever is nested in them."""
    pattern = re.compile(rf"\{opening}[^\{opening}\{closing}]*\{closing}")
    while pattern.search(text):
        text = pattern.sub("", text)
    return text


def wide_of(code):
    """(name, number, what) of the structs and functions that are too wide."""
    for match in STRUCT.finditer(code):
        depth, at = 1, match.end()
        while depth and at < len(code):
            depth += (code[at] == "{") - (code[at] == "}")
            at += 1
        fields = without_inner(without_inner(code[match.end() : at - 1], "{", "}"), "(", ")")
        count = sum(1 + field.count(",") for field in fields.split(";")[:-1])
        if count > MOST_FIELDS:
            yield match[1], count, "fields"
    for match in HEAD_WITH_PARAMETERS.finditer(code):
        count = 1 + without_inner(match[2], "(", ")").count(",")
        if count > MOST_PARAMETERS:
            yield match[1], count, "parameters"


def check_wide(root):
    lines = (line.split("#")[0].split() for line in (root / "scripts/arrows.txt").read_text().splitlines())
    known = {words[1] for words in lines if words[:1] == ["wide:"]}
    public = set(re.findall(r"\b(\w+)\(", "".join(code_of(path) for path in files(root, ("include",), {".h"}))))
    found, seen = [], set()
    for path in files(root, ("lib", "cli"), {".c", ".h"}):
        for name, count, what in wide_of(code_of(path)):
            seen.add(name)
            if name not in known | public:
                found.append(f"{path.relative_to(root)}: {name} has {count} {what}")
    return found + [f"arrows.txt: {name} is wide no more: take its line out" for name in sorted(known - (seen - public))]


# -- citations ---------------------------------------------------------------------------------------------------------

# A mention of the design with its sections: "DESIGN 3.3, 3.4", "DESIGN 3.2 and 3.3".
DESIGN = re.compile(r"\bDESIGN\b(?!\.md)((?: |,? and |, )?\d[\d.]*(?:(?:, | and )\d[\d.]*)*)?")
NAMED = re.compile(r"(?<![\w/$.:-])((?:[\w.-]+/)*[\w-]+\.(?:md|c|h|cl|sh|py))\b(?![/(])")
ELSEWHERE = re.compile(r"https?://\S+|\$\{?TIDES_SHARED\}?\S*|<[\w/]+\.h>")
# Names of other projects' files and of made-up ones, as they stand in texts.
FOREIGN = {"CHANGES.md", "program.c", "sysexits.h", "pickletools.py", "simple_trainer.py", "export_perframe_3DGS.py"}
GENERATED = {"kernels_embedded.c", "presets_embedded.c", "page_embedded.c"}
PLACEHOLDER = re.compile(r"[A-Z]{4,}") # cmd_NAME.c


def comments_of(path, text):
    """The text with everything blanked that isn't a comment (a page: but for its code blocks), lines kept."""
    if path.suffix == ".md":
        return re.sub(r"```.*?```", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S)
    if path.suffix in {".c", ".h", ".cl"}:
        pattern = r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
        kept, last = [], 0
        for match in re.finditer(pattern, text, re.S):
            kept.append(re.sub(r"[^\n]", " ", text[last : match.start()]))
            kept.append(match[0] if match[0].startswith("/") else " " * len(match[0]))
            last = match.end()
        return "".join(kept) + re.sub(r"[^\n]", " ", text[last:])
    return "\n".join(line[line.find("#") :] if re.search(r"(^|\s)#", line) else "" for line in text.splitlines())


def sections_of(root):
    return set(re.findall(r"^#+ (\d+(?:\.\d+)*)\.? ", (root / "docs/DESIGN.md").read_text(), re.M))


def citing_files(root):
    yield from files(root, CITING, {".c", ".h", ".cl", ".sh", ".py", ".md"})
    for name in ("README.md", "Makefile"):
        if (root / name).is_file():
            yield root / name


def check_text(root, path, text, sections, names):
    """What the comments cite that isn't there: (offset, words)."""
    for match in DESIGN.finditer(text):
        cited = re.findall(r"\d+(?:\.\d+)*", match[1] or "")
        if not cited:
            yield match.start(), "DESIGN without a section's number"
        for section in cited:
            if section not in sections:
                yield match.start(), f"DESIGN {section}: docs/DESIGN.md has no such section"
    for match in re.finditer(r"simulators?\W+(?:\*\s+)?notes", text):
        yield match.start(), "the simulators notes aren't in the repository: say what they say"
    for match in re.finditer(r"\bnotes?,\s+(?:\*\s+)?sections?\b", text):
        yield match.start(), "notes with sections: name a file of the repository, or say what they say"
    for match in NAMED.finditer(ELSEWHERE.sub(lambda m: " " * len(m[0]), text)):
        name = match[1]
        if PLACEHOLDER.search(Path(name).stem) or Path(name).name in FOREIGN | GENERATED:
            continue
        there = name in names or any((base / name).exists() for base in (root, path.parent, root / "lib", root / "include"))
        if not there:
            yield match.start(), f"{name}: no such file in the repository"


def check_identifiers(root, path, text, words):
    """Functions and types that a page names and that no source has; a trailing * or _ stands for a family."""
    for match in re.finditer(r"\b(?:td|tides)_[a-z0-9_]*[a-z0-9]\b(?![*])", text):
        if match[0] not in words and not text[match.end() :].startswith("_*"):
            yield match.start(), f"{match[0]}: no source has such a name"


def check_cites(root):
    sections, found = sections_of(root), []
    names = {p.name for folder in CITING for p in (root / folder).rglob("*") if p.is_file()}
    names |= {p.name for p in root.iterdir()}
    sources = files(root, (*SOURCE_FOLDERS, "python_ctypes", "tests"), {".c", ".h", ".cl", ".py"})
    identifiers = {word for path in sources for word in re.findall(r"\b(?:td|tides)_\w+", path.read_text())}
    for path in citing_files(root):
        text = comments_of(path, path.read_text())
        cited = list(check_text(root, path, text, sections, names))
        if path.suffix == ".md":
            cited += check_identifiers(root, path, text, identifiers)
        for offset, words in cited:
            found.append(f"{path.relative_to(root)}:{text.count(chr(10), 0, offset) + 1}: {words}")
    return found + check_mutants(root)


def check_mutants(root):
    found, listed = [], root / "tests/mutants.txt"
    for number, line in enumerate(listed.read_text().splitlines() if listed.is_file() else [], 1):
        name, *words = line.split("\t")
        if name.startswith("#") or not words:
            continue
        times = (root / name).read_text().count(words[0]) if (root / name).is_file() else 0
        if times != 1:
            found.append(f"tests/mutants.txt:{number}: {name} has {words[0]} {times} times")
    return found


# -- openings ----------------------------------------------------------------------------------------------------------


def check_openings(root):
    found = []
    for path in files(root, ("lib",), {".c", ".h"}):
        opening = re.match(r"/\*(.*?)\*/", path.read_text(), re.S)
        words = len(re.findall(r"\w{2,}", opening[1])) if opening else 0
        if words < OPENING_WORDS:
            found.append(f"{path.relative_to(root)}:1: an opening of {words} words can't say what this does and for whom")
    return found


# -- guards ------------------------------------------------------------------------------------------------------------


def check_guards(root):
    """A header that has another's guard is empty where both are included, in one order of the two."""
    first, found = {}, []
    for path in files(root, (*SOURCE_FOLDERS, "tests"), {".h"}):
        guard = re.search(r"^#ifndef (\w+_H)$", path.read_text(), re.M)
        other = guard and first.setdefault(guard[1], path)
        if guard and other != path:
            found.append(f"{path.relative_to(root)}: {guard[1]} is {other.relative_to(root)}'s guard, too")
    return found


# -- libm --------------------------------------------------------------------------------------------------------------

# Of C99's <math.h>, what has one result whatever computes it, and so may be called where events are made.
EXACT = {
    "IEEE 754 defines the result to the bit": "sqrt fma fabs copysign nextafter fmod remainder",
    "a whole number or a part of one, exactly": "floor ceil trunc round lround llround rint lrint llrint nearbyint modf",
    "powers of two alone": "ldexp frexp scalbn scalbln ilogb logb",
    "one of the two; of zeros with two signs either, and no event has the sign of a zero": "fmin fmax",
}
# All others: td_math.h, or exact.h and numerics.h in kernels, have such functions of ours.
INEXACT = """acos acosh asin asinh atan atan2 atanh cbrt cos cosh erf erfc exp exp2 expm1 fdim hypot lgamma log log10 log1p log2 pow remquo
    sin sinh tan tanh tgamma exp10 pow10 pown powr rootn sincos cospi sinpi native_exp native_log mad""".split()
CALL = re.compile(rf"(?<![\w.>])((?:{'|'.join(INEXACT)})[fl]?)\(")


def check_libm(root):
    """A comment or a text may name one, and a member of a structure may have such a name."""
    assert not set(INEXACT) & set(" ".join(EXACT.values()).split())
    found = []
    for path in files(root, ("lib", "kernels"), {".c", ".h", ".cl"}):
        text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), path.read_text(), flags=re.S)
        for number, line in enumerate(text.splitlines(), 1):
            for name in CALL.findall(re.sub(r'"(?:\\.|[^"\\])*"', "", line)):
                found.append(f"{path.relative_to(root)}:{number}: {name}(): libm's last bits differ (lib/base/td_math.h)")
    return found


CHECKS = {
    "arrows": check_arrows,
    "circles": check_circles,
    "wide": check_wide,
    "cites": check_cites,
    "openings": check_openings,
    "guards": check_guards,
    "libm": check_libm,
}


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1] not in CHECKS:
        raise SystemExit(__doc__)
    root = Path(sys.argv[2] if len(sys.argv) == 3 else Path(__file__).parent.parent).resolve()
    found = CHECKS[sys.argv[1]](root)
    print("\n".join(found), end="\n" if found else "")
    raise SystemExit(1 if found else 0)


if __name__ == "__main__":
    main()
