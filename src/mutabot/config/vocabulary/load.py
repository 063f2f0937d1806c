"""Find, read, check and merge vocabulary files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from mutabot.config.document import Document
from mutabot.config.mistakes import DocumentPlace, raise_errors
from mutabot.errors import ConfigurationError, UnknownNameError, unknown_name_text
from mutabot.extensions import brought
from mutabot.families import OF_CALLS
from mutabot.faults import need_vocabulary
from mutabot.model import Clock, Kind, Operation, Probe, Quantity, Vocabulary, Wait
from mutabot.model.quantity import READING_OF, is_reading_of

from .operations import read_clock, read_operations, read_probe, read_wait
from .patterns import together
from .schema import VocabularyTable

#: lists of targets at the top of a file
_TARGETS = ("refusals", "checks", "failures")
_OTHERS = {"clock": read_clock, "wait": read_wait, "probe": read_probe}
_SHIPPED = Path(__file__).parent / "shipped"


def load_vocabulary(names: Sequence[str], root: Path, families: Iterable[str] = OF_CALLS) -> Vocabulary:
    """Return the vocabulary in these files, merged.

    Each name is a file relative to ``root``, or the name of a vocabulary that mutabot ships. What a file
    says of a callable, the clock or a probe goes before what a shipped vocabulary says of it. ``families``,
    those that are asked for, may do without any.

    Raises ConfigurationError, VocabularyError or UnknownNameError: the first mistake, with a message that
    names all of them.
    """
    merged = _Merged(need_vocabulary(families))
    documents = [_find(name, root) for name in dict.fromkeys(names)]
    for document, is_shipped in sorted(documents, key=lambda found: found[1]):
        merged.add(document, is_shipped)
    check_operations(merged.entries, merged.read)
    raise_errors(merged.errors)
    others = merged.others.values()
    return Vocabulary(
        operations=tuple(operation for operation, _ in merged.read.values()),
        clock=next((other for other in others if isinstance(other, Clock)), None),
        probes=tuple(_with_meaning(other, merged.read) for other in others if isinstance(other, Probe)),
        wait=next((other for other in others if isinstance(other, Wait)), None),
        **{name: tuple(dict.fromkeys(targets)) for name, targets in merged.targets.items()},
    )


def _with_meaning(probe: Probe, operations: Mapping[str, Read]) -> Probe:
    """Return a probe that says nothing of its parts with the angles and orientations of its operation."""
    operation = operations.get(probe.target)
    if probe.result or operation is None:
        return probe
    turns = (quantity for quantity in operation[0].result if quantity.is_whole or quantity.full_turn)
    return replace(probe, result=tuple(turns))


def shipped_vocabularies() -> tuple[str, ...]:
    """Return names of the vocabularies that mutabot and the packages beside it ship."""
    return tuple(sorted(_shipped_files()))


def _shipped_files() -> dict[str, Path]:
    own = {path.stem: path for path in _SHIPPED.glob("*.toml")}
    return {name: part.file for name, part in brought("vocabularies").items()} | own


@dataclass
class _Merged:
    """The merged content of the files read so far, and the mistakes in them."""

    is_needed: bool
    errors: list[ConfigurationError] = field(default_factory=list)
    read: dict[str, Read] = field(default_factory=dict)
    entries: list[Read] = field(default_factory=list)
    targets: dict[str, list[str]] = field(default_factory=lambda: {name: [] for name in _TARGETS})
    others: dict[str, Clock | Wait | Probe] = field(default_factory=dict)
    own: set[str] = field(default_factory=set)

    def add(self, document: Document, is_shipped: bool) -> None:
        place = DocumentPlace(document, self.errors)
        table = place.table(VocabularyTable, document.data, salvage=True)
        if table is None:
            return
        if not document.data and self.is_needed:
            place.error("describes nothing; a vocabulary describes operations: [[operation]]")
        for at, raw in (place / "operation").each(table.operation):
            for operation in read_operations(at, raw):
                if self._counts(operation.target, is_shipped):
                    self._add_operation(at, operation)
        for name, targets in self.targets.items():
            targets.extend(getattr(table, name))
        for key, read in _OTHERS.items():
            for at, raw in (place / key).each(getattr(table, key)):
                if raw is not None:
                    self._add_other(at, read(at, raw), is_shipped)

    def _counts(self, what: str, is_shipped: bool) -> bool:
        """Return whether a description is used: the user's own, read first, override shipped ones."""
        if not is_shipped:
            self.own.add(what)
        return not is_shipped or what not in self.own

    def _add_operation(self, place: DocumentPlace, operation: Operation) -> None:
        known = self.read.get(operation.target)
        self.entries.append((operation, place))
        if known is None:
            self.read[operation.target] = (operation, place)
            return
        also = _file_of(known[0].source)
        if known[0].is_partial and operation.is_partial:
            try:
                self.read[operation.target] = (together(known[0], operation), known[1])
            except ValueError as error:
                place.error(f"{error}: also in {also}")
        elif known[0].is_partial or operation.is_partial:
            place.error(f"{operation.target} is described with and without when: also in {also}")
        elif _sourceless(known[0]) != _sourceless(operation):
            is_call = operation.named is None
            where, what = (place / "call", "") if is_call else (place, f"{operation.target} ")
            where.error(f"{what}is described twice, differently: also in {also}")

    def _add_other(self, place: DocumentPlace, found: Clock | Wait | Probe | None, is_shipped: bool) -> None:
        """Add the clock, the wait or a probe, if it has no mistake, and note an earlier one that differs."""
        key = f"probe {found.target}" if isinstance(found, Probe) else type(found).__name__
        if found is None or not self._counts(key, is_shipped):
            return
        known = self.others.setdefault(key, found)
        if replace(known, source="") != replace(found, source=""):
            place.error(f"is described twice, differently: also in {_file_of(known.source)}")


def _find(name: str, root: Path) -> tuple[Document, bool]:
    """Return the document of this name, and whether mutabot ships it."""
    if (root / name).is_file():
        return Document.read(root / name, name), False
    file = _shipped_files().get(name)
    if file is not None:
        return Document.read(file, name), True
    raise UnknownNameError(unknown_name_text("vocabulary", name, _known_names(root)))


def _known_names(root: Path) -> Iterable[str]:
    own = (path.name for path in root.glob("*.toml") if path.name not in ("pyproject.toml", "mutabot.toml"))
    return [*own, *shipped_vocabularies()]


def _sourceless(operation: Operation) -> Operation:
    patterns = tuple(replace(pattern, source="") for pattern in operation.patterns)
    return replace(operation, source="", patterns=patterns)


def _file_of(source: str) -> str:
    return source.partition(" · ")[0]


#: an operation with the place it was read from
Read = tuple[Operation, DocumentPlace]


def check_operations(entries: Iterable[Read], read: Mapping[str, Read]) -> None:
    """Note every ``current`` and ``opposite`` that names no fitting operation.

    Args:
        entries: what each entry says.
        read: what all entries together say of each target.
    """
    for operation, place in entries:
        for key, names in (("current", operation.currents), ("opposite", operation.opposites)):
            for name in names:
                if name in read:
                    check = _check_current if key == "current" else _check_opposite
                    (place / key).attempt(check, operation, name, read[name][0])
                else:
                    (place / key).unknown("operation", name, read)
        if not operation.currents and any(argument.relative for argument in _all_arguments(operation)):
            place.error("relative = true needs current: the operation that reads where the robot is")


def _check_current(operation: Operation, name: str, reading: Operation) -> None:
    """Raise ValueError if a reading does not give the start of another operation's motion."""
    if reading.command and reading.named is None:
        raise ValueError(f"{name} is a command: asking it where the robot is would make the robot act")
    moved = [quantity for quantity in _all_arguments(operation) if quantity.kind in READING_OF]
    if not moved:
        raise ValueError("has no effect here: no argument is a translation or a rotation")
    readings = reading.readings
    if not any(is_reading_of(quantity, written) for written in moved for quantity in readings):
        missing = ", ".join(
            dict.fromkeys(_described(quantity, READING_OF[quantity.kind]) for quantity in moved)
        )
        found = ", ".join(_described(quantity, quantity.kind) for quantity in readings) or "nothing"
        raise ValueError(f"{name} reads {found}, but here it would have to read {missing}")


def _check_opposite(operation: Operation, name: str, opposite: Operation) -> None:
    """Raise ValueError if an operation cannot replace another."""
    if name == operation.target:
        raise ValueError("an operation cannot be its own opposite")
    mine, others = (_roots(each) for each in (operation, opposite))
    if mine != others:
        odd = sorted(mine ^ others)[0]
        who = name if odd in others else operation.target
        raise ValueError(f"an opposite has the same arguments, but only {who} has {odd!r}")


def _all_arguments(operation: Operation) -> list[Quantity]:
    return [*operation.arguments, *(q for pattern in operation.patterns for q in pattern.arguments)]


def _roots(operation: Operation) -> set[str]:
    quantities = operation.arguments if operation.message is not None else _all_arguments(operation)
    return {quantity.path.root for quantity in quantities if quantity.path.root is not None}


def _described(quantity: Quantity, kind: Kind) -> str:
    frame = f"in frame {quantity.frame!r}" if quantity.frame is not None else ""
    return " ".join(part for part in (kind, quantity.axis, frame) if part)
