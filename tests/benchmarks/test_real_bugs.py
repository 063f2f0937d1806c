"""What operators and pages say of the real bugs is what the reading of their fixes and the benchmark have."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from mutabot.campaign.faults.providers import rules_of
from mutabot.faults import known_families
from mutabot.model import By, Kill, Mutant, Outcome, Role, Verdict
from mutabot.results.bugs_caught import BANDS
from mutabot.results.results import MutantResult, Results
from mutabot.results.score import RoundScores
from mutabot_patches.changes import read_patch
from mutabot_patches.suite import looks_like_tests
from mutabot_source.registry import names, operator
from real_bugs import coupling
from real_bugs.gathering import (
    BUGS,
    DIFFERS,
    KILLED,
    PROGRAMS,
    REFUSED,
    SAME,
    STILLBORN,
    Found,
    Noticed,
    judged,
    read,
    write,
)
from real_bugs.rates import DATA, Rate, rates
from real_bugs.shares import agreement, by_operator, now, second_reading, share, silent
from tests.results import samples

PAGE = (Path(__file__).parents[2] / "docs" / "real-bugs.md").read_text(encoding="utf-8")
FOUND = read(DATA)


def test_each_operator_of_the_family_says_how_many_bugs_it_stands_for() -> None:
    found = by_operator(silent())
    assert sorted(found) == sorted(names("bugs"))
    for name, counts in found.items():
        told = f": {counts['E']} of 253 silent bugs of public robot programs exactly, {counts['M']} nearly."
        assert told in operator(name).rationale
        assert f"| {name} | {counts['E']} | {counts['M']} |" in PAGE


def test_a_later_class_is_a_better_one_and_crashes_have_none() -> None:
    bugs = silent()
    assert len(bugs) == 253
    assert Counter(bug["class"] for bug in bugs)["sign"] == 26
    assert all("EMTN".index(bug["now"]) < "EMTN".index(bug["robot"]) for bug in bugs if "now" in bug)


def test_the_page_has_the_shares() -> None:
    bugs = silent()
    for told in (
        share([bug["robot"] == "E" for bug in bugs]),
        share([now(bug) == "E" for bug in bugs]),
        share([now(bug) in "EM" for bug in bugs]),
        share(["E" in (now(bug), bug["conventional"]) for bug in bugs]),
    ):
        assert re.search(rf"\| {re.escape(told)} \|", PAGE)


def test_the_page_has_both_readers_classes() -> None:
    bugs = silent()
    assert "\n".join(second_reading(bugs)) in PAGE
    agreed = sum(now(bug) == "E" == bug["second"][0] for bug in bugs)
    assert f"Both call {agreed} of 253 exact" in PAGE


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        ("1100", "1100", "100 %, κ = 1.00"),
        ("1100", "1010", "50 %, κ = 0.00"),
        ("1100", "0011", "0 %, κ = -1.00"),
    ],
)
def test_agreement_is_what_is_more_than_chance(first: str, second: str, told: str) -> None:
    assert agreement(*([mark == "1" for mark in marks] for marks in (first, second))) == told


def test_each_bug_of_the_programs_applies_and_says_its_class() -> None:
    classes = {bug["class"] for bug in silent()}
    found = sorted(PROGRAMS.glob("*/patches/*.patch"))
    assert len(found) >= 60
    for file in found:
        patch = read_patch(file.read_bytes(), file.parents[1], looks_like_tests)
        assert not patch.notes
        assert patch.title.partition(": ")[0] in classes


def test_the_data_have_the_bugs_and_tests_that_there_are() -> None:
    assert [gathered.name for gathered in FOUND] == sorted(path.name for path in PROGRAMS.iterdir())
    for real_program in FOUND:
        bugs = {each.what.partition(": ")[0] for each in real_program.mutants if each.family == BUGS}
        assert bugs == {file.stem for file in (PROGRAMS / real_program.name / "patches").glob("*.patch")}
        texts = [
            file.read_text(encoding="utf-8") for file in (PROGRAMS / real_program.name / "tests").glob("*.py")
        ]
        defined = set(re.findall(r"^def (test_\w+)", "\n".join(texts), re.MULTILINE))
        assert {test.rpartition("::")[2].partition("[")[0] for test in real_program.tests} == defined


def test_reports_say_of_scores_what_the_data_say() -> None:
    assert {family: coupling.bands(FOUND, family) for family in BANDS} == BANDS


@pytest.mark.parametrize(
    "part", [coupling.of_suites, coupling.of_coupling, coupling.of_minimal, coupling.of_scores]
)
def test_the_page_has_the_tables_of_the_data(part: coupling.Table) -> None:
    assert "\n".join(part(FOUND)) in PAGE


def test_operators_are_common_as_the_rates_say() -> None:
    common = {rate.operator for rate in rates(FOUND, silent()) if rate.is_common}
    assert {rule.name for rule in rules_of(known_families()) if rule.is_common} == common
    assert f"{len(common)} operators are common" in PAGE


@pytest.mark.parametrize(
    ("bugs", "mutants", "ends", "is_common"),
    [
        (3, 5, (0, 0, 0), True),
        (2, 5, (0, 0, 0), False),
        (3, 4, (0, 0, 0), False),
        (3, 10, (1, 0, 0), True),
        (3, 10, (1, 0, 1), False),
        (3, 10, (0, 1, 1), False),
    ],
)
def test_common_operators_are_frequent_measured_and_of_use(
    bugs: int, mutants: int, ends: tuple[int, int, int], is_common: bool
) -> None:
    assert Rate("robot", "reverse", bugs, mutants, 3, ends).is_common is is_common


def test_rank_correlation() -> None:
    assert coupling.spearman([1, 2, 3, 4], [10, 20, 25, 90]) == pytest.approx(1.0)
    assert coupling.spearman([1, 2, 3], [3, 2, 1]) == pytest.approx(-1.0)
    assert coupling.spearman([1, 2, 2, 3], [1, 3, 2, 4]) == pytest.approx(0.9486833)
    assert coupling.spearman([1, 1, 1], [1, 2, 3]) == 0.0


def test_an_interval_holds_the_mean_and_has_no_width_where_all_are_equal() -> None:
    low, high = coupling.interval([0.0, 0.0, 1.0, 1.0], lambda drawn: sum(drawn) / len(drawn))
    assert 0.0 <= low < 0.5 < high <= 1.0
    assert coupling.interval([2.0, 2.0], lambda drawn: sum(drawn) / len(drawn)) == (2.0, 2.0)


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    mutants = [
        Noticed(BUGS, "", "no-wait: missing-wait: ü", KILLED, frozenset({"b"})),
        Noticed("conventional", "AOR", "1: a + b → a - b", SAME),
    ]
    found = Found("base", ["a", "b"], {"a": frozenset({1}), "b": frozenset({1, 2})}, mutants)
    write(tmp_path / "data.json", [found, Found("other", [], {})])
    again, other = read(tmp_path / "data.json")
    assert (again.name, again.tests, again.lines, again.mutants) == ("base", ["a", "b"], found.lines, mutants)
    assert again.coverage(frozenset({"a"})) == 0.5
    assert (other.name, other.mutants) == ("other", [])


_NOTICED = """
import json, sys
from pathlib import Path
from real_bugs.matrix import Suite, in_fork
suite = Suite(Path(sys.argv[1]))
found = {one.what.partition(": ")[0]: in_fork(lambda: suite.failures(one.text)) for one in suite.variants(())}
print(json.dumps(found))
"""


def test_who_notices_a_bug_in_a_fork_notices_it_by_plain_pytest(tmp_path: Path) -> None:
    """Each process has one program: all of them have modules of the same names."""
    folder = PROGRAMS / "sorter"
    command = [sys.executable, "-c", _NOTICED, str(folder)]
    done = subprocess.run(command, cwd=PROGRAMS.parents[1], capture_output=True, text=True, check=True)
    noticed = json.loads(done.stdout)
    for bug in ("milliseconds", "still-hears"):
        copy = tmp_path / bug
        shutil.copytree(
            folder, copy, ignore=shutil.ignore_patterns("__pycache__", ".mutabot", ".pytest_cache")
        )
        patch = read_patch((folder / "patches" / f"{bug}.patch").read_bytes(), folder, looks_like_tests)
        (copy / "program.py").write_bytes(patch.files[0].after)
        plain = [sys.executable, "-m", "pytest", "-q", "-rf", "-p", "no:cacheprovider", "-p", "no:mutabot"]
        ran = subprocess.run(plain, cwd=copy, capture_output=True, text=True, check=False)
        failed = set(re.findall(r"^FAILED (\S+)", ran.stdout, re.MULTILINE))
        assert failed == noticed[bug].keys() - {"probe"}
        assert failed


def test_a_text_that_makes_no_sense_is_stillborn() -> None:
    stillborn = [mutant for each in FOUND for mutant in each.mutants if mutant.end == STILLBORN]
    assert {mutant.family for mutant in stillborn} <= {"bugs", "conventional"}
    assert any(mutant.operator == "counterpart" for mutant in stillborn)


@pytest.mark.parametrize(
    ("family", "outcome", "is_probed", "end", "by"),
    [
        ("robot", Outcome("", 0, Verdict.REFUSED, test="t"), True, REFUSED, {"t"}),
        ("bugs", Outcome("", 0, Verdict.INVALID), True, REFUSED, set()),
        (BUGS, Outcome("", 0, Verdict.REFUSED, test="t"), True, KILLED, {"t"}),
        (BUGS, Outcome("", 0, Verdict.KILLED, kills=(Kill("t", By.CHECK),)), True, KILLED, {"t"}),
        ("robot", Outcome("", 0, Verdict.SURVIVED, indistinguishable=True), True, SAME, set()),
        ("robot", Outcome("", 0, Verdict.SURVIVED, indistinguishable=False), True, DIFFERS, set()),
        ("robot", Outcome("", 0, Verdict.SURVIVED), False, SAME, set()),
        ("bugs", Outcome("", 0, Verdict.KILLED, kills=(Kill("t", By.EXCEPTION, "builtins:NameError"),)),
         True, STILLBORN, {"t"}),
        ("robot", Outcome("", 0, Verdict.KILLED, kills=(Kill("t", By.EXCEPTION, "builtins:TypeError"),)),
         True, KILLED, {"t"}),
    ],
)  # fmt: skip
def test_what_a_campaign_says_of_a_mutant(
    family: str, outcome: Outcome, is_probed: bool, end: str, by: set[str]
) -> None:
    at = samples.site("program.py", 2, "arm.move_by", Role.PROGRAM)
    mutant = Mutant(1, family, "skip", at, "", None, None, "", "patches/late.patch order: too late")
    results = Results(
        {},
        "complete",
        1,
        (MutantResult(mutant, (outcome,), None, ""),),
        (),
        RoundScores.of([], 1),
        (),
        (),
        (),
    )
    (found,) = judged(results, is_probed=is_probed)
    assert (found.end, found.by) == (end, by)
    assert found.what == ("late: order: too late" if family == BUGS else f"2: {mutant.description}")
