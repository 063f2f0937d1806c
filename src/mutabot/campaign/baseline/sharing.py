"""What tests share, and which of them must therefore judge a mutant together, in the order of the suite.

A test may notice what an earlier one did: through a fixture that both use, through state of modules that the
earlier one left behind, through a file. A mutant that acts in the earlier test is then judged by the later
one too, in one process in which everything that led there happens as in the suite.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from mutabot.border.footprint import Footprint

#: what tells shared things apart: a name of a module and which of the objects it stood for, or a fixture
Shared = tuple[str, int]


@dataclass(slots=True)
class Sharing:
    """What the tests of one round share.

    Attributes:
        order: the tests in the order of the suite.
        reasons: tests that may change what any later test finds, and how.
        alone: tests in which it is not safe to fork for what they do to files or take down, and why.
        shared: test to what it shares with others: fixtures, and objects that module names stand for, by
            what tells them apart, each with a name for people.
        exclusive: tests that other processes get in the way of, and how.
    """

    order: list[str] = field(default_factory=list)
    reasons: dict[str, str] = field(default_factory=dict)
    alone: dict[str, str] = field(default_factory=dict)
    shared: dict[str, dict[Shared, str]] = field(default_factory=dict)
    exclusive: dict[str, str] = field(default_factory=dict)
    _known: dict[frozenset[str], tuple[str, str] | None] = field(default_factory=dict)

    @classmethod
    def of(cls, footprints: Sequence[tuple[str, Footprint | None]]) -> Sharing:
        """What these tests, in the order in which they ran, are known to leave and to use."""
        sharing = cls()
        replaceable = {name for _, found in footprints if found is not None for name in found.replaced}
        objects: Counter[str] = Counter()
        in_place: set[Shared] = set()
        for test, footprint in footprints:
            sharing.order.append(test)
            if footprint is None:
                continue
            objects.update(footprint.replaced)
            changed = replaceable.intersection(footprint.left).difference(footprint.replaced)
            in_place.update((name, objects[name]) for name in changed)
            sharing._add(test, footprint, replaceable)
            # whoever finds the object of an earlier test may look at it
            sharing.shared[test].update({(name, objects[name]): name for name in replaceable})
        for used in sharing.shared.values():
            for name in replaceable:
                if (name, 0) not in in_place:  # what was there before any test, as all tests left it
                    used.pop((name, 0), None)
        return sharing

    def _add(self, test: str, footprint: Footprint, replaceable: Collection[str]) -> None:
        used = {("", one.instance): f"fixture {one.name} ({one.scope})" for one in footprint.fixtures}
        used |= {("process", pid): f"the process {name}" for pid, name in footprint.processes}
        self.shared[test] = used
        taken_down = [one for one in footprint.fixtures if one.has_teardown]
        changed = [name for name in footprint.left if name not in replaceable]
        if changed:
            self.reasons[test] = f"it leaves something behind: {_listed(changed)}"
        elif footprint.outlives:
            self.reasons[test] = f"it {footprint.files[0]}"
        elif footprint.unseen:
            self.reasons[test] = f"nobody can see what it leaves behind in {_listed(footprint.unseen)}"
        if footprint.exclusive is not None:
            self.exclusive[test] = f"it {footprint.exclusive}"
        if footprint.files:
            self.alone[test] = f"it {footprint.files[0]}"
        elif taken_down:
            self.alone[test] = f"{used['', taken_down[0].instance]} may fail when it is taken down"

    def closure(self, tests: Collection[str]) -> tuple[str, ...]:
        """The tests that judge what acts in these ones, with those that must run before; in suite order."""
        judges = self._affected(set(tests))
        return tuple(self._with_predecessors(judges))

    def _affected(self, tests: set[str]) -> set[str]:
        found: set[str] = set()
        tainted: set[Shared] = set()
        everything = False
        for test in self.order:
            used = self.shared.get(test, {}).keys()
            if everything or test in tests or not tainted.isdisjoint(used):
                found.add(test)
                tainted |= used
                everything = everything or test in self.reasons
        return found

    def _with_predecessors(self, judges: set[str]) -> list[str]:
        found: list[str] = []
        needed: set[Shared] = set()
        for test in reversed(self.order):
            used = set(self.shared.get(test, {}))
            is_before = bool(found) and (test in self.reasons or not needed.isdisjoint(used))
            if test in judges or is_before:
                found.append(test)
                needed |= used
        return found[::-1]

    def why_together(self, tests: Collection[str]) -> tuple[str, str] | None:
        """A test of these that is not independent of the others of the suite, and why; None if all are."""
        key = frozenset(tests)
        if key not in self._known:
            self._known[key] = self._find_why(tests)
        return self._known[key]

    def _find_why(self, tests: Collection[str]) -> tuple[str, str] | None:
        closure = self.closure(tests)
        together = set(closure)
        for test in self.order:
            if test not in together:
                continue
            if test in self.reasons and test != closure[-1]:
                return test, self.reasons[test]
            for instance, name in self.shared.get(test, {}).items():
                others = [one for one in closure if one != test and instance in self.shared.get(one, {})]
                if others:
                    return test, f"it shares {name} with {others[0]}"
        return None

    def is_exclusive(self, tests: Collection[str]) -> bool:
        """Whether these tests must not run beside others."""
        return not self.exclusive.keys().isdisjoint(tests)

    def why_alone(self, tests: Collection[str]) -> tuple[str, str] | None:
        """A test of these that must not be forked, and why; None if there is none."""
        return next(((test, self.alone[test]) for test in tests if test in self.alone), None)


def remarks(rounds: Sequence[Sharing], not_private: str | None) -> list[str]:
    """What the user should know of tests that other processes get in the way of.

    ``not_private`` says why runs cannot keep their files to themselves, if they cannot.
    """
    exposed = {test: deed for sharing in reversed(rounds) for test, deed in sharing.exclusive.items()}
    if not exposed:
        return []
    test, deed = next(iter(exposed.items()))
    more = f", and {len(exposed) - 1} more tests do alike" if len(exposed) > 1 else ""
    why = f" ({not_private})" if not_private is not None else ""
    return [
        f"{test}: {deed}{more}, which is not private to a run{why}: nothing runs beside "
        f"{'them' if more else 'it'}, but what a mutant leaves there the next one finds"
    ]


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - 2} more" if len(names) > 2 else ""
    return ", ".join(names[:2]) + more
