"""What tests share, and which of them must therefore judge a mutant together, in the order of the suite.

A test may notice what an earlier one did: through a fixture that both use, through state of modules that the
earlier one left behind, through a file. A mutant that acts in the earlier test is then judged by the later
one too, in one process in which everything that led there happens as in the suite.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from mutabot.model import Footprint


@dataclass(slots=True)
class Sharing:
    """What the tests of one round share.

    Attributes:
        order: the tests in the order of the suite.
        reasons: tests that may change what any later test finds, and how.
        alone: tests in which it is not safe to fork for what they do to files or take down, and why.
        fixtures: test to the shared fixtures that it used, as instance to name.
    """

    order: list[str] = field(default_factory=list)
    reasons: dict[str, str] = field(default_factory=dict)
    alone: dict[str, str] = field(default_factory=dict)
    fixtures: dict[str, Mapping[int, str]] = field(default_factory=dict)

    @classmethod
    def of(cls, footprints: Sequence[tuple[str, Footprint | None]]) -> Sharing:
        """What these tests, in the order in which they ran, are known to leave and to use."""
        sharing = cls()
        for test, footprint in footprints:
            sharing.order.append(test)
            if footprint is not None:
                sharing._add(test, footprint)
        return sharing

    def _add(self, test: str, footprint: Footprint) -> None:
        used = {one.instance: f"fixture {one.name} ({one.scope})" for one in footprint.fixtures}
        self.fixtures[test] = used
        taken_down = [one for one in footprint.fixtures if one.has_teardown]
        if footprint.left:
            self.reasons[test] = f"it leaves something behind: {_listed(list(footprint.left))}"
        elif footprint.outlives:
            self.reasons[test] = f"it {footprint.files[0]}"
        elif footprint.unseen:
            self.reasons[test] = f"nobody can see what it leaves behind in {_listed(footprint.unseen)}"
        if footprint.files:
            self.alone[test] = f"it {footprint.files[0]}"
        elif taken_down:
            self.alone[test] = f"{used[taken_down[0].instance]} may fail when it is taken down"

    def closure(self, tests: Collection[str]) -> tuple[str, ...]:
        """The tests that judge what acts in these ones, with those that must run before; in suite order."""
        judges = self._affected(set(tests))
        return tuple(self._with_predecessors(judges))

    def _affected(self, tests: set[str]) -> set[str]:
        found: set[str] = set()
        tainted: set[int] = set()
        everything = False
        for test in self.order:
            used = self.fixtures.get(test, {}).keys()
            if everything or test in tests or not tainted.isdisjoint(used):
                found.add(test)
                tainted |= used
                everything = everything or test in self.reasons
        return found

    def _with_predecessors(self, judges: set[str]) -> list[str]:
        found: list[str] = []
        needed: set[int] = set()
        for test in reversed(self.order):
            used = self.fixtures.get(test, {}).keys()
            is_before = bool(found) and (test in self.reasons or not needed.isdisjoint(used))
            if test in judges or is_before:
                found.append(test)
                needed |= used
        return found[::-1]

    def why_together(self, tests: Collection[str]) -> tuple[str, str] | None:
        """A test of these that is not independent of the others of the suite, and why; None if all are."""
        closure = self.closure(tests)
        together = set(closure)
        for test in self.order:
            if test not in together:
                continue
            if test in self.reasons and test != closure[-1]:
                return test, self.reasons[test]
            for instance, name in self.fixtures.get(test, {}).items():
                others = [one for one in closure if one != test and instance in self.fixtures.get(one, {})]
                if others:
                    return test, f"it shares {name} with {others[0]}"
        return None

    def why_alone(self, tests: Collection[str]) -> tuple[str, str] | None:
        """A test of these that must not be forked, and why; None if there is none."""
        return next(((test, self.alone[test]) for test in tests if test in self.alone), None)


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - 2} more" if len(names) > 2 else ""
    return ", ".join(names[:2]) + more
