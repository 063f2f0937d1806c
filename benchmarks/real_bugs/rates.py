"""Which operators are common: how often their faults occur, and how many of their mutants are useless.

An operator is *common* if it makes at least ``FREQUENT`` of the real bugs of ``reading.toml`` exactly or
nearly, and if of its mutants of the programs of ``coupling.json``, ``MEASURED`` or more, less than a share of
``USELESS`` are useless: *refused* by the robot, *stillborn* (all that notices them sees an error of a name or
type), or *equivalent* as far as is known (the same as the original for all tests and inputs of the probe; on
the cell and on ROS 2, for all tests as far as the campaign compares).
Operators that are not measured are not common.

Use: ``python benchmarks/real_bugs/rates.py``.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from real_bugs.gathering import BUGS, REFUSED, SAME, STILLBORN, Found, read
from real_bugs.shares import Bug, silent

DATA = Path(__file__).with_name("coupling.json")
FREQUENT, MEASURED, USELESS = 3, 5, 0.2


@dataclass(frozen=True)
class Rate:
    """An operator in numbers.

    Attributes:
        family, operator: what it is.
        bugs: how many real bugs it makes, exactly or nearly.
        mutants: how many mutants it has.
        programs: in how many programs.
        ends: how many of them are refused, stillborn and equivalent.
    """

    family: str
    operator: str
    bugs: int
    mutants: int
    programs: int
    ends: tuple[int, int, int]

    @property
    def useless(self) -> float:
        """The share of its mutants that are of no use."""
        return sum(self.ends) / self.mutants

    @property
    def is_common(self) -> bool:
        """Whether ``--operators common`` keeps it."""
        return self.bugs >= FREQUENT and self.mutants >= MEASURED and self.useless < USELESS


def frequencies(bugs: Iterable[Bug]) -> Counter[str]:
    """Return how many bugs each operator makes, exactly or nearly; a bug counts for each that makes it."""
    found: Counter[str] = Counter()
    for bug in bugs:
        by = set(bug.get("robot_by", ())) if bug["robot"] in "EM" else set[str]()
        by |= {bug["conventional_by"]} if bug["conventional"] in "EM" else set()
        by |= {bug["now_by"]} if "now" in bug else set()
        found.update(by)
    return found


def rates(programs: Sequence[Found], bugs: Iterable[Bug]) -> list[Rate]:
    """Return the operators that have mutants in these programs, the most frequent first."""
    frequent = frequencies(bugs)
    found = []
    for family, operator in {
        (mutant.family, mutant.operator) for each in programs for mutant in each.mutants
    }:
        if family == BUGS:
            continue
        own = [[mutant.end for mutant in each.mutants if mutant.operator == operator] for each in programs]
        counts = Counter(end for ends in own for end in ends)
        ends = (counts[REFUSED], counts[STILLBORN], counts[SAME])
        is_in = sum(map(bool, own))
        found.append(Rate(family, operator, frequent[operator], counts.total(), is_in, ends))
    return sorted(found, key=lambda rate: (-rate.bugs, rate.operator))


def main() -> int:
    """The command."""
    found = rates(read(DATA), silent())
    print("| operator | bugs | mutants (programs) | refused | stillborn | equivalent | useless | common |")
    print("|---|---|---|---|---|---|---|---|")
    for rate in found:
        counts = f"{rate.mutants} ({rate.programs}) | {' | '.join(map(str, rate.ends))}"
        ending = f"{100 * rate.useless:.0f} % | {'yes' if rate.is_common else 'no'}"
        print(f"| {rate.operator} | {rate.bugs} | {counts} | {ending} |")
    print(f"\ncommon: {', '.join(sorted(common.operator for common in found if common.is_common))}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
