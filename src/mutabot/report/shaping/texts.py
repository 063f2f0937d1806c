"""Texts of programs under test, so that any format can hold them and none tells of the machine.

Formats only have to escape what is special in them.
"""

from __future__ import annotations

import re

#: XML and strict JSON cannot hold these: controls, halves of surrogate pairs, and what is no character at all
_UNFIT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufdd0-\ufdef\ufffe\uffff]")
_ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07]*\x07|.)")
#: an absolute path in one of the folders in which machines keep files; topics of ROS look like others
_ABSOLUTE = re.compile(
    r"(?<![\w.~/…-])(?:file://)?/(?:home|root|tmp|usr|opt|var|etc|mnt|srv|nix|workspace|workspaces|builds|github|"
    r"__w|Users|private|Volumes|Library)(?:/[^\s/:;,'\"<>()\[\]{}|]+)*/(?=[^\s/:;,'\"<>()\[\]{}|])"
)


def legible(text: str) -> str:
    """A text with a sign in the place of every character that a format could not hold; as long as before."""
    return _UNFIT.sub("\N{REPLACEMENT CHARACTER}", text)


def one_line(text: str) -> str:
    """A text without line breaks and repeated blanks."""
    return " ".join(text.split())


class Cleaner:
    """Makes messages fit for a report: legible, and with paths that say nothing of the machine.

    What lies in the project is named from its folder on, any other file by its last name: ``…/decoder.py``.
    """

    def __init__(self, root: str | None) -> None:
        folder = (root or "").rstrip("/")
        self._root = re.compile(rf"(?:file://)?{re.escape(folder)}(?:/|(?![\w.-]))") if folder else None

    def __call__(self, text: str) -> str:
        text = _ESCAPES.sub("", text)
        if self._root is not None:
            text = self._root.sub(lambda found: "" if found[0].endswith("/") else ".", text)
        return legible(_ABSOLUTE.sub("…/", text))
