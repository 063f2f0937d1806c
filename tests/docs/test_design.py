"""The page on how mutabot is built is held to the code: its picture, and every name in it."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

from rooms import SOURCE

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
_ROOMS = sorted({path.stem for path in SOURCE.iterdir() if path.suffix in {"", ".py"}} - {"__pycache__"})
#: a name in code that begins with one of our rooms
_NAME = re.compile(rf"`((?:{'|'.join(_ROOMS)})\.[A-Za-z_.]+)`")
NAMES = sorted({found for found in _NAME.findall(TEXT) if not found.endswith(".py")})


def test_the_picture_of_the_rooms_is_up_to_date() -> None:
    script = ROOT / "tools" / "make_design_page.py"
    done = subprocess.run([sys.executable, str(script), "--check"], check=False)
    assert done.returncode == 0, "run python tools/make_design_page.py"


def named(name: str) -> object:
    """What such a name stands for. Raises AttributeError or ModuleNotFoundError."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        module = ".".join(["mutabot", *parts[:count]])
        if (SOURCE / Path(*parts[:count])).is_dir() or (SOURCE / Path(*parts[:count])).with_suffix(
            ".py"
        ).is_file():
            found: object = importlib.import_module(module)
            for attribute in parts[count:]:
                found = getattr(found, attribute)
            return found
    raise ModuleNotFoundError(name)


@pytest.mark.parametrize("name", NAMES)
def test_every_name_on_the_page_is_one_in_the_code(name: str) -> None:
    assert named(name) is not None
