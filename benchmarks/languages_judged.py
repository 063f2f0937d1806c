"""Do the engines find of a mutant of a robot program what plain pytest finds, with the program edited?

Mutants of the text of each program in ``examples/languages``, and of those in ``languages`` beside this
file, which have interrupts, two modules, data of their own and threads, run by an engine. For each, the
unified diff that ``mutabot diff`` shows is applied to a copy's file, line by line, and plain pytest runs the
program's tests on that copy, without Mutabot's plug-in, with the seed of the round.

Use: ``python benchmarks/languages_judged.py [--sample N] [--seed N] [--engine fork] [--only pick.mod …]
[--family program-conventional]``. The exit code is 1 if one verdict differs, or if there is nothing to
compare.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from mutabot_languages.core.text import decode  # noqa: E402
from mutabot_languages.mutation.command import mutant_id  # noqa: E402
from mutabot_languages.mutation.planning import PlannedText, planned_texts  # noqa: E402
from mutabot_languages.mutation.rules import BY_NAME  # noqa: E402
from suites.agreement import campaign, request_for, seeds_of  # noqa: E402
from suites.corpus import copied  # noqa: E402
from suites.editor import Facts  # noqa: E402

#: where programs are, and the files of each, the one that tests load first
PROGRAMS = {
    name: (folder, (name, *more))
    for folder, name, *more in (
        (ROOT / "examples" / "languages", "pick.script"),
        (ROOT / "examples" / "languages", "pick.mod"),
        (ROOT / "examples" / "languages", "pick.src", "pick.dat", "$config.dat"),
        (ROOT / "benchmarks" / "languages", "watch.script"),
        (ROOT / "benchmarks" / "languages", "watch.mod", "moves.sys"),
        (ROOT / "benchmarks" / "languages", "watch.src", "watch.dat"),
    )
}
FAMILIES = ["program-text", "program-conventional"]
#: what plain pytest has to say of a mutant with a verdict
EXPECTED = {
    "survived": "passes",
    "no effect": "passes",
    "not covered": "passes",
    "killed": "fails",
    "refused": "fails",
    "timeout": "fails",
}
_HUNK = re.compile(r"@@ -(\d+)")


def main() -> int:
    """Judge all programs that are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--sample", type=int, default=100, help="of so many mutants of each program")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument("--engine", default="fork")
    parser.add_argument("--only", nargs="*", default=[*PROGRAMS])
    parser.add_argument("--family", nargs="*", default=FAMILIES)
    given = parser.parse_args()
    same = other = 0
    for name in given.only:
        began = time.monotonic()
        agree, differ = compare(name, given.engine, given.sample, given.seed, given.family)
        same, other = same + agree, other + differ
        print(f"{name}: {agree} of {agree + differ} agree, {time.monotonic() - began:.0f} s", flush=True)
    print(f"{same} of {same + other} verdicts agree")
    return 0 if same and not other else 1


def compare(name: str, engine: str, sample: int, seed: int, families: list[str]) -> tuple[int, int]:
    """Judge a program; print what differs, and return how many verdicts agree and how many do not."""
    example, files = PROGRAMS[name]
    planned = [
        planned_text
        for planned_text in planned_texts(example, [*files])
        if planned_text.difference.reason is None
        and BY_NAME[planned_text.difference.operator].family in families
    ]
    chosen = random.Random(seed).sample(planned, min(sample, len(planned)))
    by_id = {mutant_id(planned_text): planned_text for planned_text in chosen}
    with tempfile.TemporaryDirectory() as folder:
        copy = copied(example, Path(folder).resolve() / "campaign")
        configure(copy, name)
        request = request_for(copy, engine, FAMILIES, 1, Facts.of(copy).hints.get("plugins", ()))
        data = campaign(request_of(request, [*by_id]))
        seeds = seeds_of({engine: data})
        same = other = 0
        for mutant in data["mutants"]:
            place = Path(folder).resolve() / f"judged {same + other}"
            edited = copied(example, place)
            configure(edited, name)
            plain = judged(edited, by_id[mutant["id"]], seeds)
            ours = str(mutant["rounds"][0]["verdict"])
            agrees = EXPECTED.get(ours) == plain
            same, other = same + agrees, other + (not agrees)
            if not agrees:
                print(f"  {mutant['id']}: {ours}, plain pytest {plain}", flush=True)
    return same, other


def request_of(request: Any, ids: list[str]) -> Any:
    """The request for these mutants alone."""
    from dataclasses import replace  # noqa: PLC0415

    return replace(request, only=tuple(ids))


def configure(copy: Path, name: str) -> None:
    """Let the copy have this program alone, and its tests run it."""
    settings, tests = copy / "pyproject.toml", copy / "tests" / "conftest.py"
    text = re.sub(
        r"program = \[.*\]", f"program = {[*PROGRAMS[name][1]]}", settings.read_text(encoding="utf-8")
    )
    settings.write_text(text, encoding="utf-8")
    text = re.sub(r"params=\[.*?\]", f'params=["{name}"]', tests.read_text(encoding="utf-8"))
    tests.write_text(text, encoding="utf-8")


def judged(copy: Path, planned_text: PlannedText, seeds: Mapping[str, int]) -> str:
    """What plain pytest says of a copy with the edited program: ``passes``, ``fails``, or how it ended."""
    apply(copy / planned_text.program.file, planned_text.program.diff(planned_text.difference))
    tests = copy / "tests" / "conftest.py"
    seed = (
        f"\n\n@pytest.fixture\ndef mutabot_seed(request: pytest.FixtureRequest) -> int:\n"
        f"    return {dict(seeds)!r}[request.node.nodeid]\n"
    )
    tests.write_text(tests.read_text(encoding="utf-8") + seed, encoding="utf-8")
    words = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:mutabot", "-p", "no:cacheprovider"]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(words, cwd=copy, env=environment, capture_output=True, text=True, check=False)
    ended = f"exit code {done.returncode}: {done.stdout[-400:]}"
    return {0: "passes", 1: "fails"}.get(done.returncode, ended)


def apply(file: Path, diff: list[str]) -> None:
    """Apply a unified diff without context to a file, as somebody would who edits it."""
    text, encoding = decode(file.read_bytes())
    lines = text.split("\n")
    found = _HUNK.match(diff[2])
    assert found is not None
    removed = [line[1:] for line in diff[3:] if line.startswith("-")]
    added = [line[1:] for line in diff[3:] if line.startswith("+")]
    first = int(found[1]) - 1
    assert lines[first : first + len(removed)] == removed, diff
    lines[first : first + len(removed)] = added
    file.write_bytes("\n".join(lines).encode(encoding))


if __name__ == "__main__":
    sys.exit(main())
