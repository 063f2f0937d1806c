"""The dependencies of an outcome, by content: without a change it need not be run again.

An outcome has a *key* of five digests: of what all outcomes share (settings, versions, files that are no
program text), of what those at its place share (tests, entries of the vocabulary), of the mutant's own, of
the program files when it was found, and of the units in them that its tests have executed. All but the third
stand for *parts*, names with a digest or a plain value each.

The tests are those that reach the mutant, up to the one that killed it. The others count only where one of
them has noticed it: then all tests do.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.reuse.parts import Parts, environment_parts, everything_of, operation_parts
from mutabot.campaign.reuse.source_tree import SourceTree
from mutabot.frozen import frozen
from mutabot.journal.records import ACCEPTED
from mutabot.model.codec import data_digest
from mutabot.model.job import Idle
from mutabot.model.mutant_end import MutantEnd
from mutabot.model.source_units import ALL_FILES, WHOLE, Executed, is_test_file, together
from mutabot.model.suppression import Accepted

from .snapshot import HASH, State, counts_by_name, read

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.request import Request
    from mutabot.journal.journal import Journal
    from mutabot.model import Mutant, Outcome


#: parts of a place: the tests that reach it, or all of them if one that does not has noticed it; the one that
#: decided; and those that are set aside
_REACHING, _SUITE, _UNTIL = "which tests reach it", "which tests there are", "the test that decided"
_ASIDE = "which tests are set aside"


@frozen
class PastDependencies:
    """The dependencies of an outcome when it was found, or at a revision.

    Attributes:
        common, place, own: as in its key.
        tree: the program files of then.
        found_in: those in which it was found; the executed units are identified by their lines.
        executed: what of them was executed; None if that is not known.
        notes: digests of notes that were read.
    """

    common: Parts | None
    place: Parts | None
    own: str
    tree: SourceTree
    found_in: SourceTree
    executed: Executed | None
    notes: Parts


class Dependencies:
    """The dependencies of the outcomes of a campaign.

    Args:
        request, baseline: the campaign.
        state: the project's files.
        installed: what is installed, see ``installed``.
        read: what a file of the configuration holds.
        absent: tests of the baseline that were not there yet, at a revision.

    Attributes:
        request: the campaign.
        installed: as given.
        files: the files that count, with their digests.
        notes: the others.
        parts: what the digests in keys stand for; grows as keys are made.
        texts: what stands in the program files.
        tree: the program files.
        common: what all outcomes depend on.
    """

    def __init__(
        self,
        request: Request,
        baseline: Baseline,
        state: State,
        installed: Parts,
        read: Callable[[Path], bytes | None] = read,
        absent: Collection[str] = (),
    ) -> None:
        self.request, self._baseline, self.absent = request, baseline, absent
        self.installed = installed
        self.files, self.notes, self.texts = state.files, state.notes, state.texts
        self.parts: dict[str, Parts] = {}
        self._returned = 0
        self._idle: dict[int, Executed] = {}
        self._made: dict[tuple[int, ...], tuple[tuple[object, ...], list[str]]] = {}
        self._groups: dict[tuple[str, ...], tuple[str, ...]] = {}
        code = {name: digest for name, digest in self.files.items() if name in self.texts}
        self.tree = SourceTree(code, lambda name, digest: self.texts.get(name))
        self._tree = self._stored(code)
        self.common = {
            **{name: digest for name, digest in self.files.items() if name not in self.texts},
            **dict(self._around()),
            **environment_parts(request, self.files, installed, read),
        }
        self._common = self._stored(self.common)
        self._operations = {
            operation.target: operation_parts(request.vocabulary, operation.target)
            for operation in request.vocabulary.operations
        }

    def _around(self) -> Iterator[tuple[str, str]]:
        """Yield the program files that exist: a new one may shadow another, a new test cannot."""
        for name in self.tree.digests:
            if not is_test_file(name):
                yield name, "there"
                continue
            file = self.tree.file(name)
            if file is not None and not file.is_quiet:
                yield file.shown(""), f"#{file.digests['']}"

    def was(
        self,
        key: str,
        parts: Callable[[str], Parts | None],
        tree: Callable[[str], SourceTree],
    ) -> PastDependencies:
        """Return what an outcome with this key depended on.

        Args:
            parts: what a digest stands for.
            tree: the program files that a digest stands for.
        """
        common, place, own, files, executed = (*key.split(), *[""] * 5)[:5]  # a journal may hold anything
        found_in = self.tree if files == self._tree else tree(files)
        units = parts(executed)
        lines = {k: v for k, v in (units or {}).items() if k == ALL_FILES or k in found_in.digests}
        return PastDependencies(
            self.common if common == self._common else parts(common),
            parts(place),
            own,
            found_in,
            found_in,
            None if units is None else {name: _lines(value) for name, value in lines.items()},
            {k: v for k, v in (units or {}).items() if k not in lines},
        )

    @property
    def everything(self) -> Parts:
        """Everything that any outcome depends on, except what a mutant does."""
        return everything_of(self.request, self.files, self.installed)

    def key_of(self, outcome: Outcome, mutant: Mutant, executed: str) -> str:
        """Return the key of a new outcome; ``executed`` is the digest of its units, from ``stored``."""
        noticed = {outcome.test, *(kill.test for kill in outcome.kills)}
        is_noticed = outcome.verdict.is_killed or outcome.test is not None
        whole = is_noticed and not noticed.issubset(self._baseline.tests_reaching(outcome.round, mutant))
        is_first = outcome.verdict.is_killed and not self.request.every_test
        place = self.place(mutant, outcome.round, whole, (outcome.test or "") if is_first else "")
        parts = self._common, self._stored(place), self.own(mutant, outcome.round), self._tree, executed
        return " ".join(parts)

    def stored(self, executed: Executed | None) -> str:
        """Store executed units, and the files that were read, and return their digest."""
        if executed is None:
            return self._stored({ALL_FILES: "0"})
        found = {
            name: " ".join(map(str, lines)) if name in self.texts else self.notes.get(name, "")
            for name, lines in executed.items()
            if name in self.texts or (name not in self.files and counts_by_name(name))
        }
        return self._stored({**found, **({ALL_FILES: "0"} if ALL_FILES in executed else {})})

    def tests(self, mutant: Mutant, round: int, *, whole: bool, until: str = "") -> tuple[str, ...]:
        """Return the tests that an outcome depends on, in order, up to the one that decided."""
        reaching = set(self._baseline.tests_reaching(round, mutant))
        suite = tuple(test for test in self._baseline.suite(round) if test not in self.absent)
        found = suite if whole else tuple(test for test in suite if test in reaching)
        return found[: found.index(until) + 1] if until in found else found

    def place(self, mutant: Mutant, round: int, whole: bool, until: str) -> Parts:
        """Return the dependencies that all outcomes at the place of a mutant share."""
        aside = self._baseline.missing_judges(round, mutant)
        names = (mutant.operation,) if mutant.operation else tuple(self._operations)
        entries = {k: v for name in names for k, v in self._operations.get(name, {}).items()}
        tests = self.tests(mutant, round, whole=whole, until=until)
        return {
            **entries,
            (_SUITE if whole else _REACHING): HASH + data_digest(tests),
            **({_UNTIL: until} if until else {}),
            **({_ASIDE: HASH + data_digest(sorted(aside))} if aside else {}),
        }

    def own(self, mutant: Mutant, round: int) -> str:
        """Return what a mutant does, beyond what its id says."""
        planted = self._baseline.faults.by_id.get(mutant.id)
        does = planted.does if planted is not None else None
        return data_digest([mutant.provider, Idle.of(mutant.idle).in_round(round), mutant.pattern, does])

    def why(self, was: PastDependencies, mutant: Mutant, round: int, *, is_known: bool = True) -> list[str]:
        """Return why an outcome with these dependencies may differ now; empty if it cannot.

        ``is_known``: whether anything is known of the mutant now; not if its family is not asked for.
        """
        if was.common is None or was.place is None:
            return ["what they depend on is not known any more"]
        found = self._differing_units(was, mutant, round)
        if is_known:
            found = [*found, *changed_parts(was.place, self.place(mutant, round, *self.asked(was)))]
        if was.common is not self.common:
            common = was.common
            found = [*found, *self._once(lambda: changed_parts(common, self.common), common)]
        if is_known and was.own != self.own(mutant, round) and not found:
            found = ["the calls return something else" if mutant.operation else "it does something else"]
        return found

    def renewed(self, key: str, was: PastDependencies, mutant: Mutant, round: int) -> str:
        """Return the current key of an outcome that still holds, with the current lines of its units."""
        place = self.place(mutant, round, *self.asked(was))
        executed: dict[str, tuple[int, ...]] = dict.fromkeys(was.notes, ())
        for name, units in _names(was).items():
            now = self.tree.file(name)
            if now is not None:
                executed[name] = now.lines_of(units)
        is_all = was.executed is None or ALL_FILES in was.executed
        stored = self.stored(None if is_all else executed)
        return " ".join((self._common, self._stored(place), key.split()[2], self._tree, stored))

    def asked(self, was: PastDependencies) -> tuple[bool, str]:
        """Return whether an outcome depended on the whole suite, and the last test that it depended on."""
        place = was.place or {}
        return _SUITE in place, place.get(_UNTIL, "")

    def executed_by(self, mutant: Mutant, round: int) -> Executed | None:
        """Return the units executed by tests that reach a mutant, and those that no test executes."""
        executed = self._baseline.executed[round]
        if round not in self._idle:
            everywhere = executed.by(self._baseline.suite(round)) or {}
            files = [self.tree.file(name) for name in self.tree.digests if not is_test_file(name)]
            self._idle[round] = {
                file.name: tuple({*file.lines_of(file.digests)}.difference(everywhere.get(file.name, ())))
                for file in files
                if file is not None
            }
        tests = self._baseline.tests_reaching(round, mutant)
        return together([executed.by(tests), self._idle[round]])

    def _once(self, made: Callable[[], list[str]], *of: object) -> list[str]:
        """Return the texts of these objects, made once; the objects are kept, so their ids stay unique."""
        key = tuple(map(id, of))
        if key not in self._made:
            self._made[key] = of, made()
        return self._made[key][1]

    def _differing_units(self, was: PastDependencies, mutant: Mutant, round: int) -> list[str]:
        is_all = was.executed is None or ALL_FILES in was.executed
        whole, until = self.asked(was)
        tests = self.tests(mutant, round, whole=whole, until=until)
        tests = self._baseline.tests_reaching(round, mutant) if is_all else tests
        group = self._groups.setdefault((str(round), *tests), (str(round), *tests))

        def differing() -> list[str]:
            names = self._names_of_all(was.tree, tests) if is_all else _names(was)
            notes = {name: self.notes.get(name, self.files.get(name, "")) for name in was.notes}
            found = [*_differing(names, was.tree, self.tree), *changed_parts(was.notes, notes)]
            return found or ([] if is_all else self._executed_now(names, tests, round))

        return self._once(differing, was.tree, was.found_in, was.executed, was.notes, group)

    def _executed_now(
        self, before: Mapping[str, set[str] | None], tests: Iterable[str], round: int
    ) -> list[str]:
        """Describe units that tests execute now and did not before: they may shadow what was executed."""
        executed = self._baseline.executed[round].by(tests)
        if executed is None or ALL_FILES in executed:
            return ["its tests start processes now"]
        found = []
        for name, lines in executed.items():
            file, known = self.tree.file(name), before.get(name, set())
            if file is None or known is None:
                continue
            now = file.names_at(lines)
            new = {""} if now is None else now - known
            if now is not None and is_test_file(name) and file.is_quiet:
                new = new - {""}
            found += [f"{file.shown(unit)} is executed now" for unit in sorted(new)]
        return found

    def _names_of_all(self, tree: SourceTree, tests: Iterable[str]) -> dict[str, set[str] | None]:
        """Return all units of both trees, except those of other tests."""
        own = {(self.file_of(test), _function_of(test)) for test in tests}

        def counts(name: str, unit: str) -> bool:
            is_test = is_test_file(name) and unit.rpartition(".")[2].startswith("test")
            return not is_test or (name, unit) in own

        found: dict[str, set[str] | None] = {}
        for name in {*tree.digests, *self.tree.digests}:
            files = [file for file in (tree.file(name), self.tree.file(name)) if file is not None]
            found[name] = {unit for file in files for unit in file.digests if counts(name, unit)}
        return found

    def is_of(self, test: str, tree: SourceTree) -> bool:
        """Return whether a current test existed in a tree; assumed of a test that is no function."""
        file, name = self.file_of(test), _function_of(test)
        now, then = self.tree.file(file), tree.file(file)
        return now is None or name not in now.digests or (then is not None and name in then.digests)

    def file_of(self, test: str) -> str:
        """Return the test's file relative to the project's root; pytest's root may be a folder above."""
        name = test.partition("::")[0]
        while name not in self.files and "/" in name:
            name = name.partition("/")[2]
        return name

    def new_parts(self) -> Mapping[str, Parts]:
        """Return the parts that are new since the last call."""
        new = dict(islice(self.parts.items(), self._returned, None))
        self._returned = len(self.parts)
        return new

    def _stored(self, parts: Parts) -> str:
        digest = data_digest(parts)
        self.parts[digest] = parts
        return digest


class OutcomeWriter:
    """Writes outcomes into the journal of a campaign, each with the key of what it depends on.

    Args:
        dependencies: None where files change meanwhile: then they are unknown, and nothing is to be reused.
        mutants: those of the plan.
        on_outcome: called with each outcome, first with those that the journal holds already.

    Attributes:
        journal: where they go.
    """

    def __init__(
        self,
        journal: Journal,
        dependencies: Dependencies | None = None,
        mutants: Iterable[Mutant] = (),
        on_outcome: Callable[[MutantEnd], None] = lambda end: None,
    ) -> None:
        self.journal, self._dependencies, self._on_outcome = journal, dependencies, on_outcome
        self._mutants = {mutant.id: mutant for mutant in mutants}
        accepting: Accepted = journal.meta().get(ACCEPTED) or Accepted()
        self._acceptances = accepting.mutants
        for outcome in journal.outcomes():
            self._report_units(outcome, is_reused=True)

    def add_outcome(self, outcome: Outcome) -> None:
        """Add an outcome, replacing an earlier one of the same mutant and round."""
        key = self._key_of(outcome, self._dependencies) if self._dependencies is not None else ""
        self.journal.add_outcome(replace(outcome, executed=None), key=key)
        self._report_units(outcome)

    def _report_units(self, outcome: Outcome, *, is_reused: bool = False) -> None:
        mutant = self._mutants.get(outcome.mutant)
        if mutant is not None:
            self._on_outcome(MutantEnd(mutant, outcome, self._acceptances.get(mutant.id), is_reused))

    def _key_of(self, outcome: Outcome, dependencies: Dependencies) -> str:
        executed = dependencies.stored(outcome.executed)
        if outcome.repeats and outcome.executed is None:  # it is in the journal, and was run once more
            before = self.journal.row(outcome.mutant, outcome.round)
            executed = before.key.split()[-1] if before is not None and before.key else executed
        key = dependencies.key_of(outcome, self._mutants[outcome.mutant], executed)
        self.journal.add_parts(dependencies.new_parts())
        return key


def _function_of(test: str) -> str:
    """Return the qualified name of a test's function."""
    return ".".join(part.partition("[")[0] for part in test.split("::")[1:])


def _lines(text: str) -> tuple[int, ...]:
    try:
        return tuple(map(int, text.split()))
    except ValueError:
        return (WHOLE,)


def _names(was: PastDependencies) -> dict[str, set[str] | None]:
    """Return the names of the executed units by file; None for a file that counts as a whole."""
    files = {name: (was.found_in.file(name), lines) for name, lines in (was.executed or {}).items()}
    return {name: None if file is None else file.names_at(lines) for name, (file, lines) in files.items()}


def _differing(names: Mapping[str, set[str] | None], old: SourceTree, new: SourceTree) -> list[str]:
    """Describe the code units that differ between two trees; new ones come last."""
    found, made = [], []
    for name in sorted(names):
        units = names[name]
        if old.digests.get(name) == new.digests.get(name):
            continue
        before, now = old.file(name), new.file(name)
        if units is None or before is None or now is None or not (before.is_python and now.is_python):
            state = "is new" if name not in old.digests else "changed"
            found.append(f"{name} {state if name in new.digests else 'is gone'}")
            continue
        for unit in sorted(units):
            stored, says = before.digests.get(unit), now.digests.get(unit)
            if stored is None and says is not None:
                made.append(f"{now.shown(unit)} is new")
            elif stored != says:
                found.append(f"{before.shown(unit)} {'changed' if says is not None else 'is gone'}")
    return found + made


def changed_parts(old: Parts, new: Parts) -> list[str]:
    """Describe the parts that differ, files of the project first."""
    found = []
    for name in {*old, *new}:
        before, now = old.get(name), new.get(name)
        is_setting = not any(value is not None and value.startswith(HASH) for value in (before, now))
        what = f"is {now}, was {before}" if is_setting else "changed"
        what = "is new" if before is None else "is gone" if now is None else what
        found += [(is_setting, name, what)] if before != now else []
    return [f"{name} {what}" for _, name, what in sorted(found)]
