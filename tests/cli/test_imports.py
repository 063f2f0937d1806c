"""What a command loads: whoever looks at results does not wait for what runs campaigns."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.report.format import names
from results import samples
from results.thresholds import journals

#: what runs a campaign, and what that needs
NOT_FOR_LOOKING = (
    "mutabot.model.job", "mutabot.campaign", "mutabot_source", "mutabot.runtime",
    "mutabot.operators", "mutabot.config.configuration", "mutabot.config.document",
    "mutabot.config.vocabulary", "mutabot_init", "mutabot_suggest", "libcst", "numpy", "scipy",
    "tomllib", "wrapt",
)  # fmt: skip
#: what says what a package brings, which may be a section of the results
DECLARING = {
    f"mutabot_{package}{module}" for package in ("init", "source", "suggest") for module in ("", ".extension")
}
CODE = """
import sys
from mutabot.cli.app import main
code = main(sys.argv[1:])
print(*sorted(sys.modules), file=sys.stderr)
sys.exit(code)
"""


@pytest.mark.parametrize(
    "words", [["results"], ["results", "--json"], ["show", "2"], ["show", "2", "--json"]]
)
def test_looking_at_results_loads_nothing_that_runs_a_campaign(tmp_path: Path, words: list[str]) -> None:
    samples.write_journal(tmp_path / ".mutabot" / "journal.sqlite")
    done = subprocess.run(
        [sys.executable, "-c", CODE, "-C", str(tmp_path), *words], capture_output=True, text=True, check=True
    )
    assert "gripper.command" in done.stdout
    assert_light(done.stderr)


@pytest.mark.parametrize("name", names())
def test_a_report_loads_nothing_that_runs_a_campaign_and_no_other_format(tmp_path: Path, name: str) -> None:
    samples.write_journal(tmp_path / ".mutabot" / "journal.sqlite")
    words = [sys.executable, "-c", CODE, "-C", str(tmp_path), "report", "--format", name]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert_light(done.stderr)
    formats = [module for module in done.stderr.split() if module.startswith("mutabot.report.formats.")]
    assert formats == [f"mutabot.report.formats.{name.replace('-', '_')}"]
    assert not {"pandas", "pyarrow"} & set(done.stderr.split())


def assert_light(loaded: str) -> None:
    assert "mutabot.results.results" in loaded.split()
    heavy = {name for name in loaded.split() if name.startswith(NOT_FOR_LOOKING)}
    assert heavy <= DECLARING


def test_thresholds_load_nothing_that_runs_a_campaign(tmp_path: Path) -> None:
    journals.write(tmp_path / ".mutabot" / "journal.sqlite", journals.Rungs(["SSSCCCC"]))
    words = [sys.executable, "-c", CODE, "-C", str(tmp_path), "thresholds"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert "arm.move_by" in done.stdout
    assert_light(done.stderr)
