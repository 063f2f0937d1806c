"""The report on the terminal: everything is there, at any width, without colour, whatever texts hold."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rich.cells import cell_len
from rich.console import Console

from mutabot.errors import SelectionError
from mutabot.journal.journal import Journal
from mutabot.journal.records import Untested
from mutabot.model import By, LeftOut, Outcome, Span, Verdict
from mutabot.model.suppression import Acceptance
from mutabot.report.terminal.campaign import print_plan, print_results, print_summary
from mutabot.report.terminal.console import (
    counts_of,
    legend,
    letters,
    make_console,
    mark_of,
    marks_of,
    short_place,
    terminal_text,
)
from mutabot.report.terminal.mutant import print_mutant
from mutabot.report.texts import finding_text
from mutabot.results.results import MutantResult, Results, read_results
from results import samples

WIDTHS = pytest.mark.parametrize("width", [60, 80, 120, 200])


def summary(results: Results, width: int) -> str:
    on = console(width)
    print_summary(on, results)
    return written(on)


@pytest.fixture
def results(tmp_path: Path) -> Results:
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite")) as journal:
        return read_results(journal)


def console(width: int) -> Console:
    return make_console(io.StringIO(), width=width)


def written(on: Console) -> str:
    assert isinstance(on.file, io.StringIO)
    return on.file.getvalue()


def report(results: Results, width: int = 120) -> str:
    on = console(width)
    print_results(on, results)
    return written(on)


def row(text: str, *words: str) -> str:
    return next(line for line in text.splitlines() if all(word in line for word in words))


def first_line_of(text: str, word: str) -> str:
    """The line that begins the row with this word: on a narrow terminal an operator is in the second."""
    lines = text[: text.index(word)].count("\n")
    return next(line for line in reversed(text.splitlines()[: lines + 1]) if line[:3].strip().isdigit())


@WIDTHS
def test_no_line_is_wider_than_the_terminal_and_none_is_coloured_on_a_pipe(
    results: Results, width: int
) -> None:
    text = report(results, width)
    assert max(cell_len(line) for line in text.splitlines()) <= width
    assert "\x1b" not in text


@WIDTHS
def test_every_mutant_has_one_letter_per_round(results: Results, width: int) -> None:
    text = report(results, width)
    for words, ends in {
        ("reverse",): "C X", ("skip",): "S S", ("by-to",): "R T", ("negate",): "S C", ("noise",): "E N",
    }.items():  # fmt: skip
        assert first_line_of(text, *words).endswith(ends)


def test_the_legend_explains_exactly_the_letters_that_occur(results: Results) -> None:
    text = report(results)
    for words in ("C killed by a check", "X killed by an exception", "N not covered", "E error"):
        assert words in text
    assert "unstable" not in text


@pytest.mark.parametrize("width", [30, 60, 80])
def test_the_legend_breaks_between_its_entries_only(width: int) -> None:
    marks = [mark_of(Outcome("m", 0, verdict, By.CHECK)) for verdict in Verdict]
    on = console(width)
    on.print(legend(marks))
    entries = [entry for line in written(on).splitlines() for entry in line.split("   ")]
    assert entries == [f"{mark.letter} {mark.text}" for mark, _ in counts_of(marks)]


def test_only_rounds_that_let_an_accepted_mutant_through_are_marked_so(results: Results) -> None:
    by_id = {result.mutant.id: result for result in results.mutants}
    decision = Acceptance("why", "mutabot-accepted.toml:1")
    for mutant, before, after in ((samples.SKIP, "S S", "A A"), (samples.NEGATE, "S C", "A C")):
        result = by_id[mutant.id]
        assert letters(marks_of(result)).plain == before
        assert letters(marks_of(replace(result, acceptance=decision))).plain == after
    killed = replace(by_id[samples.REVERSE.id], acceptance=decision)
    assert letters(marks_of(killed)).plain == "C X"


def test_every_verdict_has_a_letter_of_its_own() -> None:
    outcomes = [Outcome("m", 0, verdict, By.CHECK) for verdict in Verdict]
    outcomes.append(Outcome("m", 0, Verdict.KILLED, By.EXCEPTION))
    assert len({mark_of(outcome).letter for outcome in [*outcomes, None]}) == len(outcomes) + 1


def test_scores_carry_their_counts_per_role_and_there_is_no_total(results: Results) -> None:
    text = report(results)
    assert row(text, "robot · program", "58.3 %", "25.0 %", "3 of 5")
    assert row(text, "robot · oracle", "25.0 %", "1 of 3")
    assert "together" not in text


@pytest.mark.parametrize("width", [80, 120])
def test_scores_carry_their_intervals(results: Results, width: int) -> None:
    text = report(results, width)
    assert "(3–98 %)" in text[text.index("Scores") :]
    assert "docs/statistics.md" in text


def test_with_one_round_there_is_no_interval(tmp_path: Path) -> None:
    once = tuple(outcome for outcome in samples.OUTCOMES if outcome.round == 0)
    path = samples.write_journal(tmp_path / "journal.sqlite", outcomes=once, rounds=1)
    with Journal.open(path) as journal:
        text = report(read_results(journal), 80)
    assert "–" not in text.partition("Scores")[2].partition("survivor")[0].replace("–  ", "")
    assert "docs/statistics.md" not in text


@WIDTHS
@pytest.mark.parametrize(("size", "told"), [("10%", "10%"), ("3", "3 of each family")])
def test_a_sample_is_reported_with_what_it_means_for_all(
    tmp_path: Path, width: int, size: str, told: str
) -> None:
    stratum = {"family": "robot", "role": "program", "population": 30, "drawn": 3}
    drawing = {"sample": size, "selected": 60, "strata": [stratum]}
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite", drawing=drawing)) as journal:
        text = " ".join(report(read_results(journal), width).split())
    assert f"Sample of {told}: 5 of 60 mutants" in text
    assert "robot · program: 3 of 30; score of all of them in these rounds " in text


@WIDTHS
def test_a_second_look_is_reported(tmp_path: Path, width: int) -> None:
    wrong = {
        "mutant": samples.SKIP.id, "number": 2, "round": 0, "first": "survived", "second": "killed by check",
    }  # fmt: skip
    path = samples.write_journal(
        tmp_path / "journal.sqlite",
        verification={"wanted": 9, "checked": 9, "disagreements": [wrong]},
        flaky={"tests": ["tests/t.py::test_a in round 1: failed in an equal run"], "known": 8},
        repeats={
            "doubted": {"outcomes": 5, "repeated": 4, "changed": 1},
            "others": {"outcomes": 30},
            "survivors": {"outcomes": 9},
        },
    )
    with Journal.open(path) as journal:
        text = report(read_results(journal), width)
    flat = " ".join(text.split())
    assert "Verified: 8 of 9 outcomes end the same in fresh processes." in flat
    assert "mutant 2, round 1: survived; re-run: killed by check" in flat
    assert (
        "Kills: 4 of 5 kills that might be a coincidence re-run, 1 gave a different result and was dropped; "
        "30 other kills not re-run (--verify N re-runs some); estimated wrong kills among 4: 0.3 "
        "(95 % interval 0–4)"
    ) in flat
    assert "1 unreliable test excluded tests/t.py::test_a in round 1" in flat
    assert max(cell_len(line) for line in text.splitlines()) <= width


def test_re_runs_that_all_end_the_same_are_reported_without_a_count_of_others(tmp_path: Path) -> None:
    repeats = {"doubted": {"outcomes": 2, "repeated": 1, "changed": 0}}
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite", repeats=repeats)) as journal:
        text = " ".join(report(read_results(journal)).split())
    assert "Kills: 1 of 2 kills that might be a coincidence re-run, with the same result; estimated" in text


def test_nothing_is_estimated_where_all_were_run_again(tmp_path: Path) -> None:
    repeats = {"doubted": {"outcomes": 2, "repeated": 2, "changed": 0}, "others": {"outcomes": 30}}
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite", repeats=repeats)) as journal:
        text = " ".join(report(read_results(journal)).split())
    assert "Kills: 2 of 2 kills that might be a coincidence re-run, with the same result; 30 other" in text
    assert "estimated wrong" not in text


@WIDTHS
def test_errors_come_first_one_line_per_message(tmp_path: Path, width: int) -> None:
    outcomes = [Outcome(mutant.id, 0, Verdict.ERROR, message="NaN\nmore") for mutant in samples.MUTANTS]
    outcomes.append(Outcome(samples.SKIP.id, 1, Verdict.ERROR, message="no memory"))
    path = samples.write_journal(tmp_path / "journal.sqlite", outcomes=tuple(outcomes))
    with Journal.open(path) as journal:
        text = report(read_results(journal), width)
    words = " ".join(text[text.index("6 of 6") : text.index("Scores")].split())
    assert "6 of 6 outcomes ended in error" in words
    assert words.endswith("5 × NaN (mutants 1, 2, 3, 4, 5) 1 × no memory (mutant 2)")


def test_survivors_come_with_a_reason_the_farthest_first(results: Results) -> None:
    text = report(results)
    section = text[text.index("2 survivors") :]
    assert "0.8 instead of 0.488" in section
    assert row(text, "1 mutant not covered, since no test reaches the place")
    assert "1 survivor without a measured effect: mutant 4" in section


@pytest.mark.parametrize(
    ("other", "count", "said"),
    [
        (Verdict.NOT_COVERED, "1 of 2", "not covered in 1 of 2 rounds"),
        (Verdict.KILLED, "1 of 2", "killed in 1 of 2 rounds"),
        (Verdict.REFUSED, "1 of 1", None),
        (Verdict.SURVIVED, "2 of 2", None),
    ],
)
def test_a_survivor_is_counted_in_the_rounds_that_let_it_through(
    tmp_path: Path, other: Verdict, count: str, said: str | None
) -> None:
    by = By.CHECK if other is Verdict.KILLED else None
    ends = (
        Outcome(samples.REVERSE.id, 0, other, by),
        Outcome(samples.REVERSE.id, 1, Verdict.SURVIVED, divergence=("1 call fewer",)),
    )
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=ends)) as journal:
        text = report(read_results(journal), 200)
    line = next(line for line in text.splitlines() if "1 call fewer" in line or line.endswith(count))
    assert line.rstrip().endswith(count), text
    assert said is None or said in " ".join(text.split())
    assert (said == "not covered in 1 of 2 rounds") is ("not covered in" in text)


def test_a_mutant_that_every_test_reaching_it_kills_is_no_survivor(tmp_path: Path) -> None:
    mutant = samples.REVERSE
    ends = (
        Outcome(mutant.id, 0, Verdict.NOT_COVERED, message="no test reaches the site in this round"),
        Outcome(mutant.id, 1, Verdict.KILLED, By.CHECK, test=samples.TEST, message="assert 1 == 2"),
    )
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=ends)) as journal:
        results = read_results(journal)
        text = report(results, 200)
    where = "since no test reaches the place in some round; killed in the others"
    assert f"1 mutant not covered, {where}\n  mutant {mutant.number}" in text
    assert "1 survivor" not in text


def test_of_a_selection_the_title_says_of_how_many_it_is(tmp_path: Path) -> None:
    path = samples.write_journal(tmp_path / "journal.sqlite", selected_of=70)
    with Journal.open(path) as journal:
        results = read_results(journal)
        text = report(results)
    assert f"{len(results.mutants)} of 70 mutants × " in text
    assert not results.bugs_caught


def test_that_no_probe_shows_how_the_world_ended_is_said_once(tmp_path: Path) -> None:
    ends = [Outcome(item.id, 0, Verdict.SURVIVED) for item in (samples.REVERSE, samples.SKIP)]
    with Journal.open(samples.write_journal(tmp_path / "journal.sqlite", outcomes=ends)) as journal:
        text = report(read_results(journal))
    assert text.count("it is unknown how the world ended") == 1
    assert "\n  Where no effect is listed, it is unknown how the world ended" in text
    with Journal.open(samples.write_journal(tmp_path / "one.sqlite", outcomes=ends[:1])) as journal:
        assert "Where no effect is listed" not in report(read_results(journal))


def test_survivors_without_a_deviation_are_not_said_to_be_in_its_order(tmp_path: Path) -> None:
    unknown = Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED)
    differs = Outcome(samples.SKIP.id, 0, Verdict.SURVIVED, divergence=("1 call fewer",))
    path = samples.write_journal(tmp_path / "journal.sqlite", outcomes=(unknown, differs))
    with Journal.open(path) as journal:
        results = read_results(journal)
    assert "2 survivors\n" in report(results)
    assert [result.mutant for result in results.survivors] == [samples.SKIP, samples.REVERSE]


def test_what_stands_outside_the_score_is_listed_with_its_reason(results: Results) -> None:
    text = report(results)
    assert "Not counted in the score: 1 error, 1 refused" in text
    assert "x = −0.3 m is out of reach by 0.1 m" in text
    assert "[bold]not markup[/bold]" in text


def test_what_the_plan_leaves_out_is_counted(results: Results) -> None:
    assert "2 mutants left out: it is always 0" in report(results)


def test_an_interrupted_campaign_says_how_much_is_known(tmp_path: Path) -> None:
    path = samples.write_journal(
        tmp_path / "journal.sqlite", outcomes=samples.OUTCOMES[:3], finish="interrupted"
    )
    with Journal.open(path) as journal:
        text = report(read_results(journal))
    assert "interrupted, 3 of 10 outcomes are known" in text
    assert "· not run" in text.replace("\N{NO-BREAK SPACE}", " ")


def test_a_journal_without_a_plan_can_be_shown(tmp_path: Path) -> None:
    with Journal.create(tmp_path / "journal.sqlite", meta={}) as journal:
        assert "0 mutants × 0 rounds" in report(read_results(journal))


def test_many_rounds_are_counted(tmp_path: Path) -> None:
    outcomes = tuple(
        Outcome(samples.SKIP.id, round, Verdict.SURVIVED if round % 3 else Verdict.TIMEOUT)
        for round in range(20)
    )
    path = samples.write_journal(tmp_path / "journal.sqlite", outcomes=outcomes, rounds=20)
    with Journal.open(path) as journal:
        text = report(read_results(journal), 80)
    assert "S13" in text
    assert "T7" in text
    assert max(cell_len(line) for line in text.splitlines()) <= 80


@pytest.mark.parametrize("width", [80, 120, 200])
def test_a_run_ends_with_errors_scores_survivors_and_where_to_read_on(results: Results, width: int) -> None:
    text = summary(results, width)
    lines = text.splitlines()
    assert lines[0] == "5 mutants × 2 rounds: complete"
    assert max(cell_len(line) for line in lines) <= width
    text = " ".join(text.split())
    order = ["ended in error", "robot · program", "robot · oracle", "2 survivors", "Not counted in the score"]
    assert [text.index(words) for words in order] == sorted(text.index(words) for words in order)
    # of the first round 1 of 2 and of the second 2 of 3; by a check 1 of 2 and 0 of 3
    assert re.search(r"robot · program.* 58\.3 %.* 25\.0 % +3 of 5", text)
    assert "`mutabot show 2` prints the details of a survivor" in text
    assert "`mutabot results` lists all" in text
    assert "by-to" not in text  # neither survived nor in error: a row in the full table only


def test_of_many_survivors_a_run_shows_ten(tmp_path: Path) -> None:
    mutants = tuple(
        samples.mutant(number, f"made-{number}", samples.MOVE, "dx", "arm.move_by") for number in range(1, 31)
    )
    outcomes = tuple(Outcome(mutant.id, 0, Verdict.SURVIVED) for mutant in mutants)
    path = samples.write_journal(tmp_path / "j.sqlite", outcomes=outcomes, mutants=mutants, rounds=1)
    with Journal.open(path) as journal:
        text = summary(read_results(journal), 120)
    assert text.count("made-") == 10
    assert "and 20 more" in text


def test_what_fits_several_mutants_names_ten_of_them(tmp_path: Path, results: Results) -> None:
    assert results.mutant("noise").mutant == samples.NOISE
    assert results.mutant("mission.py:2").mutant == samples.SKIP
    with pytest.raises(SelectionError) as caught:
        results.mutant("mission.py")
    first, *others = str(caught.value).splitlines()
    assert first == "'mission.py' fits 3 mutants; give a number or a whole id:"
    assert others == [
        f"{mutant.number:>6}  {mutant.id}" for mutant in (samples.REVERSE, samples.SKIP, samples.BY_TO)
    ]
    many = tuple(replace(samples.REVERSE, number=number, variant=str(number)) for number in range(1, 15))
    with Journal.open(samples.write_journal(tmp_path / "many.sqlite", mutants=many)) as journal:
        results = read_results(journal)
    with pytest.raises(SelectionError, match="fits 14 mutants") as caught:
        results.mutant("reverse")
    assert len(str(caught.value).splitlines()) == 12
    assert str(caught.value).endswith("and 4 more")


def test_show_marks_the_call_in_its_source(results: Results) -> None:
    on = console(80)
    print_mutant(on, results.mutant("3"), lambda _: samples.PROGRAM)
    lines = written(on).splitlines()
    (source,) = (line for line in lines if line.startswith("> "))
    assert "größe" in source


def test_show_gives_the_kill_rate_with_its_interval(results: Results) -> None:
    on = console(100)
    print_mutant(on, results.mutant("1"), lambda _: None)
    assert "in 2 of 2 valid rounds, 95 % interval 34–100 %" in written(on)


def test_show_reports_what_changed_and_how_each_round_ended(results: Results) -> None:
    on = console(100)
    print_mutant(on, results.mutant("1"), lambda _: None, everything=True)
    text = written(on)
    for words in (
        samples.REVERSE.id,
        "dx: translation, x, m",
        "the program sent -0.2 m instead of 0.2 m",
        "killed by a check in tests/test_mission.py::test_box_arrives",
        "AssertionError: box is at x = 0.55 m",
        "at tests/test_mission.py:9",
        "Stop: hit",
    ):
        assert words in text


def test_rounds_that_ended_alike_are_one_line(tmp_path: Path) -> None:
    def killed(round: int, message: str, **more: Any) -> Outcome:
        outcome = Outcome(
            samples.REVERSE.id, round, Verdict.KILLED, By.CHECK, test=samples.TEST, message=message
        )
        return replace(outcome, hits=3, tests=1, wall=0.1 * (round + 1), **more)

    outcomes = (
        *(killed(round, f"box is at x = {round + 0.5} m", acted=3) for round in (0, 1, 2, 4)),
        killed(3, "box is at x = 0.5 m", acted=2),
        Outcome(samples.REVERSE.id, 5, Verdict.SURVIVED, hits=3, acted=3, tests=1, wall=0.2),
        Outcome(samples.REVERSE.id, 6, Verdict.SURVIVED, hits=3, acted=3, tests=1, wall=0.2),
    )
    path = samples.write_journal(tmp_path / "journal.sqlite", outcomes=outcomes, rounds=8)
    with Journal.open(path) as journal:
        on = console(100)
        print_mutant(on, read_results(journal).mutant("1"), lambda _: None, everything=True)
    lines = [line.strip() for line in written(on).partition("Rounds\n")[2].partition("\n\n")[0].splitlines()]
    assert lines == [
        "C C C C C S S ·",
        f"rounds 1 to 5: C killed by a check in {samples.TEST}",
        "box is at x = 0.5 m",
        "acted at 3 of 3 hits, 1 test run, 0.1 s",
        "rounds 6 and 7: S survived",
        "acted at 3 of 3 hits, 1 test run, 0.2 s",
        "round 8: · not run",
        "`mutabot replay 1 --round 6` re-runs it as in that round",
    ]


def test_one_screen_shows_the_rounds_that_differ_most(results: Results) -> None:
    on = console(100)
    print_mutant(on, results.mutant("4"), lambda _: None)
    text = written(on)
    assert "round 1: S survived" in text
    assert "killed by a check" not in text
    assert "Use --all for all rounds." in text  # it has no further checks


def test_where_a_message_is_cut_and_there_is_one_round_no_further_rounds_are_promised() -> None:
    outcome = replace(samples.OUTCOMES[0], message="\n".join(f"line {number}" for number in range(20)))
    on = console(100)
    print_mutant(on, MutantResult(samples.REVERSE, (outcome,), None, ""), lambda _: None)
    assert "Use --all for all lines of the round." in written(on)


def test_where_the_one_screen_has_everything_it_names_no_option_for_more(results: Results) -> None:
    on = console(100)
    print_mutant(on, results.mutant("2"), lambda _: None)
    assert "--all" not in written(on)


@pytest.mark.parametrize(
    ("description", "effect"),
    [
        ("arm.move_by: x 0.2 m → -0.2 m", "box fell"),
        ("camera: reads x -0.2 m instead of 0.2 m", "box fell"),
        ("arm.move_by: x 0.21 m → -0.21 m", "sent -0.2 m instead of 0.2 m; box fell"),
        ("arm.move_by: x 10.2 m → -0.2 m", "sent -0.2 m instead of 0.2 m; box fell"),
    ],
)
def test_an_effect_does_not_repeat_the_values_that_the_description_has(
    results: Results, description: str, effect: str
) -> None:
    first = results.mutant("1")
    told = replace(
        first,
        mutant=replace(first.mutant, description=description),
        why="sent -0.2 m instead of 0.2 m; box fell",
    )
    assert finding_text(told) == effect


def test_show_reports_where_a_mutant_stayed_away_and_why(results: Results) -> None:
    mutant = results.mutant("1")
    why = {"the value would leave the range [-1, 1]": 138, "the value would stay the same": 1}
    rounds = tuple(end and replace(end, acted=161, hits=300, away=why) for end in mutant.rounds)
    on = console(100)
    print_mutant(on, replace(mutant, rounds=rounds), lambda _: None, everything=True)
    text = written(on)
    assert "acted at 161 of 300 hits" in text
    assert "left 138 calls unchanged: the value would leave the range [-1, 1]" in text
    assert "left 1 call unchanged: the value would stay the same" in text


@WIDTHS
def test_the_plan_names_place_operator_and_quantity(width: int) -> None:
    on = console(width)
    print_plan(on, samples.MUTANTS, samples.LEFT_OUT, Untested())
    text = written(on)
    assert row(text, "program", "mission.py:3") == first_line_of(text, "reverse")
    assert "5 mutants" in text
    assert max(cell_len(line) for line in text.splitlines()) <= width


def test_ids_in_the_whole_plan_stay_whole() -> None:
    """``--only`` takes them, and nobody copies a text in pieces."""
    on = console(20)
    print_plan(on, samples.MUTANTS, (), Untested(), everything=True)
    lines = [line.strip() for line in written(on).splitlines()]
    assert [mutant.id for mutant in samples.MUTANTS if mutant.id not in lines] == []


def test_what_is_left_out_of_one_site_for_one_reason_stands_together() -> None:
    still = "would change nothing in any of 5 calls"
    left_out = [
        LeftOut("a.py:run:arm.move#1:x:reverse", "arm.move: x 0 m → 0 m", f"{still} (value 0 m)"),
        LeftOut("a.py:run:arm.move#2:x:reverse", "arm.move: x 0 m → 0 m", f"{still} (value 0 m)"),
        LeftOut(
            "a.py:run:arm.move#1:yaw:by-to", "arm.move: yaw by 0 deg → to 0 deg", f"{still} (value 0 deg)"
        ),
    ]
    on = console(120)
    print_plan(on, (), left_out, Untested(), everything=True)
    assert written(on).splitlines()[-3:] == [
        f"  a.py:run:arm.move#1  {still}:",
        "    x:reverse, yaw:by-to",
        f"  a.py:run:arm.move#2:x:reverse  arm.move: x 0 m → 0 m: {still} (value 0 m)",
    ]


def test_texts_of_programs_cannot_play_with_the_terminal() -> None:
    assert terminal_text("\x1b[31mred\x1b[0m \x07\x1b]0;title\x07\tx") == "red     x"


def test_a_long_path_keeps_its_end() -> None:
    long = "a_very_long_name_of_a_single_file.py"
    places = {
        ("src/a.py", 3): "src/a.py:3",
        ("packages/robot/src/robot/cell/mission.py", 12): "…/cell/mission.py:12",
        (long, 1): f"{long}:1",
        ("world", 0): "world",
    }
    for (file, line), told in places.items():
        assert short_place(Span(file, line, 0, line, 4, "run")) == told
