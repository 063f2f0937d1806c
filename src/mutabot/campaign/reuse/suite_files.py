"""The files of a test suite: which of them a test may depend on, told by what they mention of one another."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from mutabot.campaign.request import Request


@dataclass(frozen=True, slots=True)
class _TestFiles:
    """The test files: each counts for the mutants that its tests judge.

    Attributes:
        digests: all files that count.
        closures: test file to all test files whose names it mentions, itself included.
    """

    digests: Mapping[str, str]
    closures: Mapping[str, frozenset[str]]

    @classmethod
    def of(cls, request: Request, files: Mapping[str, str], tests: Iterable[str]) -> _TestFiles:
        """Those that hold these tests, bar what other files of the project mention."""
        configuration = request.configuration
        sources = (*configuration.program, *configuration.oracle)
        found = {_file_of(test, files) for test in tests} & set(files)
        found = {name for name in found if not any(_is_in(name, source) for source in sources)}
        by_stem: dict[bytes, set[str]] = {}
        for name in found:
            by_stem.setdefault(PurePosixPath(name).stem.encode(), set()).add(name)
        mentions = {name: _mentioned(request.root / name, by_stem) for name in files if name.endswith(".py")}
        closures = {name: frozenset(_closure(name, mentions)) for name in found}
        shared = {name for other in set(mentions) - found for name in mentions[other]}
        shared = {name for other in shared for name in closures[other]}
        return cls(files, {name: closures[name] for name in found - shared})

    def parts(self, tests: Iterable[str]) -> dict[str, str]:
        """The files of these tests with their digests."""
        files = {_file_of(test, self.digests) for test in tests}
        needed = {name for file in files for name in self.closures.get(file, ())}
        return {name: self.digests[name] for name in needed if name in self.closures}


def _file_of(test: str, files: Mapping[str, str]) -> str:
    """The test's file relative to the project's root; pytest's root may be a folder above."""
    name = test.partition("::")[0]
    while name not in files and "/" in name:
        name = name.partition("/")[2]
    return name


def _is_in(name: str, source: str) -> bool:
    return source in (".", name) or name.startswith(source + "/")


def _mentioned(path: Path, by_stem: Mapping[bytes, set[str]]) -> set[str]:
    """The test files whose names stand in a file: it may import them."""
    try:
        content = path.read_bytes()
    except OSError:
        return set()
    if b"test" not in content and all(b"test" in stem for stem in by_stem):
        return set()
    words = by_stem.keys() & set(re.findall(rb"\w+", content))
    return {name for word in words for name in by_stem[word]}


def _closure(name: str, mentions: Mapping[str, set[str]]) -> set[str]:
    found, waiting = {name}, [name]
    while waiting:
        new = mentions.get(waiting.pop(), set()) - found
        found |= new
        waiting.extend(new)
    return found
