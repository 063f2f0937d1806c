"""Hold two records of ``witness.py`` against each other: plans, what is left out, and every outcome.

    python benchmarks/same_results.py RECORDED FOLDER [--show 20] [--renamed OLD=NEW]

The exit code is 1 if anything differs, and if there is nothing to compare.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from witness import read


def differences(first: Mapping[str, Any], second: Mapping[str, Any]) -> Iterator[str]:
    """What differs between two records of a project, a line each."""
    for part in ("plan", "left_out"):
        before, after = dict(first[part]), dict(second[part])
        yield from (f"{part}: {gone} is gone" for gone in before if gone not in after)
        yield from (f"{part}: {new} is new" for new in after if new not in before)
        for name, text in before.items():
            if name in after and text != after[name]:
                yield f"{part}: {name}: {text!r} → {after[name]!r}"
        if list(before) != list(after) and set(before) == set(after):
            yield f"{part}: the order differs"
    before, after = first["outcomes"], second["outcomes"]
    yield from (f"{gone}: was run and is not" for gone in before if gone not in after)
    yield from (f"{new}: is run and was not" for new in after if new not in before)
    for name, facts in before.items():
        for key, fact in facts.items() if name in after else ():
            if _lasting(fact) != _lasting(after[name].get(key)):
                yield f"{name}: {key} {fact!r} → {after[name].get(key)!r}"


def _lasting(fact: Any) -> Any:
    """A fact without what was seen along the way: how often that is looked at depends on processor time."""
    if not isinstance(fact, list):
        return fact
    return [line for line in fact if not str(line).startswith("on the way")]


def renamed(value: Any, names: Mapping[str, str]) -> Any:
    """A record with other names in its texts."""
    if isinstance(value, str):
        for old, new in names.items():
            value = value.replace(old, new)
    elif isinstance(value, list):
        value = [renamed(part, names) for part in value]
    elif isinstance(value, dict):
        value = {renamed(key, names): renamed(part, names) for key, part in value.items()}
    return value


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("recorded", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--show", type=int, default=20, help="differences to show of each project")
    parser.add_argument(
        "--renamed",
        action="append",
        default=[],
        metavar="OLD=NEW",
        help="what is called otherwise since then",
    )
    given = parser.parse_args()
    names = dict(pair.split("=", 1) for pair in given.renamed)
    compared = different = 0
    for file in sorted(given.folder.glob("*.json.gz")):
        name = file.name.removesuffix(".json.gz")
        first, second = renamed(read(given.recorded / file.name), names), read(file)
        compared += len(second["outcomes"])
        found = list(differences(first, second))
        different += len(found)
        if found:
            print(f"{name}: {len(found)} differences", *found[: given.show], sep="\n  ")
    print(f"{compared} outcomes compared, {different} differences")
    return 0 if compared and not different else 1


if __name__ == "__main__":
    sys.exit(main())
