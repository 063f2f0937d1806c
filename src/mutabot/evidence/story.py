"""Describe in a sentence how a mutant's test differs from the original's, by the recordings.

The sentence names contacts and releases first, where a simulator reports contacts; then what slipped, was
dragged, left its path or ended elsewhere, the largest deviation first. The original's value stands beside.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

from mutabot.evidence.calls import first_difference
from mutabot.evidence.contacts import RecordedContacts
from mutabot.evidence.differences import TURNED, BodyPair, Spread, differences
from mutabot.evidence.measurements import measurements_of
from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.physics import (
    COLLISION,
    DRAG,
    DURATION,
    IMPACT,
    MARGIN,
    MARGIN_NAME,
    RELEASE,
    SET_DOWN,
    SLIP,
    SPEED,
    Fact,
    facts_of,
)
from mutabot.evidence.recording import TrackKind
from mutabot.model.quantity import value_text
from mutabot.model.world_difference import Apart, Diverged, Measurement

#: parts of a sentence, how many of them may be contacts, and differences that are kept
_MOST_PARTS, _MOST_CONTACTS, _MOST = 3, 2, 8
#: deg by which a thing must be turned on its way, if there is anything else to say
_LEAST_TURN = 5.0
#: things of which stories say how far they left their paths
_MOST_PATHS = 2
#: s by which a test must end earlier, and by which a thing must be let go at another time
_EARLY, _OTHER_TIME = 1.0, 0.5
#: m/s: what is slower hits nothing
_SLOW = 0.3
#: share of its range by which fingers move that let something go, and the s before and after that
_OPENED, _BEFORE, _AFTER = 0.05, 0.3, 0.2
#: share of a test's duration that is named before lesser differences
_MUCH = 0.1
#: s that is no delay
_NO_DELAY = 0.1


def diverged(
    test: str,
    original: RecordedPaths,
    mutant: RecordedPaths,
    noise: Mapping[str, float] | None = None,
    spread: Spread | None = None,
    *,
    is_cut: bool = False,
) -> Diverged | None:
    """Return how a mutant's test differs from the original's; None if nothing recorded differs.

    Args:
        test: node id.
        noise: by how much each thing is apart in equal runs of the original.
        spread: how far runs of the original with different seeds are apart.
        is_cut: whether something ended the mutant's test before its end.
    """
    both = _ComparedRuns(original, mutant, spread or Spread(), is_cut)
    apart = differences(original.paths, mutant.paths, noise or {}, both.spread, both.until)
    # a margin follows from where the robot is
    places = [gap for gap in apart if not gap.name.endswith(MARGIN_NAME)]
    found = [(gap.first, _first_text(gap)) for gap in places or apart]
    call = first_difference(original.recording.calls, mutant.recording.calls)
    if call is not None and call[1] is not None:
        found.append((call[1], call[0]))
    if not found and call is None:
        return None
    at, what = min(found) if found else (None, "")
    if call is not None and call[1] is None:  # without a clock calls are all that has an order
        what = call[0]
    measured = both.measurements
    return Diverged(
        test=test,
        at=at,
        what=what,
        story=both.story(apart, measured),
        apart=tuple(apart[:_MOST]),
        measurements=tuple(measured[:_MOST]),
        fault=mutant.recording.fault,
        is_simulated=mutant.recording.is_simulated and original.recording.is_simulated,
        scatters=both.spread.scatters,
    )


def _first_text(deviation: Apart) -> str:
    """Return the first difference: a place, an orientation, or a value."""
    thing = deviation.name.removesuffix(TURNED)
    if thing != deviation.name:
        return f"{thing} is turned otherwise than in the original run"
    if deviation.unit == "m" and deviation.aside is not None and not deviation.is_value:
        return f"{thing} is at a different position than in the original run"
    return f"{thing} has a different value than in the original run"


@dataclass(frozen=True)
class _ComparedRuns:
    """A mutant's test beside the original's."""

    original: RecordedPaths
    mutant: RecordedPaths
    spread: Spread
    is_cut: bool

    @cached_property
    def end(self) -> float:
        """When the mutant's test ended, s."""
        times = self.mutant.recording.times
        return times[-1] if times else 0.0

    @property
    def until(self) -> float:
        """The last moment that can be compared, s."""
        return self.end if self.is_cut and self.mutant.recording.times else inf

    @cached_property
    def usual(self) -> Mapping[tuple[str, str], Fact]:
        """What was measured of the original."""
        return facts_of(self.original)

    @cached_property
    def facts(self) -> Mapping[tuple[str, str], Fact]:
        """What was measured of the mutant."""
        return facts_of(self.mutant)

    @property
    def measurements(self) -> list[Measurement]:
        """What was measured and differs; times of the wall clock are no duration."""
        found = measurements_of(self.usual, self.facts, self.spread, is_cut=self.is_cut)
        are_simulated = self.original.recording.is_simulated and self.mutant.recording.is_simulated
        return [measurement for measurement in found if measurement.name != DURATION or are_simulated]

    def story(self, apart: Sequence[Apart], measured: Sequence[Measurement]) -> str:
        """Return the sentence, most important part first; empty if the world was the same."""
        parts = [*self._cut(), *list(self._contacts(measured))[:_MOST_CONTACTS]]
        others = [(measurement.deviation, self._motion(measurement)) for measurement in measured]
        significant = [deviation for deviation in apart if _is_significant(deviation)]
        others += [
            (deviation.deviation, _strayed(deviation, is_whole=not self.is_cut)) for deviation in significant
        ]
        others += _detours(significant, is_whole=not self.is_cut)
        parts += [text for _, text in sorted(others, key=lambda weighted_text: -weighted_text[0]) if text]
        if apart and not parts:
            parts = [*_asides(significant)] or [self._delay()]
        late = next((measurement for measurement in measured if measurement.name == DURATION), None)
        if late is not None and any(not deviation.is_delay for deviation in apart):  # else the delay says so
            where = _MOST_PARTS - 1 if _is_long(late) else len(parts)
            parts.insert(where, f"the test took {_beside(late, 3)}")
        text = "; ".join(list(dict.fromkeys(parts))[:_MOST_PARTS])
        if text and self.spread.scatters:
            return f"only in a test whose end the original itself scatters ({self.spread.scatters}): {text}"
        return text

    def _cut(self) -> Iterator[str]:
        times = self.original.recording.times
        due = times[-1] if times else 0.0
        if self.is_cut and self.end < due - _EARLY:
            yield f"the test ended at {self.end:.1f} s instead of {due:.1f} s"

    def _contacts(self, measured: Sequence[Measurement]) -> Iterator[str]:
        """Yield what never touched, what was released differently, and what was hit."""
        usual, contacts = RecordedContacts(self.original), RecordedContacts(self.mutant)
        always = self.spread.always
        for pair in sorted(usual.intervals.keys() - contacts.intervals.keys()):
            begin = usual.intervals[pair][0][0]
            if begin < self.end and (always is None or pair in always):
                robot, touched = sorted(pair, key=lambda name: name not in usual.robots)
                yield f"{robot} never touched {touched} (original: at {begin:.1f} s)"
        for thing in contacts.things:
            text = self._release(thing, usual, contacts, measured)
            if text:
                yield text
        yield from self._hits(usual, contacts, measured)

    def _hits(
        self, usual: RecordedContacts, contacts: RecordedContacts, measured: Sequence[Measurement]
    ) -> Iterator[str]:
        """Yield contacts that no run of the original has, except those of released things."""
        onto = {_pair(fact.thing, fact.other) for fact in self.facts.values() if fact.name == RELEASE}
        speeds = {
            measurement.thing: measurement.value or 0.0
            for measurement in measured
            if measurement.name == COLLISION
        }
        new = contacts.intervals.keys() - usual.intervals.keys() - self.spread.ever - onto
        for pair in sorted(new, key=lambda new_pair: contacts.intervals[new_pair][0][0]):
            order = [*sorted(contacts.robots), *contacts.things, *pair]
            body, touched = sorted(pair, key=order.index)
            at, speed = contacts.intervals[pair][0][0], speeds.get(f"{body}, {touched}")
            if speed is None:
                yield f"{body} touched the {touched} at {at:.1f} s (original: never)"
            else:
                yield f"{body} hit the {touched} at {at:.1f} s, at {_amount(speed, 'm/s')} (original: never)"

    def _release(
        self, thing: str, usual: RecordedContacts, contacts: RecordedContacts, measured: Sequence[Measurement]
    ) -> str:
        """Describe how a thing was released, if that differs from the original; else empty."""
        before, after = self.usual.get((RELEASE, thing)), self.facts.get((RELEASE, thing))
        if after is None:
            return self._not_landed(thing, usual, contacts)
        impact = self._impact(thing)
        if before is None:
            is_dropped = usual.holds(thing) and after.value > SET_DOWN
            return (
                f"{self._verb(thing, after)} {_height(after)} (original: never){impact}" if is_dropped else ""
            )
        is_other = before.other != after.other
        if not is_other and not any(
            (measurement.name, measurement.thing) == (RELEASE, thing) for measurement in measured
        ):
            return ""
        is_other_time = abs(after.at - before.at) > _OTHER_TIME
        now, then = (f"at {fact.at:.1f} s, " if is_other_time else "" for fact in (after, before))
        known = _height(before) if is_other or before.value <= SET_DOWN else _amount(before.value)
        return f"{self._verb(thing, after)} {now}{_height(after)} (original: {then}{known}){impact}"

    def _not_landed(self, thing: str, usual: RecordedContacts, contacts: RecordedContacts) -> str:
        """Describe the release of a thing that touched nothing afterwards, or that was never released."""
        ends = [found[-1][1] for recorded in (usual, contacts) if (found := recorded.holds(thing))]
        if len(ends) < 2 or ends[0] >= self.end:
            return ""
        if ends[1] == inf:
            return f"{thing} was never let go (original: at {ends[0]:.1f} s)"
        if abs(ends[1] - ends[0]) <= _OTHER_TIME:
            return ""
        return f"{thing} was lost at {ends[1]:.1f} s (original: let go at {ends[0]:.1f} s)"

    def _verb(self, thing: str, release: Fact) -> str:
        """Return the verb of a release: whether fingers opened, if they are recorded."""
        if release.value <= SET_DOWN:
            return f"{thing} was set down"
        paths = [path for path in self.mutant.paths.values() if path.track.kind is TrackKind.VALUE]
        fingers = [path for path in paths if "finger" in path.track.name or "gripper" in path.track.name]
        for path in fingers:
            values = [row[0] for row in path.rows]
            moved = values[path.at(release.at + _AFTER)] - values[path.at(release.at - _BEFORE)]
            if abs(moved) > _OPENED * (max(values) - min(values)):
                return f"{thing} was let go"
        return f"{thing} was lost" if fingers else f"{thing} was let go"

    def _impact(self, thing: str) -> str:
        """Describe the speed at which it hit what it fell onto."""
        now, then = (facts.get((IMPACT, thing)) for facts in (self.facts, self.usual))
        if now is None or now.value < _SLOW:
            return ""
        is_known = then is not None and then.value >= _SLOW
        usual = f" (original: {_amount(then.value, 'm/s')})" if then is not None and is_known else ""
        return f" and hit it at {_amount(now.value, 'm/s')}{usual}"

    def _motion(self, measurement: Measurement) -> str:
        """Describe what slipped, was dragged or was faster."""
        if measurement.name == SLIP:
            return f"{measurement.thing} slipped {_beside(measurement)} in the grip"
        if measurement.name == DRAG:
            surface = self.facts[DRAG, measurement.thing].other
            return f"{measurement.thing} was dragged {_beside(measurement)} over the {surface}"
        if measurement.name == SPEED:
            return f"{measurement.thing} moved at up to {_beside(measurement)}"
        if measurement.name == MARGIN:
            return f"{measurement.thing} fell to {_beside(measurement)}"
        return ""

    def _delay(self) -> str:
        """Describe by how much the same things happened later or earlier."""
        delays = [after - before for before, after in self._same_moments()]
        if not delays:
            return "the same movements happened at other times"
        worst = max(delays, key=abs)
        if abs(worst) <= _NO_DELAY:
            return f"the same movements happened at most {_NO_DELAY} s earlier or later"
        return f"the same movements happened up to {abs(worst):.1f} s {'later' if worst > 0 else 'earlier'}"

    def _same_moments(self) -> Iterator[tuple[float, float]]:
        """Yield when the same calls began and the same bodies touched, in the original and in the mutant."""
        original, mutant = self.original.recording, self.mutant.recording
        for first, second in zip(original.calls, mutant.calls, strict=False):
            if first.operation != second.operation:
                break
            if first.began is not None and second.began is not None:
                yield first.began, second.began
        if original.times and mutant.times and not self.is_cut:
            yield original.times[-1], mutant.times[-1]


def _pair(first: str, second: str) -> BodyPair:
    return tuple(sorted((first, second)))


def _height(release: Fact) -> str:
    if release.value <= SET_DOWN:
        return f"on the {release.other}"
    return f"{_amount(release.value)} above the {release.other}"


def _beside(measurement: Measurement, digits: int = 2) -> str:
    """Return a measurement beside the original's: ``12 mm (original: 1 mm)``."""
    usual = "none" if not measurement.original else _amount(measurement.original, measurement.unit, digits)
    return f"{_amount(measurement.value or 0.0, measurement.unit, digits)} (original: {usual})"


def _amount(value: float, unit: str = "m", digits: int = 2) -> str:
    return value_with_unit(float(f"{value:.{digits}g}"), unit)


def _is_long(late: Measurement) -> bool:
    """Return whether a test took so much more or less time that a reader must be told."""
    usual = late.original or 0.0
    return abs((late.value or 0.0) - usual) > _MUCH * usual


def _is_significant(deviation: Apart) -> bool:
    """Return whether it is more than delay and the original's spread, and worth a sentence."""
    is_beyond = max(deviation.of_end, deviation.of_way) > 1.0
    return is_beyond and not deviation.is_delay and not deviation.name.endswith(MARGIN_NAME)


def _strayed(deviation: Apart, *, is_whole: bool) -> str:
    """Describe how far a thing was from its path and end; empty if not farther than the original."""
    strayed, final = deviation.aside or 0.0, deviation.final if is_whole and deviation.of_end > 1.0 else 0.0
    if final <= deviation.tolerance:
        return ""
    thing = deviation.name.removesuffix(TURNED)
    if thing != deviation.name:
        return f"{thing} ended turned by {value_with_unit(final, deviation.unit)}"
    if deviation.unit != "m" or deviation.is_value:
        return (
            f"{deviation.name} ended {value_with_unit(final, deviation.unit)} from its value in the original"
        )
    if strayed > 2.0 * final:
        left = f"{deviation.name} left its path by up to {value_with_unit(strayed)}"
        return f"{left} and ended {value_with_unit(final)} from its position in the original"
    return f"{deviation.name} ended {value_with_unit(final)} from its position in the original"


def _detours(apart: Sequence[Apart], *, is_whole: bool) -> Iterator[tuple[float, str]]:
    """Yield the things that left their path, or turned on the way, but reached its end, with deviations."""
    found = [gap for gap in apart if gap.aside is not None and not _strayed(gap, is_whole=is_whole)]
    found = [gap for gap in found if gap.aside > max(gap.tolerance, gap.aside_spread)]  # type: ignore[operator]
    paths = [gap for gap in found if gap.unit == "m" and not gap.is_value]
    if paths:
        names = " and ".join(path.name for path in paths[:_MOST_PATHS])
        amounts = [value_with_unit(path.aside or 0.0) for path in paths[:_MOST_PATHS]]
        far = " and ".join(dict.fromkeys(amounts))
        its, plural = ("its path", "") if len(paths) == 1 else ("their paths", "s")
        end = f" but reached the correct end position{plural}" if is_whole else ""
        yield paths[0].deviation, f"{names} left {its} by up to {far}{end}"
    yield from ((turn.deviation, _turned(turn)) for turn in found if _is_turn(turn, _LEAST_TURN))


def _asides(apart: Sequence[Apart]) -> Iterator[str]:
    """Describe turns of any size and values that left their range, where there is nothing else to say."""
    for gap in apart:
        if _is_turn(gap):
            yield _turned(gap)
        elif gap.is_value and gap.aside:
            yield f"{gap.name} left its range in the original by up to {value_with_unit(gap.aside, gap.unit)}"


def _is_turn(gap: Apart, least: float = 0.0) -> bool:
    return gap.name.endswith(TURNED) and (gap.aside or 0.0) > least


def _turned(gap: Apart) -> str:
    far = value_with_unit(gap.aside or 0.0, gap.unit)
    return f"{gap.name.removesuffix(TURNED)} was turned by up to {far} on its way"


def value_with_unit(value: float, unit: str = "m") -> str:
    """Return a value with its unit: ``40 mm``, ``0.31 m``, ``12 deg``."""
    if unit == "m" and value < 0.1:
        millimetres = 1e3 * value if value >= 1e-4 else 0.0
        return f"{millimetres:.0f} mm" if millimetres >= 10.0 else f"{millimetres:.2g} mm"
    return f"{value_text(value, 3)} {unit}".strip()
