"""How right are the vocabularies that `mutabot init` drafts for libraries of others?

    python benchmarks/drafts.py [--show] [NAME ...]

For each file in `benchmarks/drafts`: writes its program and its tests to a folder, runs `mutabot init` there
without the vocabularies that come with mutabot, and holds the draft against what a careful engineer would
write (`expected`, with the reason above it). Counts operations and quantities: right, wrong, asked (a comment
with a question) and missing. Install the packages that the files name, and mutabot, in a throw-away
environment, and run this with its Python; what cannot be imported is told as not measured. Exits with 1 if
more than 1 in 20 of the proposed lines is wrong.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mutabot_init.propose
from mutabot.config.vocabulary import load_vocabulary
from mutabot.model import Vocabulary
from mutabot_init.propose import propose

FOLDER = Path(__file__).parent / "drafts"
#: wrong among all proposed lines, at most
_MOST_WRONG = 1 / 20
#: what says the same of a number within a range
_SAME = {"ratio": "output"}


def main() -> int:
    """All libraries that are named, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="libraries; without any, all")
    parser.add_argument("--show", action="store_true", help="print the drafts and what differs")
    given = parser.parse_args()
    mutabot_init.propose.shipped_vocabularies = tuple  # type: ignore[attr-defined]
    names = given.names or sorted(path.stem for path in FOLDER.glob("*.toml"))
    title = "operations: right | wrong | missing | quantities: right | wrong | asked | missing"
    print(f"| library | {title} | edits |\n|{'---|' * 9}")
    total: Counter[str] = Counter()
    measured = 0
    for name in names:
        found = _measured(tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8")), given.show)
        if found is None:
            print(f"| {name} | not measured | | | | | | | |")
            continue
        print(_row(name, found))
        total += found
        measured += 1
    print(_row(f"**{measured} libraries**", total))
    right, wrong = (
        sum(total[f"{what} {how}"] for what in ("operation", "quantity")) for how in ("right", "wrong")
    )
    print(f"\nwrong: {wrong} of {right + wrong} proposed lines ({100 * wrong / max(1, right + wrong):.1f} %)")
    return int(wrong > _MOST_WRONG * (right + wrong))


def _row(name: str, found: Counter[str]) -> str:
    keys = [f"operation {how}" for how in ("right", "wrong", "missing")]
    keys += [f"quantity {how}" for how in ("right", "wrong", "asked", "missing")]
    edited = sum(found[key] for key in keys if not key.endswith("right"))
    return f"| {name} | {' | '.join(str(found[key]) for key in keys)} | {edited} |"


def _measured(library: dict[str, Any], show: bool) -> Counter[str] | None:
    """What is right and wrong in the draft; None if the tests do not run here."""
    with tempfile.TemporaryDirectory(prefix="drafts-") as home:
        folder = Path(home)
        for name, text in (
            ("program.py", "program"),
            ("test_program.py", "test"),
            ("expected.toml", "expected"),
        ):
            (folder / name).write_text(library[text], encoding="utf-8")
        told = propose(folder, [folder / "program.py"])
        if not any(line.startswith("tests: ") and " passed" in line for line in told):
            print("\n".join(told), file=sys.stderr)
            return None
        draft = (folder / "robot.toml").read_text(encoding="utf-8")
        has_operations = any(line.startswith("[[operation]]") for line in draft.splitlines())
        ours = load_vocabulary(["robot.toml"], folder) if has_operations else Vocabulary()
        found, differences = _compared(ours, load_vocabulary(["expected.toml"], folder), draft)
    if show:
        print("\n".join([*told, draft, *differences]))
    return found


def _compared(ours: Vocabulary, expected: Vocabulary, draft: str) -> tuple[Counter[str], list[str]]:
    found: Counter[str] = Counter()
    differences = []
    mine, wanted = ({one.target for one in vocabulary.operations} for vocabulary in (ours, expected))
    found.update({"operation right": len(mine & wanted), "operation wrong": len(mine - wanted)})
    found["operation missing"] = len(wanted - mine)
    differences += [f"wrong operation: {one}" for one in mine - wanted]
    differences += [f"missing operation: {one}" for one in wanted - mine]
    drafted, meant = dict(_quantities(ours)), dict(_quantities(expected))
    for key, value in drafted.items():
        is_right = key in meant and _agree(value, meant[key])
        found["quantity right" if is_right else "quantity wrong"] += 1
        if not is_right:
            differences.append(f"wrong: {key} is {value}, expected {meant.get(key)}")
    for key in meant.keys() - drafted.keys():
        asked = _is_asked(key, draft)
        found["quantity asked" if asked else "quantity missing"] += 1
        differences.append(f"{'asked' if asked else 'missing'}: {key}: {meant[key]}")
    return found, differences


def _quantities(vocabulary: Vocabulary) -> Iterator[tuple[tuple[str, str, str], dict[str, Any]]]:
    for operation in vocabulary.operations:
        places = [("arguments", operation.arguments), ("result", operation.result)]
        for pattern in operation.patterns:
            places += [(pattern.text, pattern.arguments), (pattern.text, pattern.result)]
        for table, quantities in places:
            for one in quantities:
                says = {key: getattr(one, key) for key in ("kind", "axis", "unit", "mode", "values", "range")}
                yield (
                    (operation.target, table, str(one.name)),
                    {key: value for key, value in says.items() if value},
                )


def _agree(drafted: dict[str, Any], meant: dict[str, Any]) -> bool:
    if "range" in meant and drafted.get("range") and drafted["kind"] != meant["kind"]:
        kinds = {_SAME.get(str(one["kind"]), str(one["kind"])) for one in (drafted, meant)}
        return len(kinds) == 1 and tuple(drafted["range"]) == tuple(meant["range"])
    if set(drafted.get("values") or ()) != set(meant.get("values") or ()):
        return False
    return all(drafted.get(key) == value for key, value in meant.items() if key != "values")


def _is_asked(key: tuple[str, str, str], draft: str) -> bool:
    """Whether the block of an operation has a question about what holds this quantity."""
    target, table, name = key
    block = next((one for one in draft.split("[[operation]]") if f'call = "{target}"' in one), "")
    root = name.partition("[")[0] if table == "arguments" else ""
    return any(
        "question: " in line
        and line.lstrip("# ").startswith((f"{table}.{root}", f'{table}."{root}', f"{table} ="))
        for line in block.splitlines()
    )


if __name__ == "__main__":
    sys.exit(main())
