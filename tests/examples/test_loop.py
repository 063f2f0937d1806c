"""The example ``loop``: its own suite, and mutants at moments of its control loop."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from tests.campaign.project import Quiet

from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal
from mutabot.model import Moment, Verdict

EXAMPLE = Path(__file__).parents[2] / "examples" / "loop"
#: why each must end so: a policy that sees what happened makes up for one step, and for none that are missing
EXPECTED = {
    "": Verdict.KILLED,  # the finger never moves
    "once": Verdict.SURVIVED,
    "from 50": Verdict.KILLED,  # it stops on the way, and the policy gives up
    "2-2.4 s": Verdict.KILLED,  # while no step is made no time passes, so that the window has no end
}


@pytest.fixture(scope="module")
def ends(tmp_path_factory: pytest.TempPathFactory) -> dict[str, set[Verdict]]:
    """How skipping a step of the loop ends in two rounds, by moment."""
    folder = tmp_path_factory.mktemp("loop") / "loop"
    shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns(".mutabot", "__pycache__"))
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    moments = tuple(Moment.parse(text) if text else None for text in EXPECTED)
    request = Request(
        configuration, vocabulary, 2, 1, 2,
        only=("policy.py:run:table.step#1:call:skip*",), families=("robot",), moments=moments,
    )  # fmt: skip
    found: dict[str, set[Verdict]] = {}
    with Journal.open(run_campaign(request, Quiet())) as journal:
        mutants = {candidate.id: candidate for candidate in journal.mutants()}
        for outcome in journal.outcomes():
            mutant = mutants[outcome.mutant]
            found.setdefault(mutant.moment.text if mutant.moment else "", set()).add(outcome.verdict)
    return found


@pytest.mark.parametrize("moment", EXPECTED)
def test_a_missing_step_ends_as_it_must(ends: dict[str, set[Verdict]], moment: str) -> None:
    assert ends[moment] == {EXPECTED[moment]}
