"""Numbers, lists and depths that cannot be meant: exit 2 with a sentence, for every option and key."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

import pytest
import typer
from pydantic import BaseModel
from typer.models import OptionInfo

from mutabot.cli.app import app, function_of, main
from mutabot.cli.parameters import with_options
from mutabot.config import options as limits
from mutabot.config.configuration import Settings, load_configuration
from mutabot.config.demands import DemandTable
from mutabot.config.vocabulary import load_vocabulary, schema
from mutabot.errors import ConfigurationError, ExitCode
from tests.campaign.project import write_project

DIGITS = "9" * 400
#: beyond what Python reads
MORE = "9" * 5000
DEEP = "[" * 90 + "]" * 90
DEEPER = "[" * 5000 + "]" * 5000
LONG = "[" + "1, " * 20_000 + "]"
HEX = "0x" + "f" * 6000
GOOD = {"program": '["mission.py"]', "vocabulary": '["robot.toml"]'}
MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = "import mission\nfrom robot import Arm\n\ndef test_run():\n    mission.run(Arm())\n"


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_project(tmp_path_factory.mktemp("extremes"), MISSION, TESTS)


def declared() -> Iterator[tuple[str, set[type], set[str], Any]]:
    """Command, types, names and declaration of every option."""
    group: Any = typer.main.get_command(app)
    for name in group.list_commands(None):
        callback = with_options(function_of(name))
        for hint in callback.__annotations__.values():
            if get_origin(hint) is Annotated and isinstance(hint.__metadata__[0], OptionInfo):
                kind = get_args(hint)[0]
                option = hint.__metadata__[0]
                names = {
                    declaration
                    for declaration in (option.default, *(option.param_decls or ()))
                    if isinstance(declaration, str)
                }
                yield name, {*(get_args(kind) or (kind,))}, names, option


def options() -> list[tuple[str, str]]:
    """Every option of every command that takes a number, or a text that is read as one."""
    texts = {"--sample", "--shard", "--budget", "--only", "--skip", "--family", "--engine"}
    return [
        (command, max(names, key=len))
        for command, kinds, names, _ in declared()
        if kinds & {int, float} or texts & names
    ]


OPTIONS = options()


@pytest.mark.needs("live")
def test_all_numbers_of_the_command_line_are_tried_and_bounded() -> None:
    tried = {option for _, option in OPTIONS}
    assert tried >= {
        "--rounds",
        "--seed",
        "--jobs",
        "--verify",
        "--min-score",
        "--port",
    }
    assert tried >= {"--seeds", "--round", "--budget", "--sample", "--shard"}
    for _, kinds, names, option in declared():
        if kinds & {int, float}:
            assert None not in (option.min, option.max), names


@pytest.mark.parametrize(("command", "option"), OPTIONS)
def test_an_option_that_cannot_be_meant_is_a_usage_error(
    project: Path, command: str, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.rmtree(project / ".mutabot", ignore_errors=True)  # as other options may have left it
    arguments = ["1"] if command in ("show", "replay") else []
    for value in (DIGITS, MORE, f"-{DIGITS}", "nan", "-1", "1e999", "inf", DEEP):
        assert main(["-C", str(project), command, *arguments, f"{option}={value}"]) == ExitCode.USAGE, value
        err = capsys.readouterr().err
        assert "Traceback" not in err
        assert len(err) < 2000
        assert not (project / ".mutabot" / "crash.txt").exists()


def keys(model: type[BaseModel]) -> list[str]:
    return [info.alias or name for name, info in model.model_fields.items()]


VALUES = [DIGITS, MORE, f"-{DIGITS}", HEX, "nan", "inf", "-inf", "-1", "1e999", DEEP, DEEPER, f'"{DIGITS}"']


def configuration_refused(folder: Path, text: str) -> str:
    (folder / "mutabot.toml").write_text(text)
    with pytest.raises(ConfigurationError) as error:
        load_configuration(folder)
    assert error.value.exit_code == ExitCode.USAGE
    return str(error.value)


@pytest.mark.parametrize("key", keys(Settings))
def test_a_setting_that_cannot_be_meant_is_reported(tmp_path: Path, key: str) -> None:
    (tmp_path / "mission.py").touch()
    (tmp_path / "tests").mkdir()
    lines = [f"{name} = {text}" for name, text in GOOD.items() if name != key]
    for value in VALUES:
        told = configuration_refused(tmp_path, "\n".join([*lines, f"{key} = {value}"]))
        assert told.startswith("mutabot.toml")
        assert key in told or value in (MORE, DEEPER), told
        assert len(told) < 2000


BOUNDS = {
    "rounds": limits.ROUNDS, "seed": limits.SEED, "jobs": limits.JOBS,
    "timeout_factor": limits.FACTOR, "timeout_seconds": limits.SECONDS, "memory": limits.BYTES,
    "evidence": limits.BYTES, "baseline_repetitions": limits.BASELINES,
}  # fmt: skip


@pytest.mark.parametrize("key", BOUNDS)
def test_the_greatest_number_is_taken_and_the_next_is_named_with_it(tmp_path: Path, key: str) -> None:
    (tmp_path / "mission.py").touch()
    (tmp_path / "tests").mkdir()
    lines = [f"{name} = {text}" for name, text in GOOD.items()]
    (tmp_path / "mutabot.toml").write_text("\n".join([*lines, f"{key} = {BOUNDS[key]}"]))
    assert getattr(load_configuration(tmp_path), key) == BOUNDS[key]
    told = configuration_refused(tmp_path, "\n".join([*lines, f"{key} = {BOUNDS[key] + 1}"]))
    assert re.search(rf"mutabot.toml:3 · {key}: must be at most {BOUNDS[key]}", told), told


def test_every_number_of_the_configuration_has_both_bounds() -> None:
    for name, setting in Settings.model_json_schema()["properties"].items():
        for kind in setting.get("anyOf", [setting]):
            if kind.get("type") in ("integer", "number") and "enum" not in kind:
                assert kind.keys() & {"maximum", "exclusiveMaximum"}, name
                assert kind.keys() & {"minimum", "exclusiveMinimum"} or name in ("memory", "evidence"), name


OPERATION = '[[operation]]\ncall = "robot:Arm.move_by"\n'
QUANTITY = OPERATION + "arguments.dx = { kind = 'translation', mode = 'by', unit = 'm', KEY = %s }"
#: what stands before a key of each kind of table, and the keys that stand there already
PLACES: list[tuple[str, type[BaseModel], set[str]]] = [
    (QUANTITY, schema.QuantityTable, {"kind", "mode", "unit"}),
    (OPERATION + "KEY = %s", schema.OperationTable, {"call"}),
    ("[clock]\nKEY = %s", schema.ClockTable, set()),
    ("[wait]\nKEY = %s", schema.WaitTable, set()),
    ("[[probe]]\ncall = 'a:b'\nKEY = %s", schema.ProbeTable, {"call"}),
    ("KEY = %s", schema.VocabularyTable, set()),
]
TABLES = {
    f"{model.__name__} {key}": text.replace("KEY", key)
    for text, model, there in PLACES
    for key in keys(model)
    if key not in there
}


@pytest.mark.parametrize("table", TABLES)
def test_a_vocabulary_that_cannot_be_meant_is_reported(tmp_path: Path, table: str) -> None:
    for value in VALUES:
        (tmp_path / "robot.toml").write_text(TABLES[table] % value)
        # a text, or a number that the vocabulary compares with nothing, may do
        is_free = value in ("-1", f'"{DIGITS}"', "inf", "-inf", "nan", "1e999")
        with suppress(ConfigurationError) if is_free else pytest.raises(ConfigurationError) as error:
            load_vocabulary(["robot.toml"], tmp_path)
        assert error is None or len(str(error.value)) < 20_000


@pytest.mark.parametrize("key", ["program", "tests", "demand", "rounds"])
def test_a_list_without_end_is_reported_with_its_key(tmp_path: Path, key: str) -> None:
    told = configuration_refused(tmp_path, f"{key} = {LONG}")
    assert told.startswith(f"mutabot.toml:1 · {key}: has 20000 entries; at most 10,000")


@pytest.mark.parametrize("key", [key for key in keys(DemandTable) if key != "notice"])
def test_a_demand_that_cannot_be_meant_is_reported(tmp_path: Path, key: str) -> None:
    (tmp_path / "mission.py").touch()
    (tmp_path / "tests").mkdir()
    good = "\n".join(f"{name} = {text}" for name, text in GOOD.items())
    for value in VALUES:
        if not (key in ("site", "quantity") and value.startswith('"')):  # any text may be one
            configuration_refused(tmp_path, f'{good}\n[[demand]]\nnotice = "5 mm"\n{key} = {value}')


def test_a_demanded_magnitude_that_cannot_be_meant_is_reported(tmp_path: Path) -> None:
    (tmp_path / "mission.py").touch()
    (tmp_path / "tests").mkdir()
    good = "\n".join(f"{name} = {text}" for name, text in GOOD.items())
    for notice in (*VALUES, f'"{DIGITS} mm"', '"1e999 mm"', '"-1 mm"', '"0 mm"'):
        configuration_refused(tmp_path, f"{good}\n[[demand]]\nnotice = {notice}")


def test_an_internal_error_is_kept_in_the_project_that_was_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from mutabot.cli import request  # noqa: PLC0415

    def broken(*arguments: Any, **options: Any) -> Any:
        raise RuntimeError("broken")

    write_project(tmp_path / "project", MISSION, TESTS)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    monkeypatch.setattr(request, "families_of", broken)
    for words in (
        ["-C", "../project"],
        ["-C../project"],
        ["--project", "../project"],
        ["--project=../project"],
    ):
        assert main([*words, "list", "-C"]) == ExitCode.USAGE
        assert main([*words, "list"]) == ExitCode.INTERNAL_ERROR
        file = tmp_path / "project" / ".mutabot" / "crash.txt"
        assert "RuntimeError: broken" in file.read_text()
        assert "details are in ../project/.mutabot/crash.txt" in capsys.readouterr().err
        file.unlink()
    assert list(elsewhere.iterdir()) == []
