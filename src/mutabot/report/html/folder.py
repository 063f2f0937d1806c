"""The folder of a report: pages, their data and what shows them; no file of a user is ever overwritten."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.journal.files import REPORT_MARK
from mutabot.model import By
from mutabot.report.document import data_of, finite
from mutabot.report.terminal.console import mark_of
from mutabot.report.terminal.mutant import check_on_page
from mutabot.report.texts import effect_text, status_of
from mutabot.results.results import MutantResult, Results, killers, unlooked
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import Suggestions
from mutabot.results.thresholds import line_of, thresholds_of

from .mutant import Recorded, mutant_page

#: facts of a row of the list, by the names that they have in the results document
_ROW = (
    "number=mutant.number id=mutant.id operator=mutant.operator variant=mutant.variant family=mutant.family "
    "role=mutant.site.role file=mutant.site.span.file span=mutant.site.span site=mutant.site.id "
    "function=mutant.site.span.function operation=mutant.operation quantity=mutant.quantity "
    "unit=quantity.unit description=mutant.description killed=kill_rate.killed valid=kill_rate.valid "
    "indistinguishable worst earlier outdated"
)
_LADDER = (
    "place name file=mutant.site.span.file line=mutant.site.span.line unit magnitudes=sizes none_up_to "
    "all_from refused_from"
)
#: ladders that the page shows; `mutabot thresholds` prints all
_LADDERS = 200
_MARK_TEXT = "A report of mutabot: open index.html. `mutabot report --html` replaces it.\n"
#: what a report consists of
_PAGE, _ASSETS, _DATA = "index.html", "assets", "data"
#: bytes that all data may take; recordings make room
LIMIT = 23_000_000


def campaign_data(campaign: Results, name: str) -> dict[str, Any]:
    """Return the results document as the page needs it: without sources and the rounds of mutants.

    Args:
        name: what the project is called.
    """
    tests = {test: number for number, test in enumerate(campaign.tests)}
    rows = [_row(one, tests) for one in campaign.mutants]
    return {
        "name": name,
        **data_of.facts(
            campaign,
            "state attempt done planned rounds groups controls verification repeats drawing tests baseline "
            "reaching left_out operators flaky=flaky.tests confirmed=confirmation.text",
        ),
        "meta": campaign.meta,
        # thousands of rows do not repeat the names of their cells
        "columns": [*rows[0]] if rows else [],
        "mutants": [[*one.values()] for one in rows],
        "unlooked": unlooked(campaign.mutants),
        "ladders": [
            {**data_of.facts(one, _LADDER), "text": line_of(one)}
            for one in thresholds_of(campaign).ladders[:_LADDERS]
        ],
    }


def _row(result: MutantResult, tests: Mapping[str, int]) -> dict[str, Any]:
    """A mutant as the results document has it, with one letter per round, and the tests that noticed it."""
    kills: dict[str, list[int]] = {}
    for outcome in result.outcomes:
        for test, by in dict(killers(outcome)).items():
            counts = kills.setdefault(test, [tests[test], 0, 0])
            counts[1] += 1
            counts[2] += by is By.CHECK
    return {
        **data_of.facts(result, _ROW),
        "status": data_of(status_of(result)) or "not run",
        "why": effect_text(result),
        "ends": "".join(mark_of(one).letter for one in result.rounds),
        "kills": [*kills.values()],
    }


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
    found = {one.name for one in folder.iterdir()} if folder.is_dir() else set()
    if found and REPORT_MARK not in found:
        raise UsageError(
            f"the report {folder} cannot be written: the folder holds other files, such as {min(found)}; "
            "name a new or empty folder, or one with an older report"
        )


def write_folder(folder: Path, contents: Contents, limit: int = LIMIT) -> Written:
    """Write the report; it replaces an older one in the folder. Raises UsageError if it cannot be written.

    Args:
        limit: bytes that all data may take; recordings that have no room are left out.
    """
    check_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / REPORT_MARK).write_text(_MARK_TEXT, encoding="utf-8")
        for name in (_ASSETS, _DATA):
            shutil.rmtree(folder / name, ignore_errors=True)
        for path in (folder / _ASSETS, *(folder / _DATA / name for name in ("mutants", "originals"))):
            path.mkdir(parents=True)
        without = _write_data(folder / _DATA, contents, limit)
        for one in files(__package__).joinpath(_ASSETS).iterdir():
            target = folder / one.name if one.name == _PAGE else folder / _ASSETS / one.name
            target.write_bytes(one.read_bytes())
    except OSError as error:
        raise UsageError(f"the report {folder} cannot be written: {error.strerror}") from error
    size = sum(one.stat().st_size for one in folder.rglob("*") if one.is_file())
    return Written(folder / _PAGE, size, without)


def _write_data(folder: Path, contents: Contents, limit: int) -> int:
    """Write all data; return how many recordings had no room."""
    campaign = contents.campaign
    sources = [[file, text] for file, text in campaign.sources.items()]
    used = (folder / "campaign.js").write_bytes(script("campaign", campaign_data(campaign, contents.name)))
    used += (folder / "sources.js").write_bytes(script("sources", sources))
    for result in campaign.mutants:
        number = result.mutant.number
        check = check_on_page(result, contents.suggestions)
        page = {**mutant_page(result), "suggestion": check}
        file = folder / "mutants" / f"{number}.js"
        used += file.write_bytes(script(f"mutant {number}", page))
    recorded = Recorded(contents.evidence, contents.clean)
    found = _recordings(recorded, campaign.worst_first, limit - used)
    lacking = 0
    for result in campaign.mutants:
        number, those = result.mutant.number, found.get(result.mutant.number, [])
        without = recorded.count(result) - len(those)
        lacking += without
        if those or without:
            with (folder / "mutants" / f"{number}.js").open("ab") as page_file:
                page_file.write(script(f"recordings {number}", {"recordings": those, "without": without}))
    for index, original in enumerate(recorded.originals.values()):
        (folder / "originals" / f"{index}.js").write_bytes(script(f"original {index}", original))
    return lacking


def _recordings(recorded: Recorded, results: Iterable[MutantResult], limit: int) -> dict[int, list[Any]]:
    """The recordings of each mutant by its number, one of each before a second of any.

    When one has no room, those behind it have none either.
    """
    waiting = {one.mutant.number: recorded.of(one) for one in results}
    found: dict[int, list[Any]] = {}
    used = 0
    while waiting:
        for number, those in [*waiting.items()]:
            one = next(those, None)
            if one is None:
                del waiting[number]
                continue
            used += len(script("", one))
            if used > limit:
                return found
            found.setdefault(number, []).append(one)
    return found


#: what could end the script or its string, whatever reads it first: the page's parser or the language's
_ESCAPES = str.maketrans(
    {"\\": "\\\\", "'": "\\'"} | {sign: f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029\r\n"}
)
#: from this size on a number keeps all its digits: of seconds since 1970, seven digits are some minutes
_EXACT = 1e4


def script(name: str, data: Any) -> bytes:
    """Return a script that hands data to the page under a name.

    The data are a text that is parsed as JSON: no key of theirs means anything to the language.
    """
    data = finite(data, _short)
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"), default=str)
    call = f"mutabot.take('{name.translate(_ESCAPES)}','{text.translate(_ESCAPES)}');\n"
    return call.encode("utf-8", errors="replace")


def _short(number: float) -> float | int:
    """As many digits as a page shows, so that thousands of numbers stay small."""
    if number.is_integer() and abs(number) < 2**53:  # up to this, whole numbers are whole to the page as well
        return int(number)
    return number if abs(number) >= _EXACT else float(f"{number:.7g}")
