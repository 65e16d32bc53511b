#!/usr/bin/python3
"""Doxygen's input filter: a page of the manual with its headings named, so that links into it lead there.

usage: page.py PAGE.md     prints it

Other sites take `readers.md#camera-paths` for the heading "Camera paths"; Doxygen before 1.9.8 needs a label on both ends.
Pictures are found by their names alone (IMAGE_PATH).
"""
import re
import sys
from pathlib import Path


def slug(heading):
    return re.sub(r"[^a-z0-9]+", "-", heading.lower()).strip("-")


def main():
    path = Path(sys.argv[1])
    fenced = False
    for line in path.read_text(encoding="utf-8").split("\n"):
        fenced ^= line.startswith("```")
        heading = re.match(r"##+ (.*)$", line)
        if heading and not fenced:
            line += f" {{#{path.stem}-{slug(heading[1])}}}"
        line = re.sub(r"\]\((?:[^()#]*/)?(\w+)\.md#([\w-]+)\)", r"](@ref \1-\2)", line)
        line = re.sub(r"\]\(#([\w-]+)\)", rf"](@ref {path.stem}-\1)", line)
        print(re.sub(r"\]\((?:[^()]*/)?(\w+\.(?:png|svg))\)", r"](\1)", line))


main()
