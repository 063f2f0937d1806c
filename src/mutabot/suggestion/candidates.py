"""Which checks the measured readings allow: bands come from the original alone, mutants say where to look."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from mutabot.model.quantity import step_of
from mutabot.suggestion.checks import Band, Check, Expected, band_of, is_number, rounded
from mutabot.suggestion.measure import Measured, Read
from mutabot.suggestion.project import Project
from mutabot.suggestion.readings import HAND, PROBE, WAY, Reading
from mutabot.suggestion.style import Place

from .readings import watch_of

#: values a label may have, runs that each must have been seen in, labels and partners that are tried
_LABELS, _SEEN, _TRIED = 4, 4, 8
#: how much less a reading must spread beside a label or a partner than by itself
_STEADIER = 0.5
_LAST = re.compile(r"(\w+)\W*$")
_WAY = re.compile(r"(max|min|all|step) (.+)")
#: steps of a reading that are no difference, where it comes in steps: one up or down
_STEPS = 1.5


def candidates(project: Project, measured: Measured) -> list[Check]:
    """All checks that would notice a survivor; per reading the plainest that notices most.

    Those along the way of a test are for survivors that none at the end of a test would notice.
    """
    at_ends = list(_all_checks(project, measured, along=False))
    noticed = {mutant for one in at_ends for mutant in one.margins}
    way = [
        replace(one, margins={key: found for key, found in one.margins.items() if key not in noticed})
        for one in _all_checks(project, measured, along=True)
    ]
    return [*at_ends, *(one for one in way if one.margins)]


def _all_checks(project: Project, measured: Measured, *, along: bool) -> Iterator[Check]:
    for place, originals in measured.originals.items():
        mutants = measured.mutants.get(place, {})
        runs = list(originals.values())
        if mutants and runs:
            ends = _readings(measured, place, runs)
            chosen = _along(project, measured, place, runs) if along else ends
            given = [one for one in ends if _is_given(one.text, originals, mutants)]
            yield from _at(place, runs, mutants, chosen, ends, _labels(given, runs))


def _is_given(
    text: str,
    originals: Mapping[tuple[int, str], Read],
    mutants: Mapping[str, Mapping[tuple[int, str], Read]],
) -> bool:
    """Whether a reading belongs to the round and the test, and is nothing that a program did."""
    return all(
        read.get(text) == originals.get(key, {}).get(text)
        for reads in mutants.values()
        for key, read in reads.items()
    )


def _at(
    place: Place,
    runs: Sequence[Read],
    mutants: Mapping[str, Mapping[tuple[int, str], Read]],
    chosen: Sequence[Reading],
    readings: Sequence[Reading],
    labels: Sequence[str],
) -> Iterator[Check]:
    """The best check of each of the chosen readings; all ``readings`` may stand beside it."""
    for reading in chosen:
        best: Check | None = None
        for expected in _expected(reading, readings, labels, runs):
            margins = _margins(reading.text, expected, mutants)
            beside = [one for one in readings if one.text in {expected.label, expected.minus}]
            needs = tuple(line for one in beside for line in one.needs)
            check = Check(place, reading, expected, margins, needs)
            if check.margins and (best is None or len(check.trials) > len(best.trials)):
                best = check
        if best is not None:
            yield best


def _margins(
    text: str, expected: Expected, mutants: Mapping[str, Mapping[tuple[int, str], Read]]
) -> dict[str, dict[int, float]]:
    found: dict[str, dict[int, float]] = {}
    for mutant, reads in mutants.items():
        for (round, _), read in reads.items():
            margin = expected.margin(text, read)
            if margin > 1.0:
                known = found.setdefault(mutant, {})
                known[round] = max(margin, known.get(round, 0.0))
    return found


def _readings(measured: Measured, place: Place, runs: Sequence[Read]) -> list[Reading]:
    """The readings that every run of the original has, part by part."""
    texts = [text for text in runs[0] if all(text in read for read in runs)]
    return [_known(measured, place, text) for text in texts if not _WAY.match(text)]


def _known(measured: Measured, place: Place, text: str) -> Reading:
    """What is known of a part; one that comes in steps may be a step off where it never was yet."""
    found = _reading(text, measured.readings[place], measured.objects)
    runs = measured.originals.get(place, {}).values()
    own = [read[text] for read in runs if is_number(read.get(text))]
    looked = {text, *(f"args[0]{text[text.index(one) :]}" for one in _names(measured) if one in text)}
    noted = (read.get(f"step {one}") for read in runs for one in looked)
    steps = [one for one in noted if is_number(one)] or [one for one in [step_of(own)] if one is not None]
    return replace(found, tolerance=max([found.tolerance, *(_STEPS * one for one in steps)]))


def part_of_way(text: str) -> tuple[str, str] | None:
    """Which extreme of which expression a reading along the way is; None for one at the end of a test."""
    match = _WAY.match(text)
    return (match[1], match[2].replace("args[0].", "")) if match is not None else None


def tolerance_of(measured: Measured, place: Place, text: str) -> float:
    """The greatest difference of equal worlds in a reading."""
    match = _WAY.match(text)
    look = match[2] if match is not None else text
    return _known(measured, place, look).tolerance


def _names(measured: Measured) -> list[str]:
    """The readings of objects, as they end an expression."""
    return [f".{target.rpartition('.')[2]}" for target, _ in measured.objects]


def _along(project: Project, measured: Measured, place: Place, runs: Sequence[Read]) -> list[Reading]:
    """What every run of the original saw on the way."""
    found = []
    for text in runs[0]:
        match = _WAY.match(text)
        if match is None or match[1] == "step" or not all(text in read for read in runs):
            continue
        kind, look = match[1], match[2]
        at_end = _known(measured, place, look)
        watch, needs = watch_of(project, measured.commands, place, look)
        shown = watch.name if kind == "all" else f"{kind}({watch.name})"
        needed = (*at_end.needs, *needs)
        found.append(Reading(text, WAY, at_end.tolerance, needed, (), watch, shown))
    return found


def _reading(text: str, known: Sequence[Reading], objects: Iterable[tuple[str, float]]) -> Reading:
    """What is known of a part: of the longest reading that it begins with."""
    fitting = [one for one in known if text == one.text or text.startswith((f"{one.text}.", f"{one.text}["))]
    if fitting:
        of = max(fitting, key=lambda one: len(one.text))
        return Reading(text, of.way, of.tolerance, of.needs, of.uses)
    tolerance = next(
        (size for target, size in objects if f".{target.rpartition('.')[2]}" in text),
        max((one.tolerance for one in known), default=1e-6),
    )
    is_read = any(f".{target.rpartition('.')[2]}" in text for target, _ in objects)
    root = re.match(r"\w+", text)
    return Reading(text, PROBE if is_read else HAND, tolerance, (), (root[0],) if root else ())


def _labels(readings: Sequence[Reading], runs: Sequence[Read]) -> list[str]:
    """Readings with a few values that come again and again: what rounds can be told apart by."""
    found: list[tuple[int, int, str]] = []
    for reading in readings:
        values = [read[reading.text] for read in runs]
        if reading.way != HAND and any(isinstance(value, float) for value in values):
            continue
        counts: dict[Any, int] = {}
        for value in values:
            counts[value] = counts.get(value, 0) + 1
        if 2 <= len(counts) <= _LABELS and min(counts.values()) >= _SEEN and None not in counts:
            kinds = [isinstance(values[0], kind) for kind in (str, bool, int)]
            found.append((kinds.index(True) if True in kinds else 3, len(found), reading.text))
    return [text for _, _, text in sorted(found)[:_TRIED]]


def _expected(
    reading: Reading, readings: Sequence[Reading], labels: Sequence[str], runs: Sequence[Read]
) -> Iterator[Expected]:
    """What a reading can be held against, the plainest first."""
    values = [read[reading.text] for read in runs]
    if not all(is_number(value) for value in values):
        yield from _equal(reading, labels, runs)
        return
    plain = _banded([None] * len(runs), values, reading.tolerance)
    yield Expected(plain[0], len(runs), band=plain[1])
    if plain[1].tolerance <= reading.tolerance:
        return
    for label in labels:
        if label != reading.text:
            keyed = _banded([read[label] for read in runs], values, reading.tolerance)
            if keyed[1].tolerance <= _STEADIER * plain[1].tolerance:
                yield Expected(keyed[0], len(runs), label=label, band=keyed[1])
    partners = [one for one in readings if one.text != reading.text and _last(one) == _last(reading)]
    for partner in partners[:_TRIED]:
        others = [read[partner.text] for read in runs]
        if all(is_number(other) for other in others) and max(others) > min(others):
            apart = [value - other for value, other in zip(values, others, strict=True)]
            beside = _banded([None] * len(runs), apart, max(reading.tolerance, partner.tolerance))
            if beside[1].tolerance <= _STEADIER * plain[1].tolerance:
                yield Expected(beside[0], len(runs), minus=partner.text, band=beside[1])


def _equal(reading: Reading, labels: Sequence[str], runs: Sequence[Read]) -> Iterator[Expected]:
    for label in (None, *labels):
        found: dict[Any, set[Any]] = {}
        for read in runs:
            found.setdefault(read[label] if label is not None else None, set()).add(read[reading.text])
        if label != reading.text and all(len(values) == 1 for values in found.values()):
            yield Expected({key: next(iter(values)) for key, values in found.items()}, len(runs), label=label)
            return


def _banded(keys: Sequence[Any], values: Sequence[float], floor: float) -> tuple[dict[Any, float], Band]:
    groups: dict[Any, list[float]] = {}
    for key, value in zip(keys, values, strict=True):
        groups.setdefault(key, []).append(float(value))
    middles, band = band_of(list(groups.values()), floor)
    # what is written is what counts: the texts are read back
    texts = [rounded(middle, band.tolerance) for middle in middles]
    tolerance = float(texts[0][1]) or band.tolerance
    band = Band(tolerance, band.spread, band.runs, band.kind, band.factor, band.alarm)
    return {key: float(text[0]) for key, text in zip(groups, texts, strict=True)}, band


def _last(reading: Reading) -> str:
    found = _LAST.search(reading.text)
    return found[1] if found else reading.text
