"""The folder of a report: pages, their data and what shows them; nothing of a user's is ever overwritten."""

from __future__ import annotations

import json
import re
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.journal.files import REPORT_MARK
from mutabot.model import By
from mutabot.report.document import data_of, finite
from mutabot.report.format import place_of, utf16
from mutabot.report.terminal.console import mark_of
from mutabot.report.terminal.suggested import check_on_page
from mutabot.report.texts import status_of, why_alone
from mutabot.results.results import MutantResult, Results, killers, unlooked
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import Suggestions
from mutabot.results.thresholds import line_of, thresholds_of

from .mutant import Recorded, mutant_page

#: items of a list of what was left out, per reason
_ITEMS = 50
#: lines of ladders; `mutabot thresholds` has all
_LADDERS = 200
_META = ("mutabot", "python", "versions", "seed", "engine", "families", "started", "seconds")


def campaign_data(campaign: Results, name: str) -> dict[str, Any]:
    """All of it but sources and the pages of mutants.

    Args:
        name: what the project is called.
    """
    rows = Rows(campaign)
    return {
        "name": name,
        **data_of.facts(
            campaign,
            "state attempt done planned rounds groups controls verification repeats drawing "
            "flaky=flaky.tests confirmed=confirmation.text",
        ),
        "meta": {key: campaign.meta[key] for key in _META if key in campaign.meta},
        "operators": dict(campaign.operators),
        "files": rows.files,
        "tests": rows.tests,
        "baseline": _baseline(campaign, rows.tests),
        "sites": rows.sites,
        "columns": rows.columns,
        "mutants": rows.rows,
        "unlooked": [
            [*one.places[:3], one.operation, one.quantity, one.text] for one in unlooked(campaign.mutants)
        ],
        "ladders": [
            [f"{one.place} {one.name}", line_of(one)] for one in thresholds_of(campaign).ladders[:_LADDERS]
        ],
        "leftOut": _left_out(campaign),
    }


def _baseline(campaign: Results, tests: list[str]) -> list[list[Any]]:
    """Per test: its outcomes on the original that occurred, and its simulated seconds."""
    found: dict[str, list[Any]] = {name: [[], None] for name in tests}
    for one in campaign.baseline:
        ends, seconds = found[one.test.test]
        if one.test.outcome not in ends:
            ends.append(one.test.outcome)
        found[one.test.test][1] = seconds if one.test.simulated is None else one.test.simulated
    return list(found.values())


def _left_out(campaign: Results) -> list[list[Any]]:
    left_out = campaign.left_out
    reasons = Counter(one.reason for one in left_out)
    return [
        [reason, count, [[one.id, one.description] for one in left_out if one.reason == reason][:_ITEMS]]
        for reason, count in reasons.most_common()
    ]


class Rows:
    """Rows that name what they share by numbers.

    Attributes:
        files: paths of sources.
        tests: node ids of all tests that are known.
        sites: the tests that reach a site, as numbers, by the number of the site.
        columns: the names of the cells of a row.
        rows: one row per mutant.
    """

    def __init__(self, campaign: Results) -> None:
        self._campaign = campaign
        self.tests = campaign.tests
        self._tests = {name: number for number, name in enumerate(self.tests)}
        self._files: dict[str, int] = {}
        self._sites: dict[str, int] = {}
        self.sites: list[list[int]] = []
        made = [self._row(one) for one in campaign.mutants]
        self.columns = [*made[0]] if made else []
        self.rows = [[*one.values()] for one in made]
        self.files = [*self._files]

    def _row(self, result: MutantResult) -> dict[str, Any]:
        span, status = result.mutant.site.span, status_of(result)
        place = place_of(span, self._campaign.source(span.file), utf16)
        return {
            **data_of.facts(result, "number=mutant.number id=mutant.id"),
            "file": self._files.setdefault(span.file, len(self._files)),
            **data_of.facts(place, "line column endLine=end_line endColumn=end_column"),
            **data_of.facts(
                result,
                "function=mutant.site.span.function operation=mutant.operation quantity=mutant.quantity "
                "unit=quantity.unit operator=mutant.operator variant=mutant.variant family=mutant.family "
                "role=mutant.site.role description=mutant.description killed=kill_rate.killed "
                "valid=kill_rate.valid worst indistinguishable",
            ),
            "ends": "".join(mark_of(one).letter for one in result.rounds),
            "status": status.value if status is not None else "not run",
            "why": why_alone(result),
            "site": self._site(result),
            "kills": self._kills(result),
            "earlier": result.earlier or result.outdated,
            "drawn": _drawn(result) if result.mutant.operator in self._campaign.draws else None,
        }

    def _site(self, result: MutantResult) -> int:
        """The number of the site, and the tests that reach it."""
        key = result.mutant.site.id
        if key not in self._sites:
            self._sites[key] = len(self.sites)
            self.sites.append([self._tests[test] for test in self._campaign.reached_by(result.mutant)])
        return self._sites[key]

    def _kills(self, result: MutantResult) -> list[list[int]]:
        """The tests that are known to notice it: number, in how many rounds, in how many by a check."""
        found: dict[int, list[int]] = {}
        for outcome in result.outcomes:
            for test, by in dict(killers(outcome)).items():
                counts = found.setdefault(self._tests[test], [0, 0])
                counts[0] += 1
                counts[1] += by is By.CHECK
        return [[test, *counts] for test, counts in found.items()]


def _drawn(result: MutantResult) -> Sequence[Sequence[Any]]:
    """What was drawn where it first acted, per round: the round, the value before, and after."""
    found = ((number, one.example) for number, one in enumerate(result.rounds) if one is not None)
    pairs = [(number, *pair) for number, pair in found if pair is not None and len(pair) == 2]
    return [one for one in pairs if all(isinstance(value, int | float) for value in one[1:])]


_MARK_TEXT = (
    "A report of mutabot: open index.html. `mutabot report --html` replaces it, and leaves clips/ alone.\n"
)
#: what a report consists of, beside clips/
_PAGE, _ASSETS, _DATA, _CLIPS = "index.html", "assets", "data", "clips"
#: bytes that all data may take; recordings make room
LIMIT = 23_000_000
#: clips and pictures of a mutant are named by its number: 12.mp4, 12-side.png
_CLIP = re.compile(r"(\d+)(?:[-_. ].*)?\.(mp4|webm|gif|png|jpe?g|svg|webp)", re.IGNORECASE)


@frozen
class Written:
    """What was written.

    Attributes:
        page: the page to open.
        size: bytes of all files.
        without: recordings for which there was no room.
    """

    page: Path
    size: int
    without: int


@frozen
class Contents:
    """What a report is made from.

    Attributes:
        campaign: the campaign, fit to leave the machine.
        name: what the project is called.
        evidence: its recordings.
        clean: makes texts of recordings fit to leave the machine.
        suggestions: the checks that were suggested for its survivors; None if none were looked for.
    """

    campaign: Results
    name: str
    evidence: StoredEvidence
    clean: Callable[[str], str]
    suggestions: Suggestions | None = None


def check_folder(folder: Path) -> None:
    """Raise UsageError for a folder that a report must not be written into."""
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"the report {folder} cannot be written: it is a file; --html takes a folder")
    found = {one.name for one in folder.iterdir()} - {_CLIPS} if folder.is_dir() else set()
    if found and REPORT_MARK not in found:
        raise UsageError(
            f"the report {folder} cannot be written: the folder holds other files, such as {min(found)}; "
            "name a new or empty folder, or one with an older report"
        )


def write_folder(folder: Path, contents: Contents, limit: int = LIMIT) -> Written:
    """Write the report; an older one in the folder is replaced. Raises UsageError if it cannot be.

    Args:
        limit: bytes that all data may take; recordings that have no room are left out.
    """
    check_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / REPORT_MARK).write_text(_MARK_TEXT, encoding="utf-8")
        for name in (_ASSETS, _DATA):
            shutil.rmtree(folder / name, ignore_errors=True)
            (folder / name).mkdir()
        without = _write_data(folder / _DATA, contents, _clips(folder / _CLIPS), limit)
        _copy_assets(folder)
    except OSError as error:
        raise UsageError(f"the report {folder} cannot be written: {error.strerror}") from error
    size = sum(one.stat().st_size for one in folder.rglob("*") if one.is_file())
    return Written(folder / _PAGE, size, without)


def _copy_assets(folder: Path) -> None:
    for one in files(__package__).joinpath(_ASSETS).iterdir():
        target = folder / one.name if one.name == _PAGE else folder / _ASSETS / one.name
        if one.is_file():
            target.write_bytes(one.read_bytes())


def _write_data(folder: Path, contents: Contents, clips: Mapping[int, list[str]], limit: int) -> int:
    campaign = contents.campaign
    used = _write(folder / "campaign.js", "campaign", campaign_data(campaign, contents.name))
    used += _write(
        folder / "sources.js", "sources", [[file, text] for file, text in campaign.sources.items()]
    )
    for name in ("mutants", "originals"):
        (folder / name).mkdir()
    for result in campaign.mutants:
        number = result.mutant.number
        page = {
            **mutant_page(result),
            "suggestion": check_on_page(result, contents.suggestions),
            "media": clips.get(number, []),
        }
        used += _write(folder / "mutants" / f"{number}.js", f"mutant {number}", page)
    recorded = Recorded(contents.evidence, contents.clean)
    found, without = _recordings(recorded, campaign.worst_first, limit - used)
    for number in found.keys() | without.keys():
        data = {"recordings": found.get(number, []), "without": without.get(number, 0)}
        with (folder / "mutants" / f"{number}.js").open("ab") as file:
            file.write(_bytes(f"recordings {number}", data))
    for number, original in enumerate(recorded.originals.values()):
        _write(folder / "originals" / f"{number}.js", f"original {number}", original)
    return sum(without.values())


def _recordings(
    recorded: Recorded, results: Iterable[MutantResult], limit: int
) -> tuple[dict[int, list[Any]], dict[int, int]]:
    """The recordings of each mutant by its number, one of each before a second of any; and how many are left.

    When one has no room, those behind it have none either.
    """
    results = [*results]
    waiting = {one.mutant.number: recorded.of(one) for one in results}
    found: dict[int, list[Any]] = {}
    used = 0
    while waiting and used < limit:
        for number, those in [*waiting.items()]:
            one = next(those, None)
            if one is None:
                del waiting[number]
                continue
            used += len(_bytes("", one))
            if used > limit:
                break
            found.setdefault(number, []).append(one)
    counts = {
        one.mutant.number: recorded.count(one) - len(found.get(one.mutant.number, ())) for one in results
    }
    return found, {number: count for number, count in counts.items() if count}


def _clips(folder: Path) -> dict[int, list[str]]:
    """Clips and pictures that lie there already, by the number of the mutant that they are named for."""
    found: dict[int, list[str]] = {}
    for one in sorted(folder.iterdir()) if folder.is_dir() else ():
        named = _CLIP.fullmatch(one.name)
        if named is not None and one.is_file():
            found.setdefault(int(named[1]), []).append(f"{_CLIPS}/{one.name}")
    return found


def _write(file: Path, name: str, data: Any) -> int:
    """Write data, and say how many bytes they take."""
    return file.write_bytes(_bytes(name, data))


def _bytes(name: str, data: Any) -> bytes:
    return script_of(name, data).encode("utf-8", errors="replace")


#: what could end the script or its string, whatever reads it first: the page's parser or the language's
_ESCAPES = str.maketrans(
    {
        "\\": "\\\\",
        "'": "\\'",
        "<": "\\x3c",
        ">": "\\x3e",
        "&": "\\x26",
        "\u2028": "\\u2028",
        "\u2029": "\\u2029",
        "\r": "\\r",
        "\n": "\\n",
    }
)
#: as much as this is told with all its digits; and up to this, whole numbers are whole to the page as well
_EXACT, _WHOLE = 1e4, 2**53


def script_of(name: str, data: Any) -> str:
    """A script that hands data to the page under a name.

    The data are a text that is parsed as JSON: no key of theirs means anything to the language.
    """
    data = finite(data, _short)
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"), default=str)
    return f"mutabot.take('{name.translate(_ESCAPES)}','{text.translate(_ESCAPES)}');\n"


def _short(number: float) -> float | int:
    """As many digits as a page shows, so that thousands of numbers stay small.

    From ``_EXACT`` on these are too few: of seconds since 1970, seven digits are some minutes.
    """
    if number.is_integer() and abs(number) < _WHOLE:
        return int(number)
    return number if abs(number) >= _EXACT else float(f"{number:.7g}")
