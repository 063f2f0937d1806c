"""Vocabulary files: found, read, checked, also by what operations say about each other, and put together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from mutabot.errors import ConfigurationError, UnknownNameError
from mutabot.extensions import brought
from mutabot.families import OF_CALLS
from mutabot.faults import need_vocabulary
from mutabot.model import Clock, Operation, Probe, Quantity, Vocabulary, Wait
from mutabot.model.quantity import READING_OF, is_reading_of
from mutabot.settings.document import Document
from mutabot.settings.mistakes import Check, raise_errors
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.cases.when import together

from .operations import check_targets, read_clock, read_operations, read_probe, read_wait
from .schema import VocabularyTable

_SHIPPED = Path(__file__).parent / "shipped"


def load(names: Sequence[str], root: Path, families: Iterable[str] = OF_CALLS) -> Vocabulary:
    """The vocabulary in these files, put together.

    Each name is a file relative to ``root``, or the name of a vocabulary that mutabot ships. What a file
    says of a callable, the clock or a probe goes before what a shipped vocabulary says of it. ``families``,
    those that are asked for, may do without any.

    Raises ConfigurationError, VocabularyError or UnknownNameError: the first mistake, with a message that
    tells about all of them.
    """
    merged = _Merged(need_vocabulary(families))
    documents = [_find(name, root) for name in dict.fromkeys(names)]
    for document, is_shipped in sorted(documents, key=lambda found: found[1]):
        merged.add(document, is_shipped)
    check_operations(merged.entries, merged.read)
    raise_errors(merged.errors)
    return Vocabulary(
        operations=tuple(operation for operation, _, _ in merged.read.values()),
        refusals=tuple(dict.fromkeys(merged.refusals)),
        checks=tuple(dict.fromkeys(merged.checks)),
        failures=tuple(dict.fromkeys(merged.failures)),
        clock=merged.clock,
        probes=tuple(merged.probes.values()),
        wait=merged.wait,
    )


def shipped() -> tuple[str, ...]:
    """Names of the vocabularies that mutabot and the packages beside it ship."""
    return tuple(sorted(_shipped_files()))


def _shipped_files() -> dict[str, Path]:
    own = {path.stem: path for path in _SHIPPED.glob("*.toml")}
    return {name: part.file for name, part in brought("vocabularies").items()} | own


@dataclass
class _Merged:
    """What the files read so far say, and the mistakes in them; whether they must say anything."""

    is_needed: bool
    errors: list[ConfigurationError] = field(default_factory=list)
    read: dict[str, Read] = field(default_factory=dict)
    entries: list[Read] = field(default_factory=list)
    refusals: list[str] = field(default_factory=list)
    checks: list[str] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    clock: Clock | None = None
    wait: Wait | None = None
    probes: dict[str, Probe] = field(default_factory=dict)
    own: set[str] = field(default_factory=set)

    def add(self, document: Document, is_shipped: bool) -> None:
        check = Check(document, self.errors)
        table = check.table(VocabularyTable, document.data, (), salvage=True)
        if table is None:
            return
        if not document.data and self.is_needed:
            check.error((), "is empty; a vocabulary names operations: [[operation]]")
        for index, raw in enumerate(table.operation):
            for operation in read_operations(check, raw, ("operation", index)):
                if self._counts(operation.target, is_shipped):
                    self._add_operation(check, operation, index)
        for name in ("refusals", "checks", "failures"):
            check_targets(check, getattr(table, name), (name,))
            getattr(self, name).extend(getattr(table, name))
        if table.clock is not None and self._counts("clock", is_shipped):
            clock = read_clock(check, table.clock, ("clock",))
            self._add_one(check, "clock", clock, "there is another clock")
        if table.wait is not None and self._counts("wait", is_shipped):
            wait = read_wait(check, table.wait, ("wait",))
            self._add_one(check, "wait", wait, "another wait is named")
        for index, raw in enumerate(table.probe):
            probe = read_probe(check, raw, ("probe", index))
            if probe is not None and self._counts(f"probe {probe.target}", is_shipped):
                self._add_probe(check, probe, index)

    def _counts(self, what: str, is_shipped: bool) -> bool:
        """Whether a description is to be taken: the user's own, read first, go before shipped ones."""
        if not is_shipped:
            self.own.add(what)
        return not is_shipped or what not in self.own

    def _add_operation(self, check: Check, operation: Operation, index: int) -> None:
        place: KeyPath = ("operation", index)
        known = self.read.get(operation.target)
        self.entries.append((operation, check, place))
        if known is None:
            self.read[operation.target] = (operation, check, place)
        elif known[0].is_partial and operation.is_partial:
            self._merge(known, operation, check, place)
        elif known[0].is_partial or operation.is_partial:
            also = _file_of(known[0].source)
            check.error(place, f"{operation.target} is described with and without when: also in {also}")
        elif _sourceless(known[0]) != _sourceless(operation):
            is_call = operation.named is None
            where, what = ((*place, "call"), "") if is_call else (place, f"{operation.target} ")
            also = _file_of(known[0].source)
            check.error(where, f"{what}is described twice, differently: also in {also}")

    def _merge(self, known: Read, operation: Operation, check: Check, place: KeyPath) -> None:
        try:
            self.read[operation.target] = (together(known[0], operation), *known[1:])
        except ValueError as error:
            check.error(place, f"{error}: also in {_file_of(known[0].source)}")

    def _add_one(self, check: Check, name: str, found: Clock | Wait | None, also: str) -> None:
        """Add the clock or the wait, of which there is one; a mistake in it has been noted."""
        known = getattr(self, name)
        if found is not None and known is not None and replace(known, source="") != replace(found, source=""):
            check.error((name,), f"{also} in {_file_of(known.source)}")
        setattr(self, name, known or found)

    def _add_probe(self, check: Check, probe: Probe, index: int) -> None:
        known = self.probes.setdefault(probe.target, probe)
        if replace(known, source="") != replace(probe, source=""):
            check.error(
                ("probe", index), f"is described twice, differently: also in {_file_of(known.source)}"
            )


def _find(name: str, root: Path) -> tuple[Document, bool]:
    """The document of this name, and whether mutabot ships it."""
    if (root / name).is_file():
        return Document.read(root / name, name), False
    file = _shipped_files().get(name)
    if file is not None:
        return Document.read(file, name), True
    raise UnknownNameError("vocabulary", name, _known_names(root))


def _known_names(root: Path) -> Iterable[str]:
    own = (path.name for path in root.glob("*.toml") if path.name not in ("pyproject.toml", "mutabot.toml"))
    return [*own, *shipped()]


def _sourceless(operation: Operation) -> Operation:
    patterns = tuple(replace(pattern, source="") for pattern in operation.patterns)
    return replace(operation, source="", patterns=patterns)


def _file_of(source: str) -> str:
    return source.partition(" · ")[0]


#: an operation with the document and place it was read from
Read = tuple[Operation, Check, KeyPath]


def check_operations(entries: Iterable[Read], read: Mapping[str, Read]) -> None:
    """Note every ``current`` and ``opposite`` that names no fitting operation.

    Args:
        entries: what each entry says.
        read: what all entries together say of each target.
    """
    for operation, check, place in entries:
        for name in operation.currents:
            _check_current(operation, name, check, (*place, "current"), read)
        if not operation.currents and any(one.relative for one in _all_arguments(operation)):
            check.error(place, "relative = true needs current: what tells where the robot is")
        for name in operation.opposites:
            _check_opposite(operation, name, check, (*place, "opposite"), read)


def _check_current(
    operation: Operation, name: str, check: Check, place: KeyPath, read: Mapping[str, Read]
) -> None:
    if name not in read:
        check.unknown(place, "operation", name, read)
        return
    reading = read[name][0]
    if reading.command and reading.named is None:
        check.error(place, f"{name} is a command: asking it where the robot is would make the robot act")
        return
    moved = [quantity for quantity in _all_arguments(operation) if quantity.kind in READING_OF]
    if not moved:
        check.error(place, "is of no use here: no argument is a translation or a rotation")
        return
    readings = reading.readings
    if not any(is_reading_of(reading, written) for written in moved for reading in readings):
        missing = ", ".join(dict.fromkeys(_wanted(quantity) for quantity in moved))
        found = ", ".join(_described(reading) for reading in readings) or "nothing"
        check.error(place, f"{name} reads {found}, but here it would have to read {missing}")


def _check_opposite(
    operation: Operation, name: str, check: Check, place: KeyPath, read: Mapping[str, Read]
) -> None:
    if name == operation.target:
        check.error(place, "an operation cannot be its own opposite")
        return
    if name not in read:
        check.unknown(place, "operation", name, read)
        return
    mine, others = (_roots(each) for each in (operation, read[name][0]))
    if mine != others:
        odd = sorted(mine ^ others)[0]
        who = name if odd in others else operation.target
        check.error(place, f"an opposite has the same arguments, but only {who} has {odd!r}")


def _all_arguments(operation: Operation) -> list[Quantity]:
    return [*operation.arguments, *(q for pattern in operation.patterns for q in pattern.arguments)]


def _roots(operation: Operation) -> set[str]:
    quantities = operation.arguments if operation.message is not None else _all_arguments(operation)
    return {quantity.path.root for quantity in quantities if quantity.path.root is not None}


def _wanted(written: Quantity) -> str:
    kind = READING_OF[written.kind]
    return " ".join(part for part in (kind, written.axis, _in_frame(written)) if part)


def _described(reading: Quantity) -> str:
    return " ".join(part for part in (reading.kind, reading.axis, _in_frame(reading)) if part)


def _in_frame(quantity: Quantity) -> str:
    return f"in frame {quantity.frame!r}" if quantity.frame is not None else ""
