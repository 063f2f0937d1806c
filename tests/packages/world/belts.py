"""A project with a toy world: a sledge on a belt, whose tests notice less than all that goes wrong."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

from tests.plugins.test_plugins import mutabot

FILES = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["mission.py"]
        vocabulary = ["belt.toml"]
        families = ["world"]

        [tool.mutabot.world]
        of = ["belt:Belt"]
        """,
    "belt.toml": """
        clock = { tick = "belt:Belt.advance", unit = "s" }

        [[probe]]
        call = "belt:where"
        tolerance = 0.001
        """,
    "belt.py": """
        _last = None


        class Belt:
            def __init__(self):
                global _last
                self.time, self.position, self.speed, self.grip = 0.0, 0.0, 1.0, {"pads": [1.0]}
                _last = self

            def advance(self):
                self.time += 0.1
                self.position += 0.1 * self.speed * self.grip["pads"][0]
                return self.time


        def where():
            return {} if _last is None else {"sledge": _last.position}


        def heavier(belt, change, *, names, random, share=1.0):
            if names != "sledge":
                raise LookupError(f"nothing is named {names!r}; there is: sledge")
            belt.grip["pads"][0] -= share * change(0.0)


        def is_far(belt):
            return belt.position > 1.0
        """,
    "mission.py": """
        import belt


        def drive(seconds, on=None):
            here = on or belt.Belt()
            end = here.time + seconds - 0.05
            while here.time < end:
                here.advance()
            return here.position
        """,
    "conftest.py": "",
    "tests/test_mission.py": """
        import mission


        def test_a_short_way():
            assert mission.drive(0.5) < 1.0


        def test_a_long_way():
            assert abs(mission.drive(3.0) - 3.0) < 0.6


        def test_no_world():
            assert mission.__name__ == "mission"
        """,
}
SHORT, LONG = "tests/test_mission.py::test_a_short_way", "tests/test_mission.py::test_a_long_way"


def project(folder: Path, parameters: str, **files: str) -> Path:
    """Write the project with these parameters in its configuration, and these files beside or instead."""
    texts = {name: dedent(text).lstrip("\n") for name, text in {**FILES, **files}.items()}
    texts["pyproject.toml"] += "\n" + dedent(parameters)
    for name, text in texts.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return folder


def run(folder: Path, *options: str, code: int = 0) -> dict[str, dict[str, Any]]:
    """Run a campaign, and return what `mutabot world` tells of all tests together; see ``told``."""
    done = mutabot(None, folder, "run", "--json", "--fresh", *options)
    assert done.returncode == code, done.stderr
    return told(folder)


def told(folder: Path, *options: str, of: str = "parameters") -> dict[str, dict[str, Any]]:
    """What `mutabot world` tells, by parameter and direction, such as ``speed -``.

    ``of``: ``parameters`` for all tests together; a node id for one test.
    """
    done = mutabot(None, folder, "world", "--json", *options)
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    rows = [row for row in data["tests"] if row["tests"] == [of]] or data[of]
    return {f"{row['parameter']} {row['direction']}".strip(): row for row in rows}
