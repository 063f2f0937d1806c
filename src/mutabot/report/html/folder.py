"""Write the folder of an HTML report: pages, data and assets. Files of the user are never overwritten.

A mutant's page has how it ended, and what was recorded of it; of originals the latter. Tracks have fewer
points: what a straight line in time keeps within half a millimetre is left out.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from itertools import accumulate, groupby, pairwise
from math import inf
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.evidence.paths import Row, TrackPath
from mutabot.evidence.recording import RecordedCall, Recording, Track, TrackKind
from mutabot.frozen import frozen
from mutabot.journal.files import REPORT_MARK, clear
from mutabot.languages.registry import highlighting_of
from mutabot.model import By
from mutabot.model.quantity import value_text
from mutabot.report.document import data_of, finite
from mutabot.report.terminal.console import marks_of
from mutabot.report.texts import (
    acceptance_text,
    effect_text,
    mapped,
    most_informative,
    next_step,
    next_steps,
    place_text,
    state_of,
)
from mutabot.results.divergence import weight_of
from mutabot.results.films import KeptFilm
from mutabot.results.results import MutantResult, Results, killing_tests, unlooked
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import Suggestion
from mutabot.thresholds.thresholds import ladder_line, thresholds_of

#: facts of a row of the list, by the names that they have in the results document
_ROW = (
    "number=mutant.number id=mutant.id operator=mutant.operator variant=mutant.variant family=mutant.family "
    "role=mutant.site.role file=mutant.site.span.file span=mutant.site.span "
    "other_spans=mutant.site.other_spans site=mutant.site.id function=mutant.site.span.function "
    "operation=mutant.operation quantity=mutant.quantity "
    "unit=quantity.unit description=mutant.description killed=kill_rate.killed valid=kill_rate.valid "
    "indistinguishable deviation earlier outdated"
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
#: bytes that data may take beside the original's recordings; those of mutants make room
LIMIT = 23_000_000
#: bytes that all films may take beside the data
FILMS_LIMIT = 40_000_000


def campaign_data(campaign: Results, name: str) -> dict[str, Any]:
    """Return the results document as the page needs it: without sources and the rounds of mutants.

    Args:
        name: what the project is called.
    """
    tests = {test: number for number, test in enumerate(campaign.tests)}
    rows = [_row(result, tests) for result in campaign.mutants]
    thresholds = thresholds_of(campaign)
    return {
        "name": name,
        **data_of.facts(
            campaign,
            "state attempt done planned rounds groups controls verification repeats drawing tests baseline "
            "bugs_caught reaching left_out operators untested named=untested.named flaky=flaky.tests "
            "confirmed=confirmation.text",
        ),
        "meta": campaign.meta,
        # thousands of rows do not repeat the names of their cells
        "columns": [*rows[0]] if rows else [],
        "mutants": [[*row.values()] for row in rows],
        "survivors": [result.mutant.number for result in campaign.survivors],
        "withoutEffect": [*campaign.needlessly_accepted, *campaign.accepting.unmatched],
        "unlooked": unlooked(campaign.mutants),
        "ladders": [
            {**data_of.facts(ladder, _LADDER), "text": ladder_line(ladder)}
            for ladder in thresholds.ladders[:_LADDERS]
        ],
        "next": next_steps(campaign),
        "thresholds": thresholds.summary,
        "furtherLadders": len(thresholds.ladders[_LADDERS:]),
    }


def sources_data(campaign: Results) -> list[Any]:
    """Return the mutated files: name, text, and what is marked in it."""
    return [[file, text, highlighting_of(file)] for file, text in campaign.sources.items()]


def _row(result: MutantResult, tests: Mapping[str, int]) -> dict[str, Any]:
    """Return a mutant's row: its results document, a letter per round, and the tests that noticed it."""
    kills: dict[str, list[int]] = {}
    for outcome in result.outcomes:
        for test, by in dict(killing_tests(outcome)).items():
            counts = kills.setdefault(test, [tests[test], 0, 0])
            counts[1] += 1
            counts[2] += by is By.CHECK
    return {
        **data_of.facts(result, _ROW),
        "status": state_of(result),
        "why": "; ".join(filter(None, [acceptance_text(result), effect_text(result)])),
        "ends": "".join(mark.letter for mark in marks_of(result)),
        "kills": [*kills.values()],
    }


@frozen
class Written:
    """What was written into the folder.

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
    """The content of a report.

    Attributes:
        campaign: the campaign, fit to leave the machine.
        name: what the project is called.
        evidence: its recordings.
        clean: makes texts of recordings fit to leave the machine.
        suggestions: what was suggested for its survivors, by their ids.
        films: films of its mutants, by their ids.
    """

    campaign: Results
    name: str
    evidence: StoredEvidence
    clean: Callable[[str], str]
    suggestions: Mapping[str, Suggestion] = field(default_factory=dict)
    films: Mapping[str, KeptFilm] = field(default_factory=dict)


def check_folder(folder: Path) -> None:
    """Raise UsageError for a folder that a report must not be written into."""
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"the report {folder} cannot be written: it is a file; --html takes a folder")
    found = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    if found and REPORT_MARK not in found:
        raise UsageError(
            f"the report {folder} cannot be written: the folder holds other files, such as {min(found)}; "
            "name a new or empty folder, or one with an older report"
        )


def write_folder(folder: Path, contents: Contents, limit: int = LIMIT) -> Written:
    """Write the report; it replaces an older one in the folder. Raises UsageError if it cannot be written.

    Args:
        limit: bytes that data may take beside the original's recordings; a mutant's recordings that have no
            room are left out.
    """
    check_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in (REPORT_MARK, _PAGE, _ASSETS, _DATA):
            clear(folder / name)  # of a link the link alone, since it leads out of the folder
            if name == REPORT_MARK:
                (folder / name).write_text(_MARK_TEXT, encoding="utf-8")
        for path in (
            folder / _ASSETS,
            *(folder / _DATA / name for name in ("mutants", "originals", "films")),
        ):
            path.mkdir(parents=True)
        without = _write_data(folder / _DATA, contents, limit)
        for entry in files(__package__).joinpath(_ASSETS).iterdir():
            target = folder / entry.name if entry.name == _PAGE else folder / _ASSETS / entry.name
            target.write_bytes(entry.read_bytes())
    except OSError as error:
        raise UsageError(f"the report {folder} cannot be written: {error.strerror}") from error
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    return Written(folder / _PAGE, size, without)


def _write_data(folder: Path, contents: Contents, limit: int) -> int:
    """Write all data; return how many recordings had no room."""
    campaign = contents.campaign
    data = {**campaign_data(campaign, contents.name), "recorded": contents.evidence.has_original()}
    used = (folder / "campaign.js").write_bytes(script("campaign", data))
    used += (folder / "sources.js").write_bytes(script("sources", sources_data(campaign)))
    films = _copy_films(folder / "films", contents)
    for result in campaign.mutants:
        number = result.mutant.number
        page = mutant_page(result, contents.suggestions.get(result.mutant.id), films.get(result.mutant.id))
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


def _copy_films(folder: Path, contents: Contents) -> dict[str, dict[str, Any]]:
    """Copy the films that have room, of the worst survivors first. Return their data by mutant id."""
    found: dict[str, dict[str, Any]] = {}
    left = FILMS_LIMIT
    for result in contents.campaign.worst_first:
        film = contents.films.get(result.mutant.id)
        if film is None:
            continue
        size = film.file.stat().st_size
        facts = {"round": film.round, "test": contents.clean(film.test), "size": size}
        if size <= left:
            left -= size
            name = f"{result.mutant.number}.mp4"
            shutil.copyfile(film.file, folder / name)
            facts["file"] = f"{_DATA}/films/{name}"
        found[result.mutant.id] = facts
    return found


def _recordings(recorded: Recorded, results: Iterable[MutantResult], limit: int) -> dict[int, list[Any]]:
    """Return the recordings of each mutant by its number, one of each mutant before a second of any.

    When one has no room, those behind it have none either.
    """
    waiting = {result.mutant.number: recorded.of(result) for result in results}
    found: dict[int, list[Any]] = {}
    used = 0
    while waiting:
        for number, those in [*waiting.items()]:
            recording = next(those, None)
            if recording is None:
                del waiting[number]
                continue
            used += len(script("", recording))
            if used > limit:
                return found
            found.setdefault(number, []).append(recording)
    return found


#: what could end the script or its string, whatever reads it first: the page's parser or the language's
_ESCAPES = str.maketrans(
    {"\\": "\\\\", "'": "\\'"} | {sign: f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029\r\n"}
)
#: from this size on a number keeps all its digits: of seconds since 1970, seven digits are some minutes
_EXACT = 1e4


def script(name: str, data: Any) -> bytes:
    """Return a script that passes data to the page under a name.

    The data are a text that is parsed as JSON: no key of theirs means anything to the language.
    """
    data = finite(data, _short)
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"), default=str)
    call = f"mutabot.take('{name.translate(_ESCAPES)}','{text.translate(_ESCAPES)}');\n"
    return call.encode("utf-8", errors="replace")


def _short(number: float) -> float | int:
    """Round a number to the digits that a page shows, so that thousands of numbers stay small."""
    if number.is_integer() and abs(number) < 2**53:  # up to this, whole numbers are whole to the page as well
        return int(number)
    return number if abs(number) >= _EXACT else float(f"{number:.7g}")


#: what one step of the whole numbers is, and by how many steps a line may miss: m; quaternions without unit
_LENGTH, _TURN = 1e-4, 1e-3
_MISS_LENGTH, _MISS_TURN = 5.0, 3.0
#: steps over the range of a value, and by how many a line may miss
_STEPS, _MISS_VALUE = 2000, 8.0
#: the same of lines, which are only drawn: m
_DRAWN, _MISS_DRAWN = 1e-3, 5.0


def thinned(track: Track, times: Sequence[float]) -> Any:
    """Return a track as data: times in ms and numbers in steps, each as the difference from the last."""
    path = TrackPath(track, times)
    when = path.when
    if not when:
        return None
    rows = list(accumulate(path.rows, _turned_like)) if track.kind is TrackKind.POSE else path.rows
    gaps = _gaps(times, when)
    scales, misses = _scales(track, rows)
    steps = [tuple(value / scale for value, scale in zip(row, scales, strict=True)) for row in rows]
    kept = kept_points(when, steps, misses)
    channels = [[round(steps[index][axis]) for index in kept] for axis in range(len(scales))]
    return {
        "name": track.name,
        "kind": track.kind.value,
        "unit": track.unit,
        **({"size": list(track.size)} if track.size is not None else {}),
        **({"radii": list(track.radii)} if track.radii else {}),
        **({"gaps": gaps} if gaps else {}),
        "scales": scales,
        "t": _differences([round(1000 * when[index]) for index in kept]),
        "v": [_differences(channel) for channel in channels],
    }


def kept_points(times: Sequence[float], rows: Sequence[Row], misses: Sequence[float]) -> list[int]:
    """Return the points to keep: the lines between them miss no point by more than ``misses`` per axis.

    From each kept point on, the slopes are narrowed to those that pass every point so far; the last point
    within them is kept next. Each point is looked at once.
    """
    kept: list[int] = [0]
    low, high = [-inf] * len(misses), [inf] * len(misses)
    for index in range(1, len(rows)):
        slopes, span = _slopes(times, rows, kept[-1], index)
        if not all(least <= slope <= most for least, slope, most in zip(low, slopes, high, strict=True)):
            kept.append(index - 1)
            slopes, span = _slopes(times, rows, index - 1, index)
            low, high = [-inf] * len(misses), [inf] * len(misses)
        low = [
            max(least, slope - miss / span) for least, slope, miss in zip(low, slopes, misses, strict=True)
        ]
        high = [
            min(most, slope + miss / span) for most, slope, miss in zip(high, slopes, misses, strict=True)
        ]
    return kept if len(rows) < 2 else [*kept, len(rows) - 1]


def _slopes(times: Sequence[float], rows: Sequence[Row], first: int, last: int) -> tuple[list[float], float]:
    """Return the slope of each axis between two points, and the time between them."""
    span = max(times[last] - times[first], 1e-9)
    return [(end - begin) / span for end, begin in zip(rows[last], rows[first], strict=True)], span


def _gaps(times: Sequence[float], when: Sequence[float]) -> list[list[int]]:
    """Return the gaps, from and to in ms, in which a thing did not exist."""
    there, ends = {*when}, [*times[1:], times[-1] + 1e-3]
    runs = groupby(zip(times, ends, strict=True), key=lambda moment: moment[0] in there)
    absent = [list(run) for is_there, run in runs if not is_there]
    return [[round(1000 * run[0][0]), round(1000 * run[-1][1])] for run in absent]


def _turned_like(before: Row, row: Row) -> Row:
    """Return the pose, with the sign of its quaternion that is nearer to the previous one."""
    if sum(a * b for a, b in zip(before[3:], row[3:], strict=True)) < 0:
        return (*row[:3], *(-value for value in row[3:]))
    return row


def _scales(track: Track, rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    if track.kind is TrackKind.LINE:
        return [_DRAWN] * track.width, [_MISS_DRAWN] * track.width
    if track.kind is TrackKind.VALUE:
        values = [row[0] for row in rows]
        reach = max(max(values) - min(values), 1e-9 * max(map(abs, values)), 1e-12)
        return [float(f"{reach / _STEPS:.3g}")], [_MISS_VALUE]
    turns = track.width - 3
    return [_LENGTH] * 3 + [_TURN] * turns, [_MISS_LENGTH] * 3 + [_MISS_TURN] * turns


def _differences(numbers: Sequence[int]) -> list[int]:
    return [numbers[0], *(after - before for before, after in pairwise(numbers))]


#: what the page takes for granted where nothing is said
_NOTHING: tuple[Any, ...] = (None, (), [], {}, "")


def mutant_page(
    result: MutantResult, suggestion: Suggestion | None = None, film: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Return a mutant's data in the results document, without its recordings and empty values.

    Args:
        suggestion: what was suggested for it; None if nothing was looked for.
        film: what the page says of its film; None if there is none.
    """
    number, diverged = most_informative(result) or (0, None)
    place = place_text(result, number, diverged) if diverged is not None and diverged.example else ""
    check = (
        data_of.facts(suggestion, "code test notes") if suggestion is not None and suggestion.code else None
    )
    return {
        **without_empty(data_of(result)),
        "change": result.change,
        "effect_place": place,
        "suggestion": check,
        "next": next_step(result, suggestion),
        "film": film,
    }


def without_empty(value: Any) -> Any:
    """Return data without empty values."""
    if isinstance(value, dict):
        return {key: without_empty(item) for key, item in value.items() if item not in _NOTHING}
    return [without_empty(item) for item in value] if isinstance(value, list) else value


#: characters of a value that are shown
_LONGEST = 120


@dataclass(slots=True)
class Recorded:
    """The recordings of a campaign, in the form that pages need.

    Attributes:
        evidence: where they are read from.
        clean: makes texts of the program fit to leave the machine.
        originals: data of the original's recordings that were asked for, by round and test.
    """

    evidence: StoredEvidence
    clean: Callable[[str], str]
    originals: dict[tuple[int, str], Any] = field(default_factory=dict)

    def of(self, result: MutantResult) -> Iterator[dict[str, Any]]:
        """Yield the recordings of a mutant; the round and test farthest from the original come first."""
        for round, test in self._places(result):
            original, mutant = mapped(self.evidence.pair(result.mutant.id, round, test), self.clean)
            if mutant is not None:
                yield {
                    "round": round,
                    "test": self.clean(test),
                    "original": self._original(round, test, original),
                    **_data(mutant),
                }

    def count(self, result: MutantResult) -> int:
        """Return how many recordings a mutant has."""
        return sum(len(self.evidence.tests(result.mutant.id, number)) for number in range(len(result.rounds)))

    def _places(self, result: MutantResult) -> Iterator[tuple[int, str]]:
        found = [(number, outcome) for number, outcome in enumerate(result.rounds) if outcome is not None]
        for number, outcome in sorted(found, key=lambda numbered: weight_of(numbered[1]), reverse=True):
            diverged = [divergence.test for divergence in outcome.diverged]
            tests = self.evidence.tests(result.mutant.id, number)
            for test in sorted(
                tests, key=lambda name: diverged.index(name) if name in diverged else len(diverged)
            ):
                yield number, test

    def _original(self, round: int, test: str, recording: Recording | None) -> int | None:
        """Return the number of the script with the original's recording; None if there is none."""
        if recording is None:
            return None
        key = (round, test)
        if key not in self.originals:
            self.originals[key] = {"round": round, "test": self.clean(test), **_data(recording)}
        return [*self.originals].index(key)


def _data(recording: Recording) -> dict[str, Any]:
    tracks = (thinned(track, recording.times) for track in recording.tracks.values())
    return {
        "tracks": [track for track in tracks if track],
        "calls": [_call(call) for call in recording.calls],
        "moments": [[moment.time, moment.what, moment.text] for moment in recording.moments],
        "blocks": [[block.name, block.centre, block.size, block.colour] for block in recording.blocks],
        "end": recording.times[-1] if recording.times else None,
        "fault": recording.fault,
        "faultyCall": recording.faulty_call,
        "simulated": recording.is_simulated,
        "problems": recording.problems,
    }


def _call(call: RecordedCall) -> list[Any]:
    sides = ([[name, _value(value)] for name, value in side.items()] for side in (call.written, call.read))
    return [call.began, call.ended, call.operation, call.place, call.pattern, *sides, call.role]


def _value(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | float):
        return value
    text = value if isinstance(value, str) else value_text(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
