"""Versions of everything on this machine that may influence a simulation."""

from __future__ import annotations

import json
import platform
import sys
from email.parser import HeaderParser
from functools import cache, lru_cache
from importlib.metadata import Distribution, distributions
from pathlib import Path

import mutabot
from mutabot.model.source_units import digest

#: installed packages that have no say in how a test ends
_TOOLS = {"black", "hatchling", "isort", "mypy", "pip", "pre-commit", "ruff", "setuptools", "uv", "wheel"}
#: parts of mutabot on which outcomes depend
_PARTS = ("model", "operators", "runtime", "campaign", "execution")


def versions() -> dict[str, str]:
    """Return the versions of Python, the machine, mutabot, and all installed packages, by name."""
    found = {
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "machine": f"{sys.platform} {platform.machine()}",
    }
    for distribution in distributions():
        name, version = name_and_version(distribution)
        if name and name not in _TOOLS and name != "mutabot":
            found.setdefault(name, version)
    return {**found, "mutabot": mutabot.__version__, "mutabot's own code": f"#{_own_code()}"}


def name_and_version(distribution: Distribution) -> tuple[str, str]:
    """Return the name of a distribution, in lower case, and its version; empty for what it does not say.

    ``distribution.metadata`` parses the long description as well, which takes seven times as long.
    """
    texts = (distribution.read_text(file) for file in ("METADATA", "PKG-INFO", ""))
    return _in_headers(next(filter(None, texts), "").replace("\r\n", "\n").partition("\n\n")[0])


@lru_cache(maxsize=4096)
def _in_headers(text: str) -> tuple[str, str]:
    """Return the name and the version in the headers of a distribution, which a campaign asks for twice."""
    headers = HeaderParser().parsestr(text)
    return (headers["Name"] or "").lower(), headers["Version"] or ""


@cache
def _own_code() -> str:
    """Return a digest of mutabot's own code, where the version alone does not identify it.

    It is that of this process, however many campaigns it runs.
    """
    home = Path(mutabot.__file__).parent
    places = (*(home / part for part in _PARTS), *home.parent.glob("mutabot_*"))
    files = sorted(file for place in places for file in place.rglob("*.py"))
    found = [(file.relative_to(home.parent).as_posix(), digest(file.read_bytes())) for file in files]
    return digest(json.dumps(found).encode())
