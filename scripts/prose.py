#!/usr/bin/env python3
"""Counts what can be counted of docs/STYLE.md's rules, and fails where a count is above its line in scripts/prose.txt.

usage: prose.py [--check | --write | --list] [ROOT]     --write puts today's counts into prose.txt; --list prints each finding

long      sentences of more than 30 words in a page; a list behind a colon counts by itself
opening   comments that open with a word that points elsewhere: The same, Those, Of, What, Who
"""
import re
import sys
from pathlib import Path

LONGEST = 30
OPENERS = re.compile(r"(?:/\*\*?|//) (?:The same|Those|Of|What|Who)\b")
SOURCES = ("include", "lib", "kernels", "cli")
PAGES = ("README.md", "docs/*.md", "docs/guide/*.md", "tests/README.md")


def sentences(text):
    """(line, sentence) of a page's paragraphs and list items, without code, tables, headings and pictures."""
    text = re.sub(r"^```.*?^```", lambda found: "\n" * found[0].count("\n"), text, flags=re.M | re.S)
    begun, words = 1, []
    for number, line in enumerate([*text.splitlines(), ""], 1):
        apart = not line.strip() or re.match(r"\s*([-*|#!<]|\d+\. )", line)
        if apart and words:
            for sentence in re.split(r"(?<=[.!?:])\s+", " ".join(words)):
                yield begun, sentence
            words = []
        if line.strip() and not re.match(r"\s*[|#!<]", line):
            begun = number if not words else begun
            words.append(re.sub(r"^\s*[-*] ", "", line.strip()))


def long_sentences(path):
    for line, sentence in sentences(path.read_text()):
        count = len(re.sub(r"\]\([^)]*\)|`[^`]*`", " code ", sentence).split())
        if count > LONGEST:
            yield f"{line}: {count} words: {sentence}"


def openings(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if OPENERS.search(line):
            yield f"{number}: {line.strip()}"


def findings(root):
    """(kind, page or folder) -> what was found there"""
    found = {}
    for pattern in PAGES:
        for path in sorted(root.glob(pattern)):
            name = path.relative_to(root).as_posix()
            if name != "docs/CHANGELOG.md":
                found["long", name] = [f"{name}:{text}" for text in long_sentences(path)]
    for folder in SOURCES:
        paths = [path for path in sorted((root / folder).rglob("*")) if path.suffix in {".c", ".h", ".cl"}]
        found["opening", folder] = [f"{path.relative_to(root)}:{text}" for path in paths for text in openings(path)]
    return found


def main():
    arguments = [word for word in sys.argv[1:] if not word.startswith("--")]
    root = Path(arguments[0] if arguments else Path(__file__).parent.parent).resolve()
    found, file = findings(root), root / "scripts/prose.txt"
    if "--list" in sys.argv:
        print("\n".join(text for texts in found.values() for text in texts))
        return 0
    if "--write" in sys.argv:
        file.write_text("".join(f"{kind} {name} {len(texts)}\n" for (kind, name), texts in found.items() if texts))
        return 0
    known = {tuple(line.split()[:2]): int(line.split()[2]) for line in file.read_text().splitlines()}
    grown = {key: texts for key, texts in found.items() if len(texts) > known.get(key, 0)}
    for (kind, name), texts in grown.items():
        print(f"{name}: {len(texts)} of '{kind}', {known.get((kind, name), 0)} in scripts/prose.txt: docs/STYLE.md; prose.py --list")
    return 1 if grown else 0


if __name__ == "__main__":
    raise SystemExit(main())
