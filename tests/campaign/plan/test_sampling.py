"""Samples: of the size that was asked for, fair, and the same tomorrow."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.campaign.plan import draw
from mutabot.campaign.run import run_campaign
from mutabot.config.options import Sample
from mutabot.errors import UsageError
from mutabot.journal.journal import Journal
from mutabot.journal.records import DRAWING
from mutabot.model import Mutant, Role
from results import samples
from tests.campaign.project import Quiet, request_for, write_project

SIZES = ("10%", "33 %", "0.01%", "100%", "1", "7", "50", "100000")


def mutant(number: int, family: str = "robot", role: Role = Role.PROGRAM, *, line: int = 0) -> Mutant:
    site = samples.site("mission.py", line or number, "arm.move_by", role, occurrence=line or number)
    return Mutant(number, family, "reverse", site, "robot:Arm.move_by", None, f"q{number}", "", "")


MANY = [mutant(number) for number in range(1, 201)]
MIXED = [
    *MANY[:60],
    *(mutant(number, role=Role.ORACLE) for number in range(300, 330)),
    *(mutant(number, "conventional") for number in range(400, 700)),
]


def drawn(mutants: list[Mutant], size: str, seed: int = 1) -> list[Mutant]:
    return draw(mutants, seed, Sample.parse(size))[0]


@pytest.mark.parametrize(
    ("size", "number"), [("10%", 20), ("12.5 %", 25), ("0.01%", 1), ("100%", 200), ("50", 50), ("1000", 200)]
)
def test_a_sample_has_the_size_that_was_asked_for(size: str, number: int) -> None:
    assert len(drawn(MANY, size)) == number


@pytest.mark.parametrize(
    "size",
    [
        "0",
        "0%",
        "0.0 %",
        "101%",
        "150 %",
        "-3",
        "-3%",
        "abc",
        "",
        " ",
        "%",
        "1.5",
        "1e3",
        "nan%",
        "٣",
        "9" * 99,
    ],
)
def test_an_absurd_size_is_a_usage_error_that_names_it(size: str) -> None:
    with pytest.raises(UsageError) as error:
        Sample.parse(size)
    assert error.value.exit_code == 2
    assert size.strip()[:20] in str(error.value)


@pytest.mark.parametrize("size", SIZES)
def test_a_sample_keeps_order_and_numbers_and_draws_none_twice(size: str) -> None:
    chosen = drawn(MIXED, size)
    assert chosen == [member for member in MIXED if member in chosen]


@pytest.mark.parametrize("size", SIZES)
def test_no_family_and_role_goes_away_empty_if_there_is_enough(size: str) -> None:
    found = Counter((member.family, member.site.role) for member in drawn(MIXED, size))
    assert found["conventional", Role.PROGRAM] > 0
    assert found["robot", Role.PROGRAM] > 0
    assert found["robot", Role.ORACLE] > 0 or size == "1"


def test_a_number_is_per_family_and_divided_as_its_roles_are() -> None:
    found = Counter((member.family, member.site.role) for member in drawn(MIXED, "30"))
    assert found == {
        ("robot", Role.PROGRAM): 20,
        ("robot", Role.ORACLE): 10,
        ("conventional", Role.PROGRAM): 30,
    }


@given(st.dictionaries(st.sampled_from("abcd"), st.integers(1, 50), min_size=1), st.integers(1, 300))
def test_a_number_is_met_whatever_the_roles(roles: dict[str, int], count: int) -> None:
    sizes = Sample.parse(str(count)).sizes(roles)
    assert sum(sizes.values()) == min(count, sum(roles.values()))
    assert all(0 <= sizes[role] <= roles[role] for role in roles)
    assert all(sizes.values()) or count < len(roles)


def test_the_same_seed_draws_the_same_and_another_seed_others() -> None:
    assert drawn(MANY, "20") == drawn(MANY, "20")
    assert drawn(MANY, "20") != drawn(MANY, "20", seed=2)


def test_a_larger_sample_holds_the_smaller_one() -> None:
    assert {member.id for member in drawn(MANY, "5%")} < {member.id for member in drawn(MANY, "20%")}


def test_a_new_mutant_takes_the_place_of_one_other_at_most() -> None:
    before = {member.id for member in drawn(MANY[:-1], "20")}
    after = {member.id for member in drawn(MANY, "20")}
    assert len(before - after) <= 1


def test_numbers_do_not_matter_so_that_edits_elsewhere_change_nothing() -> None:
    renumbered = [mutant(member.number) for member in reversed(MANY)]
    assert {member.id for member in drawn(renumbered, "20")} == {member.id for member in drawn(MANY, "20")}


def test_every_mutant_is_as_likely_as_any_other() -> None:
    seeds = 2000
    hits = Counter(member.id for seed in range(seeds) for member in drawn(MANY[:20], "5", seed))
    # each is drawn in a quarter of the cases; the standard deviation is 19.4, and 5 of them are never met
    assert all(abs(hits[member.id] - seeds / 4) < 5 * 19.4 for member in MANY[:20])


PROJECT = (
    """
    from robot import Arm

    def run(arm):
        arm.move_by(0.5)
        arm.move_by(-0.25)
        arm.move_by(0.125)
    """,
    """
    from mission import run
    from robot import Arm

    def test_it():
        arm = Arm()
        run(arm)
        assert arm.position() == 0.375
    """,
)


def test_a_campaign_on_a_sample_writes_down_what_it_was_drawn_from(tmp_path: Path) -> None:
    folder = write_project(tmp_path, *PROJECT)
    path = run_campaign(request_for(folder, sample=Sample.parse("4")), Quiet())
    with Journal.open(path) as journal:
        drawing = journal.meta()[DRAWING]
        assert len(journal.mutants()) == len(journal.outcomes()) == 4
    (stratum,) = drawing.strata
    assert (stratum.drawn, drawing.sample) == (4, "4")
    assert stratum.population == drawing.selected > 4


def test_the_whole_campaign_after_a_sample_runs_only_the_rest(tmp_path: Path) -> None:
    folder = write_project(tmp_path, *PROJECT)
    run_campaign(request_for(folder, sample=Sample.parse("4")), Quiet())
    progress = Quiet()
    run_campaign(request_for(folder), progress)
    assert any(line.startswith("reused 4 of ") for line in progress.lines)


def test_a_campaign_of_another_name_leaves_the_journal_as_it_is(tmp_path: Path) -> None:
    folder = write_project(tmp_path, *PROJECT)
    path = run_campaign(request_for(folder), Quiet())
    before = path.read_bytes()
    other = request_for(folder, only=("skip",), journal="compare.sqlite")
    for _ in range(2):
        assert run_campaign(other, Quiet()).name == "compare.sqlite"
    assert path.read_bytes() == before
    assert not path.with_name("journal.previous.sqlite").exists()
    assert path.with_name("compare.previous.sqlite").exists()
