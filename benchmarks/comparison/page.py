"""Write docs/comparison.md, with its pictures, from measured comparisons.

    cd benchmarks
    python -m comparison.page paper=comparison.json …   store these, then write the page
    python -m comparison.page                           write it from what is stored
    python -m comparison.page --check                   exit with 1 if it is out of date

A file is what ``comparison.run`` prints; it is stored without the single mutants. Sentences follow from the
numbers by the rules of ``claims``. Without any stored comparison there is no page.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from .bars import FamilyBar, picture_of
from .claims import CLAIMS, CONVENTIONAL, Data, Finding, Stance, finding, percent, share_text
from .drawing import svg
from .ends import End

DOCS = Path(__file__).parents[2] / "docs"
#: the order of the page; other names follow by alphabet
ORDER = ("paper", "pick_and_place", "scales")

#: of the table of numbers
_COLUMNS = (
    "program: family · role", "mutants", "places", "score", "check score", "without an oracle", "trivial",
    "informative", "redundant, dominators of killed", "processor time in s, per informative mutant",
    "joint dominators, alone",
)  # fmt: skip

HEAD = """\
# Do conventional operators suit robot programs?

<!-- Written by benchmarks/comparison/page.py from docs/data/*.json. Do not edit. -->

The study "Mutation Testing for Industrial Robotic Systems" says, without figures, that conventional
mutation operators suit robot programs badly. `make comparison` measured it on the examples.
[Comparing families](compare.md) explains the terms.

A share speaks *for* a claim if its difference from the robot family's, in percentage points with a 95 %
interval, lies wholly above zero, *against* it if wholly below, else *undecided*; of places the larger number
decides. *Not measured*: no mutants there, or a sample does not tell the number of places.
"""
TAIL = """\
## Limits of this comparison

- The programs are small, and calculate little.
- *Refused* and *indistinguishable* are as good as each example's refusals and probes.
- Mutants that would change nothing in the baseline were left out.
- *Informative* counts mutants that no test reaches: one missing test, many times.
- A mutant that tells suites apart need not be like a fault that engineers make.
"""


class PageError(Exception):
    """The page cannot be written; the text says why."""


def store(name: str, source: Path, folder: Path) -> None:
    """Keep a comparison under a name, without the single mutants."""
    data = _read(source)
    if not data.get("finished"):
        raise PageError(f"{source}: that campaign was {data.get('state')}; only complete ones are compared")
    folder.mkdir(parents=True, exist_ok=True)
    kept = {key: value for key, value in data.items() if key != "mutants"}
    text = json.dumps(kept, indent=1, ensure_ascii=False)
    (folder / f"{name}.json").write_text(text + "\n", encoding="utf-8")


def store_all(arguments: Sequence[str], folder: Path) -> None:
    """Keep each of ``NAME=FILE``."""
    for argument in arguments:
        name, _, source = argument.partition("=")
        if not source or not name.isidentifier():
            raise PageError(f"{argument!r} is not NAME=FILE")
        store(name, Path(source), folder)


def load(folder: Path) -> dict[str, Data]:
    """The stored comparisons by name, in the order of the page."""
    files = {file.stem: file for file in sorted(folder.glob("*.json"))}
    names = [*(name for name in ORDER if name in files), *(name for name in files if name not in ORDER)]
    return {name: _read(files[name]) for name in names}


def pages(comparisons: Mapping[str, Data]) -> dict[str, str]:
    """Path below docs -> text, of the page and its pictures."""
    return {
        "comparison.md": page(comparisons),
        **{f"img/comparison-{name}.svg": picture(data, name) for name, data in comparisons.items()},
    }


def page(comparisons: Mapping[str, Data]) -> str:
    """The text of the page."""
    lines = [HEAD, *_claims(comparisons)]
    lines += _numbers(comparisons)
    return "\n".join([*lines, TAIL])


def picture(data: Data, name: str) -> str:
    """The ends of each family as bars."""
    bars = [
        FamilyBar(
            family["family"],
            f"{family['role']} · {family['mutants']} mutants",
            {End(end): share["count"] for end, share in family["ends"].items()},
        )
        for family in data["families"]
    ]
    return svg(picture_of(bars, f"What became of the mutants: {name}"), by="make comparison")


def _claims(comparisons: Mapping[str, Data]) -> Iterator[str]:
    yield from ("## In short", "")
    yield from (f"- *{claim.name}*: {claim.statement}" for claim in CLAIMS)
    yield ""
    yield _row("claim", "family", *comparisons)
    yield f"|{'---|' * (2 + len(comparisons))}"
    for claim in CLAIMS:
        for family in CONVENTIONAL:
            found = (finding(claim, data, family) for data in comparisons.values())
            yield _row(claim.name, family, *(_shown(judged) for judged in found))
    yield ""


def _numbers(comparisons: Mapping[str, Data]) -> Iterator[str]:
    yield from ("## The numbers", "")
    for name, data in comparisons.items():
        yield from (f"{name}: {_circumstances(data)}", "")
        yield from (f"![ends of the mutants of {name}](img/comparison-{name}.svg)", "")
    yield _row(*_COLUMNS)
    yield f"|---|{'---:|' * (len(_COLUMNS) - 1)}"
    for name, data in comparisons.items():
        for family in data["families"]:
            if family["mutants"]:
                yield _row(
                    f"{name}: {family['family']} · {family['role']}", *_cells(family, data["together"])
                )
    yield ""


def _cells(family: Mapping[str, Any], together: Mapping[str, Any]) -> Iterator[str]:
    yield from (str(family[key]) for key in ("mutants", "places"))
    yield _score(family["scores"], "score", "killed")
    yield _score(family["scores"], "check_score", "by_check")
    yield _score(family["without_oracle"], "score", "killed")
    yield from (share_text(family[key]) for key in ("trivial", "informative"))
    yield f"{family['redundant']}, {family['dominators']} of {family['killed_mutants']}"
    cpu, informative = family["cost"]["cpu"], family["informative"]["count"]
    yield f"{_seconds(cpu)}, {f'{cpu / informative:.2g}' if informative else '–'}"
    is_known = together["dominators"] and not together["unknown_mutants"]
    yield f"{family['joint']}/{together['dominators']}, {family['alone']}" if is_known else "–"


def _circumstances(data: Data) -> str:
    meta = data["meta"]
    parts = [f"{meta['rounds']} rounds", f"seed {meta['seed']}", meta["engine"]]
    parts += [f"{meta['jobs']} processes"] if meta.get("jobs") else []
    if meta.get("seconds"):
        parts.append(f"{meta['seconds']:.0f} s")
    parts += [f"mutabot {meta['mutabot']}", f"Python {meta['python']}"]
    if data["sample"] is not None:
        size = data["sample"]["size"]
        parts.append(f"a sample ({size}) of {data['sample']['selected']} mutants")
    if meta.get("started"):
        parts.append(f"{datetime.fromtimestamp(meta['started'], UTC):%Y-%m-%d}")
    return f"{', '.join(parts)}."


def _score(scores: Mapping[str, Any] | None, key: str, counted: str) -> str:
    if scores is None or scores[key] is None:
        return "–"
    interval = scores[{"score": "interval", "check_score": "check_interval"}[key]]
    between = f" ({100 * interval['low']:.0f}–{100 * interval['high']:.0f})" if interval else ""
    return f"{scores[counted]}/{scores['valid']}, {percent(scores[key])}{between}"


def _seconds(seconds: float | None) -> str:
    return "–" if seconds is None else f"{seconds:.1f}"


def _shown(judged: Finding) -> str:
    if judged.stance is Stance.UNKNOWN:
        return judged.stance.value
    word = judged.stance.value if judged.stance is Stance.UNDECIDED else f"**{judged.stance}**"
    return f"{word}: {judged.sentence}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def _read(file: Path) -> dict[str, Any]:
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise PageError(f"{file} cannot be read: {error}") from error
    if not isinstance(data, dict) or not {"families", "together", "meta"} <= set(data):
        raise PageError(f"{file} is not what `python -m comparison.run` prints")
    return data


def main(arguments: Sequence[str], docs: Path = DOCS) -> int:
    """Store, write or check; returns the exit code."""
    folder, check = docs / "data", list(arguments) == ["--check"]
    try:
        store_all([] if check else arguments, folder)
        comparisons = load(folder)
    except PageError as error:
        print(error, file=sys.stderr)
        return 2
    if check:
        return int(_is_outdated(pages(comparisons) if comparisons else {}, docs))
    if not comparisons:
        print(f"there is no comparison in {folder}, and so no page", file=sys.stderr)
        return 0
    for path, text in pages(comparisons).items():
        (docs / path).parent.mkdir(parents=True, exist_ok=True)
        (docs / path).write_text(text, encoding="utf-8")
    return 0


def _is_outdated(wanted: Mapping[str, str], docs: Path) -> bool:
    """Whether a file is missing, differs, or is there without data."""
    if not wanted:
        return (docs / "comparison.md").exists()
    files = ((docs / path, text) for path, text in wanted.items())
    return any(not file.is_file() or file.read_text(encoding="utf-8") != text for file, text in files)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
