"""The folder of a report: pages, their data and what shows them; nothing of a user's is ever lost."""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from mutabot.analysis.results import MutantResult
from mutabot.analysis.stored.campaign import StoredCampaign
from mutabot.analysis.stored.evidence import StoredEvidence
from mutabot.analysis.suggested import Suggestions
from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.journal.files import REPORT_MARK
from mutabot.report.html.mutant import Recorded, mutant_page
from mutabot.report.html.overview import campaign_data
from mutabot.report.suggested import check_on_page

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

    campaign: StoredCampaign
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
    found, without = _recordings(recorded, _in_order(campaign), limit - used)
    for number in found.keys() | without.keys():
        data = {"recordings": found.get(number, []), "without": without.get(number, 0)}
        with (folder / "mutants" / f"{number}.js").open("ab") as file:
            file.write(_bytes(f"recordings {number}", data))
    for number, original in enumerate(recorded.originals.values()):
        _write(folder / "originals" / f"{number}.js", f"original {number}", original)
    return sum(without.values())


def _in_order(campaign: StoredCampaign) -> list[MutantResult]:
    """The mutants in the order in which their recordings are wanted."""
    survivors = campaign.survivors
    numbers = {one.mutant.number for one in survivors}
    return [*survivors, *(one for one in campaign.mutants if one.mutant.number not in numbers)]


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
    text = json.dumps(plain(data), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return f"mutabot.take('{name.translate(_ESCAPES)}','{text.translate(_ESCAPES)}');\n"


def plain(value: Any) -> Any:
    """Data that JSON can hold: numbers that are none become null, and what it does not know a text."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return _short(value) if math.isfinite(value) else None
    if value is None or isinstance(value, bool | int):
        return value
    return str(value)


def _short(number: float) -> float | int:
    """As many digits as a page shows, so that thousands of numbers stay small.

    From ``_EXACT`` on these are too few: of seconds since 1970, seven digits are some minutes.
    """
    if number.is_integer() and abs(number) < _WHOLE:
        return int(number)
    return number if abs(number) >= _EXACT else float(f"{number:.7g}")
