"""The pages of the documentation: which there are, how they are grouped, and what stands in them.

The Markdown files are the source of all of it; the navigation is the table under `Documentation` in
README.md. Used by the site (``tools/site/conf.py``) and by the tests.
"""

from __future__ import annotations

import posixpath
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).parents[1]
HOME = "README.md"
#: what of the repository is a page, below ROOT
PATTERNS = (HOME, "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "docs/**/*.md", "examples/*/README.md")
_MARKDOWN = MarkdownIt("commonmark").enable("table")


@dataclass(frozen=True, slots=True)
class Block:
    """A block of code: its language (empty if the page names none), text, and first line from 1."""

    language: str
    text: str
    line: int


def pages() -> list[str]:
    """The paths of all pages, below ROOT, with slashes."""
    return sorted({path.relative_to(ROOT).as_posix() for pattern in PATTERNS for path in ROOT.glob(pattern)})


def navigation() -> dict[str, list[tuple[str, str]]]:
    """Group -> the titles and pages of it, in their order."""
    tokens = tokens_of((ROOT / HOME).read_text(encoding="utf-8"))
    (start,) = (at for at, token in enumerate(tokens) if token.content == "Documentation")
    groups: dict[str, list[tuple[str, str]]] = {}
    group = ""
    for token in tokens[start + 1 :]:
        if token.type == "heading_open":
            break
        if token.type == "inline" and token.content.startswith("**"):
            group = token.content.strip("*")
        elif token.type == "inline" and group:
            groups.setdefault(group, []).extend(_links(token))
    return groups


@cache
def tokens_of(text: str) -> list[Token]:
    """A page's text as CommonMark with tables, which is what GitHub and the site read."""
    return _MARKDOWN.parse(text)


def blocks(text: str) -> list[Block]:
    """All blocks of code, also those in lists."""
    return [
        Block(token.info.strip(), token.content, (token.map or [0])[0] + 1)
        for token in tokens_of(text)
        if token.type in {"fence", "code_block"}
    ]


def codes(text: str) -> list[str]:
    """What stands between backticks within sentences and tables."""
    return [child.content for child in _inner(text) if child.type == "code_inline"]


def links(text: str) -> list[str]:
    """Where a page's links lead."""
    return [str(child.attrs["href"]) for child in _inner(text) if child.type == "link_open"]


def pictures(text: str) -> list[str]:
    """Which pictures a page shows."""
    return [str(child.attrs["src"]) for child in _inner(text) if child.type == "image"]


def anchors(text: str) -> list[str]:
    """The headings of a page as links name them. GitHub and the site have the same rule."""
    seen: Counter[str] = Counter()
    found = []
    tokens = tokens_of(text)
    for before, token in pairwise(tokens):
        if before.type != "heading_open":
            continue
        title = "".join(child.content for child in token.children or () if child.type != "image")
        slug = re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")
        found.append(f"{slug}-{seen[slug]}" if seen[slug] else slug)
        seen[slug] += 1
    return found


def leads_to(page: str, target: str) -> tuple[str, str]:
    """The path below ROOT, and the anchor, to which a relative link of a page leads."""
    path, _, anchor = target.partition("#")
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page, anchor


def _inner(text: str) -> Iterator[Token]:
    for token in tokens_of(text):
        yield from token.children or ()


def _links(token: Token) -> Iterator[tuple[str, str]]:
    for child, title in pairwise(token.children or ()):
        if child.type == "link_open":
            yield title.content, str(child.attrs["href"])
