"""The command line: exit codes, plain messages, and output a machine can read."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

import mutabot
from mutabot.cli import campaign
from mutabot.cli.app import app, main
from mutabot.cli.request import request_of
from mutabot.errors import BaselineError, ControlError, ExitCode, MutabotError, UnstableError
from mutabot.model import Outcome, Verdict
from results import samples
from tests.processor_time import used

COMMANDS = ("check", "list", "run", "results", "show", "report", "replay")


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with a configuration, in which no command really starts a campaign."""
    (tmp_path / "mission.py").write_text(samples.PROGRAM)
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "sensors.py").write_text(samples.SENSORS)
    (tmp_path / "mutabot.toml").write_text(
        'program = ["mission.py"]\nvocabulary = ["robot.toml"]\nseed = 7\nerror_limit = 0.1\n'
    )
    (tmp_path / "robot.toml").write_text('[[operation]]\ncall = "robot:Arm.home"\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


class Campaign:
    """Takes the place of the campaign: writes a journal, or fails as it is told."""

    def __init__(self, project: Path) -> None:
        self.project = project
        self.request: Any = None
        self.error: BaseException | None = None
        self.journal: dict[str, Any] = {}

    def run(self, request: Any, progress: Any) -> Path:
        self.request = request
        progress.stage("mutants", 1)
        if self.error is not None:
            raise self.error
        progress.advance("done")
        return samples.write_journal(self.project / ".mutabot" / "journal.sqlite", **self.journal)


@pytest.fixture
def fake(project: Path, monkeypatch: pytest.MonkeyPatch) -> Campaign:
    fake = Campaign(project)
    monkeypatch.setattr(campaign, "run_campaign", fake.run)
    return fake


def test_help_works_in_any_folder_and_names_every_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for command in COMMANDS:
        assert command in text
        assert main([command, "--help"]) == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.needs("init", "suggest", "live", "minimal", "motion", "patches")
def test_help_lists_commands_in_the_order_in_which_they_are_used(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    listed = capsys.readouterr().out.partition("Commands:\n")[2].partition("\n\n")[0].splitlines()
    assert [line.split()[0] for line in listed] == [
        "init", "check", "list", "diff", "export", "operators", "patches", "run", "merge", "replay",
        "minimal", "suggest", "world", "results", "show", "accept", "thresholds", "report", "live",
        "motion",
    ]  # fmt: skip


@pytest.mark.parametrize(
    "command", [pytest.param(name, marks=pytest.mark.needs(name)) for name in ("init", "suggest")]
)
def test_help_of_a_command_of_a_package_writes_nothing(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([command, "--help"]) == 0
    assert f"Usage: mutabot {command} [OPTIONS]" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


def test_help_imports_nothing_heavy() -> None:
    script = (
        "import sys; from mutabot.cli.app import main; main(['--help']); print(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    loaded = set(done.stderr.split())
    assert not loaded & {"pydantic", "sqlite3", "pytest", "numpy", "mujoco", "mutabot.campaign.run"}


def test_the_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"mutabot {mutabot.__version__}\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ["bogus"],
        ["run", "--rounds", "none"],
        ["run", "--rounds", "0"],
        ["run", "--nonsense"],
        ["show"],
        ["run", "--min-score", "101"],
        ["run", "--verify", "-1"],
        ["replay"],
        ["replay", "1", "--round", "0"],
    ],
)
def test_a_wrong_command_line_is_2_without_a_traceback(
    arguments: list[str], project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert "Traceback" not in capsys.readouterr().err
    assert not (project / ".mutabot").exists()


def test_an_unknown_engine_names_the_nearest(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--engine", "replai"]) == 2
    assert "did you mean 'replay'" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["check", "list", "run"])
def test_a_folder_without_configuration_is_2_and_names_init(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([command]) == 2
    assert "mutabot init" in capsys.readouterr().err


@pytest.mark.parametrize("command", [["results"], ["show", "1"], ["replay", "1"]])
def test_results_without_a_journal_are_2_and_name_run(
    command: list[str], project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(command) == 2
    assert "mutabot run" in capsys.readouterr().err


def test_a_run_prints_the_results(fake: Campaign, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run"]) == 0
    out, err = capsys.readouterr()
    assert "5 mutants × 2 rounds: complete" in out
    assert "`mutabot results` lists all" in out
    assert "Mutants by rounds" not in out
    assert "mutants" in err


def test_options_of_a_run_reach_the_campaign(fake: Campaign) -> None:
    (fake.project / "s.txt").write_text("")
    words = "--only reverse --only @s.txt --skip 3 --rounds 4 --seed 0 -j 3 --engine replay --verify 7"
    assert main(["run", *words.split()]) == 0
    request = fake.request
    assert request.verify == 7
    assert (request.only, request.skip) == (("reverse", "@s.txt"), ("3",))
    assert (request.rounds, request.seed, request.jobs) == (4, 0, 3)
    assert request.engine == "replay"


def test_a_sample_reaches_the_campaign(fake: Campaign) -> None:
    assert main(["run", "--sample", "10%"]) == 0
    assert fake.request.sample.text == "10%"
    assert main(["run"]) == 0
    assert fake.request.sample is None


def test_a_selection_of_operators_reaches_the_campaign(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run"]) == 0
    assert fake.request.operators == "all"
    assert main(["run", "--operators", "common"]) == 0
    assert fake.request.operators == "common"
    assert main(["run", "--operators", "comon"]) == 2
    assert "did you mean 'common'?" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "list"])
@pytest.mark.parametrize("size", ["0%", "150%", "-3", "abc", "0", ""])
def test_an_absurd_sample_is_2_before_anything_runs(
    fake: Campaign, command: str, size: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, f"--sample={size}"]) == 2
    err = capsys.readouterr().err
    assert "sample" in err
    assert "Traceback" not in err
    assert fake.request is None


def test_without_options_a_run_does_what_the_configuration_says(fake: Campaign) -> None:
    main(["run"])
    assert (fake.request.rounds, fake.request.seed) == (1, 7)
    assert fake.request.jobs == len(os.sched_getaffinity(0))


def test_a_list_is_looked_for_here_and_in_the_project(
    fake: Campaign, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    assert main(["run", "--only", "@nowhere.txt"]) == 2
    assert "no list of mutants nowhere.txt" in capsys.readouterr().err
    assert fake.request is None
    (fake.project / "chosen.txt").write_text("")
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert main(["-C", str(fake.project), "run", "--only", "@chosen.txt"]) == 0
    assert fake.request.only == (f"@{fake.project / 'chosen.txt'}",)


def test_a_key_of_the_configuration_can_be_set_for_one_command(fake: Campaign) -> None:
    words = ["-o", "rounds=3", "-o", "when=once", "-o", 'pytest_args=["-x"]', "-o", "memory = 5 GB"]
    assert main(["run", *words]) == 0
    configuration = fake.request.configuration
    assert (fake.request.rounds, configuration.when) == (3, ("once",))
    assert (configuration.pytest_args, configuration.memory) == (("-x",), 5_000_000_000)
    assert main(["run"]) == 0
    assert fake.request.rounds == 1


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("rounds=0", "-o rounds=0 · rounds: must be at least 1"),
        ("round=3", "did you mean 'rounds'?"),
        ("rounds", "-o rounds: write KEY=VALUE"),
        ("=3", "-o =3: write KEY=VALUE"),
        ("a.b.c=1", "write KEY=VALUE"),
        ("when=onc", "'onc' is not a moment"),
        pytest.param("cluster.cacert=x", "unknown key 'cacert'", marks=pytest.mark.needs("dask")),
        ("program=nowhere.py", "there is no 'nowhere.py'"),
        ("order=2", "the key 'order' is gone: a mutant is one fault"),
        (f"rounds={'[' * 5000}", "rounds"),
        (f"rounds={'9' * 5000}", "rounds"),
    ],
)
def test_a_wrong_setting_is_2_and_names_the_option(
    fake: Campaign, given: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "-o", given]) == 2
    assert told in capsys.readouterr().err
    assert fake.request is None


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("run --selection few.txt", "--selection is gone; use --only @FILE"),
        ("run --table", "`mutabot results`"),
        ("run --serve", "`mutabot live`"),
        ("list --when once", "use -o when=MOMENT"),
        ("run --order 2", "--order is gone; a mutant is one fault"),
        ("thresholds --steps", "`mutabot thresholds --json`"),
        ("report --compare old", "`mutabot.open`"),
        ("results --all", "`mutabot list --all`"),
        ("replay 1 --video a.mp4", "--video is gone; use `mutabot motion MUTANT`"),
        ("compare", "the command compare is gone; `make comparison`"),
    ],
)
def test_what_went_away_says_what_to_use_instead(
    fake: Campaign, words: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words.split()) == 2
    err = capsys.readouterr().err
    assert told in err
    assert len(err.splitlines()) == 1


def test_an_option_that_there_is_not_is_no_part_of_a_request(project: Path) -> None:
    with pytest.raises(TypeError, match="there is no option rouns"):
        request_of(project, rouns=3)  # type: ignore[call-arg]


@pytest.mark.needs("dask")
def test_run_has_twenty_two_options() -> None:
    group: Any = typer.main.get_command(app)
    context = group.context_class(group, info_name="mutabot")
    assert len(group.resolve_command(context, ["run"])[1].params) == 22


def test_a_project_elsewhere_can_be_named(
    fake: Campaign, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert main(["-C", str(fake.project), "run"]) == 0
    assert main(["-C", str(fake.project), "results"]) == 0


def test_lines_of_mutants_go_alone_to_standard_output(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "--format", "lines"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("\t")[1] for line in lines] == ["1", "2", "3", "4", "5", "complete"]


def test_survivors_end_a_run_with_1_if_that_is_asked_for(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "--format", "jsonl", "--fail-on", "survivors"]) == 1
    assert "2 survivors (--fail-on survivors): 2, 4" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--format", "xml"], "known: jsonl, lines"),
        (["--format", "lines", "--json"], "only one of them"),
        (["--fail-on", "surv"], "not one of survivors, untested"),
    ],
)
def test_a_wrong_format_or_limit_is_reported_before_anything_is_run(
    fake: Campaign, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert main(["run", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert fake.request is None


def test_json_goes_alone_to_standard_output(fake: Campaign, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["state"] == "complete"


@pytest.mark.parametrize(("limit", "code"), [("25", 0), ("50", 1)])
def test_a_score_under_the_limit_is_1(
    fake: Campaign, limit: str, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "--min-score", limit]) == code
    assert ("under the limit" in capsys.readouterr().err) == bool(code)


def test_the_limit_of_the_configuration_holds_unless_the_command_line_says_otherwise(fake: Campaign) -> None:
    with (fake.project / "mutabot.toml").open("a") as file:
        file.write("min_score = 90\n")
    assert main(["run"]) == 1
    assert main(["run", "--min-score", "0"]) == 0


def in_all_rounds(verdict: Verdict) -> tuple[Outcome, ...]:
    """Every mutant ends so in both rounds."""
    return tuple(Outcome(mutant.id, round, verdict) for mutant in samples.MUTANTS for round in (0, 1))


def test_a_run_in_which_everything_is_refused_is_3(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    fake.journal = {"outcomes": in_all_rounds(Verdict.REFUSED)}
    assert main(["run"]) == 3
    assert "refused every mutant" in capsys.readouterr().err


def test_time_outs_beyond_the_limit_are_5(fake: Campaign) -> None:
    fake.journal = {"outcomes": in_all_rounds(Verdict.TIMEOUT)}
    assert main(["run"]) == 0
    with (fake.project / "mutabot.toml").open("a") as file:
        file.write("timeout_limit = 0.5\n")
    assert main(["run"]) == 5


def test_errors_exit_with_4_and_are_named_first_unless_the_limit_allows_them(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run"]) == 0  # one of the ten outcomes is an error, as the project allows
    text = (fake.project / "mutabot.toml").read_text()
    (fake.project / "mutabot.toml").write_text(text.replace("error_limit = 0.1", ""))
    capsys.readouterr()
    assert main(["run"]) == 4
    out, err = capsys.readouterr()
    assert err.splitlines()[-1].startswith("1 of 10 outcomes are errors (10%); the limit is 0% (error_limit)")
    assert main(["results"]) == 0
    for text in (out, capsys.readouterr().out):
        first = text.index("1 of 10 outcomes ended in error")
        assert first < min(text.index(word) for word in ("family · role", "survivors"))


def test_unstable_outcomes_beyond_the_limit_are_4(fake: Campaign, capsys: pytest.CaptureFixture[str]) -> None:
    ends = (Outcome(samples.SKIP.id, 0, Verdict.UNSTABLE), Outcome(samples.SKIP.id, 1, Verdict.SURVIVED))
    fake.journal = {"mutants": (samples.SKIP,), "outcomes": ends}
    assert main(["run"]) == 4
    assert "1 of 2 outcomes are unstable (50%); the limit is 10%" in capsys.readouterr().err
    with (fake.project / "mutabot.toml").open("a") as file:
        file.write("unstable_limit = 0.5\n")
    assert main(["run"]) == 0


def test_a_disagreement_is_4_and_names_the_mutant(fake: Campaign, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = {"mutant": "some.id", "number": 2, "round": 0, "first": "survived", "second": "killed by check"}
    fake.journal = {"verification": {"wanted": 3, "checked": 3, "disagreements": [wrong]}}
    assert main(["run", "--verify", "3"]) == 4
    out, err = capsys.readouterr()
    assert "Verified: 2 of 3 outcomes end the same" in out
    assert "mutant 2 (some.id), round 1" in err


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (BaselineError("the tests fail: test_a"), 3),
        (ControlError("a control ended wrongly"), 4),
        (UnstableError("2 of 3 tests are flaky"), 4),
        (MutabotError("something of ours"), 70),
    ],
)
def test_errors_of_ours_become_their_exit_code_and_a_plain_line(
    fake: Campaign, error: MutabotError, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    fake.error = error
    assert main(["run"]) == code
    err = capsys.readouterr().err
    assert f"mutabot: {error}" in err
    assert "Traceback" not in err


def test_an_interrupted_run_is_130_and_says_where_to_look(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    fake.error = KeyboardInterrupt()
    assert main(["run"]) == 130
    assert "mutabot results" in capsys.readouterr().err


def test_an_internal_error_is_70_with_its_traceback_in_a_file(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    fake.error = ZeroDivisionError("oops")
    assert main(["run"]) == 70
    err = capsys.readouterr().err
    assert "ZeroDivisionError: oops" in err
    assert "Traceback" not in err
    assert "Traceback" in (fake.project / ".mutabot" / "crash.txt").read_text()


def test_results_and_show_work_from_a_folder_inside_the_project(
    fake: Campaign, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["run"])
    monkeypatch.chdir(fake.project / "tests")
    assert main(["results"]) == 0
    assert main(["show", "2"]) == 0
    assert "gripper.command(0)" in capsys.readouterr().out


def test_results_need_no_configuration(fake: Campaign) -> None:
    main(["run"])
    (fake.project / "mutabot.toml").unlink()
    assert main(["results"]) == 0


def test_show_takes_an_id_and_prints_json(fake: Campaign, capsys: pytest.CaptureFixture[str]) -> None:
    main(["run"])
    capsys.readouterr()
    assert main(["show", samples.SKIP.id, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["number"] == 2


def test_show_of_an_unknown_mutant_names_the_nearest(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["run"])
    assert main(["show", samples.SKIP.id.replace("skip", "sikp")]) == 2
    assert samples.SKIP.id in capsys.readouterr().err


def test_show_of_a_name_unlike_any_mutant_says_what_names_one(
    fake: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["run"])
    assert main(["show", "xyz"]) == 2
    error = capsys.readouterr().err
    assert "there is no mutant 'xyz'; give numbers 1 to " in error
    assert error.count("mission.py") == 1


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_results_can_be_piped_in_any_encoding(fake: Campaign, encoding: str) -> None:
    main(["run"])
    done = subprocess.run(
        [sys.executable, "-m", "mutabot.cli.app", "results"],
        capture_output=True, check=False, env={**os.environ, "PYTHONIOENCODING": encoding, "COLUMNS": "80"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert b"Scores" in done.stdout


@pytest.mark.parametrize("command", ["results", "results --json", "show 1", "list --help"])
def test_a_pipe_that_closes_early_is_no_error(fake: Campaign, command: str) -> None:
    fake.journal = {"mutants": tuple(
        samples.mutant(number, f"made-{number}", samples.MOVE, "dx", "arm.move_by " * 20)
        for number in range(1, 400)
    )}  # fmt: skip
    main(["run"])
    pipe = f"{sys.executable} -m mutabot {command} | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", pipe], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) == 1
    assert not (fake.project / ".mutabot" / "crash.txt").exists()


@pytest.mark.parametrize("command", ["results", "results --json", "report --format csv", "--help"])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_standard_output_is_no_internal_error(fake: Campaign, command: str, unbuffered: str) -> None:
    main(["run"])
    shown = f"{sys.executable} -m mutabot {command} > /dev/full"
    variables = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    done = subprocess.run(["bash", "-c", shown], capture_output=True, text=True, check=False, env=variables)
    assert done.returncode == ExitCode.USAGE
    assert "mutabot: standard output cannot be written: No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (fake.project / ".mutabot" / "crash.txt").exists()


def test_remarks_that_cannot_be_written_end_nothing(fake: Campaign) -> None:
    main(["run"])
    for command, code in (("results", ExitCode.FINE), ("nonsense", ExitCode.USAGE)):
        shown = f"{sys.executable} -m mutabot {command} 2> /dev/full"
        assert subprocess.run(["bash", "-c", shown], capture_output=True, check=False).returncode == code


@pytest.mark.parametrize("command", [[], ["run"], ["show"]])
def test_the_short_option_asks_for_help_too(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*command, "-h"]) == 0
    short = capsys.readouterr().out
    main([*command, "--help"])
    assert short == capsys.readouterr().out
    assert "Usage: mutabot" in short
    assert not re.search(r"<(str|int|float|path)[^>]*>\s{2}", short.partition("Options:")[2])


@pytest.mark.needs("source")
def test_the_shell_completes_commands(project: Path) -> None:
    def completed(words: str) -> list[str]:
        variables = {"_MUTABOT_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": "2"}
        count = str(len(words.split()) - (not words.endswith(" ")))
        done = subprocess.run(
            [Path(sys.executable).with_name("mutabot")], capture_output=True, text=True, check=False,
            env={**os.environ, **variables, "COMP_CWORD": count},
        )  # fmt: skip
        return done.stdout.split()

    assert completed("mutabot re") == ["replay", "results", "report"]


def test_help_is_quick() -> None:
    before = used()
    subprocess.run([sys.executable, "-m", "mutabot.cli.app", "--help"], capture_output=True, check=True)
    assert used() - before < 2.0  # seconds of the processor, of which it takes a fifth of one


def test_another_system_than_linux_is_reported_in_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    assert main(["results"]) == 2
    assert capsys.readouterr().err == (
        "mutabot: mutabot runs on Linux only; this is darwin: use a container or a virtual machine\n"
    )
