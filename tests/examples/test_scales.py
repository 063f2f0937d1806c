"""The example ``scales``: its own suite, and the end of every one of its mutants."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.cli.app import main
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal
from mutabot.model import Outcome
from mutabot.report.document import document, dumps
from mutabot.results.results import read_results
from pages import blocks

EXAMPLE = Path(__file__).parents[2] / "examples" / "scales"
ROUNDS = 1

#: mutant -> verdict and what noticed it, with the reason why it must end so.
#: Ids are shortened by ``sorter.py:run:``.
EXPECTED = {
    # The gripper stays empty, so both scales stay empty.
    "link.send#1:pick:skip": "killed by check",
    # Closing closed fingers does nothing more.
    "link.send#1:pick:repeat": "survived, indistinguishable",
    # Releasing instead: as if skipped.
    "link.send#1:pick:opposite": "killed by check",
    # The turn begins at height 0 and hits the feeder's rim, 3 cm high: a protective stop.
    "link.send#2:lift/{height}:skip": "killed by exception",
    # 10 cm up is within the robot's 12; then 5 down, and the box falls the other 5 onto the right scale.
    "link.send#2:lift/{height}:repeat": "survived",
    # Dropping from height 0 is refused.
    "link.send#2:lift/{height}:opposite": "refused",
    # Red for blue and blue for red: the box ends on the wrong scale.
    "link.read#1:color/result:misread": "killed by check",
    # 270° instead of 90°: the wrong scale.
    "link.send#3:turn/{angle}/angle:reverse": "killed by check",
    # The box is put back onto the feeder.
    "link.send#3:turn/{angle}:skip": "killed by check",
    # Angles are absolute: turning to where the arm is does nothing more.
    "link.send#3:turn/{angle}:repeat": "survived, indistinguishable",
    # The same three for blue.
    "link.send#4:turn/{angle}/angle:reverse": "killed by check",
    "link.send#4:turn/{angle}:skip": "killed by check",
    "link.send#4:turn/{angle}:repeat": "survived, indistinguishable",
    # Released 5 cm above the scale: the box falls, and is then weighed as ever.
    "link.send#5:drop/{height}:skip": "survived",
    # The second drop would go below height 0, which is refused.
    "link.send#5:drop/{height}:repeat": "refused",
    # Up to 10 cm instead of down: the box falls 10 cm.
    "link.send#5:drop/{height}:opposite": "survived",
    # The box stays in the gripper, which carries its weight.
    "link.send#6:release:skip": "killed by check",
    # Opening open fingers does nothing more.
    "link.send#6:release:repeat": "survived, indistinguishable",
    # Picking instead: as if skipped.
    "link.send#6:release:opposite": "killed by check",
}
#: left out beforehand: the reverse of 5 cm is −5 cm, which the range of 0 to 12 cm excludes
LEFT_OUT = {"link.send#2:lift/{height}/height:reverse", "link.send#5:drop/{height}/height:reverse"}


class Silent(Progress):
    """A progress that shows nothing."""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the example."""
    copy = tmp_path_factory.mktemp("scales") / "scales"
    shutil.copytree(EXAMPLE, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    return copy


@pytest.fixture(scope="module")
def journal(project: Path) -> Journal:
    """The journal of a campaign on the copy."""
    configuration = load_configuration(project)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    request = Request(configuration, vocabulary, ROUNDS, configuration.seed, jobs=2)
    return Journal.open(run_campaign(request, Silent()))


def short(identity: str) -> str:
    return identity.removeprefix("sorter.py:run:")


def in_words(outcome: Outcome) -> str:
    by = f" by {outcome.by}" if outcome.by is not None else ""
    return f"{outcome.verdict}{by}{', indistinguishable' if outcome.indistinguishable else ''}"


@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=project,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_every_mutant_ends_as_it_must(journal: Journal) -> None:
    ends = {short(outcome.mutant): in_words(outcome) for outcome in journal.outcomes()}
    assert ends == EXPECTED


@pytest.mark.whole
def test_the_same_program_as_a_script_in_a_process_of_its_own_ends_alike(project: Path) -> None:
    configuration = load_configuration(project / "script")
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    few = ("*:pick:*", "*lift/{height}:repeat", "*lift/{height}:opposite", "*color*")
    request = Request(configuration, vocabulary, ROUNDS, configuration.seed, jobs=2, only=few, repeats=False)
    with Journal.open(run_campaign(request, Silent())) as journal:
        ends = {
            outcome.mutant.removeprefix("sort_box.py:<module>:line."): in_words(outcome)
            for outcome in journal.outcomes()
        }
    assert len(ends) > len(few)
    expected = {mutant.removeprefix("link."): end for mutant, end in EXPECTED.items()}
    assert ends == {mutant: expected[mutant] for mutant in ends}


def test_its_results_keep_the_published_schema(journal: Journal) -> None:
    schema = json.loads((EXAMPLE.parents[1] / "docs" / "results.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(json.loads(dumps(document(read_results(journal)))), schema)


def test_amounts_outside_the_robots_range_are_left_out(journal: Journal) -> None:
    assert {short(left.id) for left in journal.left_out()} == LEFT_OUT


def test_the_protective_stop_kills_the_mutant_that_turns_too_low(journal: Journal) -> None:
    outcome = next(o for o in journal.outcomes() if short(o.mutant) == "link.send#2:lift/{height}:skip")
    assert outcome.exception == "cell:ProtectiveStop"


def test_survivors_are_as_far_from_the_original_as_the_box_fell(journal: Journal) -> None:
    distances = {short(o.mutant): o.distance for o in journal.outcomes() if o.verdict == "survived"}
    assert distances["link.send#5:drop/{height}:opposite"] == pytest.approx(100)  # 10 cm, tolerance 0.1 cm
    assert distances["link.send#5:drop/{height}:skip"] == pytest.approx(50)
    assert distances["link.send#1:pick:repeat"] == 0


def test_the_readme_explains_every_survivor(journal: Journal) -> None:
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    survivors = [short(o.mutant) for o in journal.outcomes() if o.verdict == "survived"]
    assert [survivor for survivor in survivors if f"`{survivor}`" not in readme] == []
    killed = sum(end.startswith("killed") for end in EXPECTED.values())
    assert f"{killed} of {killed + len(survivors)}" in readme


@pytest.mark.usefixtures("journal")
@pytest.mark.parametrize(
    ("page", "start"),
    [("reading-a-report.md", "7 survivors, largest"), ("what-is-it.md", "no.  place")],
)
def test_pages_quote_what_is_printed(
    page: str,
    start: str,
    project: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert main(["-C", str(project), "results"]) == 0
    printed = {line.rstrip() for line in capsys.readouterr().out.splitlines()}
    text = (EXAMPLE.parents[1] / "docs" / page).read_text(encoding="utf-8")
    (quote,) = (block for block in blocks(text) if block.text.startswith(start))
    for line in quote.text.splitlines():
        assert line in printed or line.strip() in {"", "…"}


def test_the_campaign_leaves_the_project_as_it_was(project: Path, journal: Journal) -> None:
    def files(root: Path) -> dict[str, bytes]:
        found = (path for path in root.rglob("*") if path.is_file())
        relative = {path.relative_to(root): path for path in found}
        return {
            str(name): path.read_bytes()
            for name, path in relative.items()
            if not any(part.startswith(".") or part == "__pycache__" for part in name.parts)
        }

    assert journal.outcomes()
    assert files(project) == files(EXAMPLE)
    assert {path.name for path in project.iterdir() if path.name.startswith(".")} <= {".mutabot"}
