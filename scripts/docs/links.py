#!/usr/bin/python3
"""Every link of the pages below a folder leads to a file there, and to a place in it that there is.

usage: links.py FOLDER     (linkchecker does this as well, in minutes)
"""
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlparse


class Page(HTMLParser):
    """The places that a page has, and what it links to."""

    def __init__(self, path):
        super().__init__()
        self.places, self.links = {"", "top"}, set()
        self.feed(path.read_text(encoding="utf-8", errors="replace"))

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.places |= {values[key] for key in ("id", "name") if values.get(key)}
        self.links |= {values[key] for key in ("href", "src") if values.get(key)}


def main():
    root = Path(sys.argv[1]).resolve()
    pages = {path: Page(path) for path in sorted(root.rglob("*.html"))}
    broken, links = 0, 0
    for path, page in pages.items():
        for link in sorted(page.links):
            target, place = urldefrag(link)
            if urlparse(link).scheme:
                continue
            links += 1
            to = (path.parent / unquote(target)).resolve() if target else path
            if not to.is_file() or not to.is_relative_to(root):
                print(f"{path.relative_to(root)}: {link} leads nowhere")
            elif to in pages and unquote(place) not in pages[to].places:
                print(f"{path.relative_to(root)}: {link}: no such place on that page")
            else:
                continue
            broken += 1
    print(f"{links} links on {len(pages)} pages, {broken} broken")
    return broken != 0


sys.exit(main())
