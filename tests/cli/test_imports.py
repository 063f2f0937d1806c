"""What a command loads: whoever looks at results does not wait for what runs campaigns."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from analysis import samples

#: what runs a campaign, and what that needs
NOT_FOR_LOOKING = (
    "mutabot.border.job", "mutabot.border.lines", "mutabot.campaign", "mutabot.classical", "mutabot.inside",
    "mutabot.operators", "mutabot.proposal", "mutabot.settings", "mutabot.vocabulary", "libcst", "numpy",
    "scipy", "tomllib", "wrapt",
)  # fmt: skip
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
    loaded = done.stderr.split()
    assert "mutabot.analysis.results" in loaded
    assert [name for name in loaded if name.startswith(NOT_FOR_LOOKING)] == []
