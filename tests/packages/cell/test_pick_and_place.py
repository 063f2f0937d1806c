"""The example ``pick_and_place``: its own suite passes, and the shipped vocabulary fits its program."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary

from .example_suites import EXAMPLES, run_suite

EXAMPLE = EXAMPLES / "pick_and_place"


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_the_examples_own_suite_passes(project: Path) -> None:
    done = run_suite(project)
    assert done.returncode == 0, done.stdout


def test_the_shipped_vocabulary_of_the_cell_loads(project: Path) -> None:
    configuration = load_configuration(project)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    assert configuration.vocabulary == ("cell",)
    assert vocabulary.operations
    assert vocabulary.clock is not None
    assert vocabulary.probes


def test_every_name_in_the_shipped_vocabulary_exists() -> None:
    vocabulary = load_vocabulary(["cell"], EXAMPLE)
    targets = [operation.target for operation in vocabulary.operations]
    targets += [*vocabulary.refusals, *vocabulary.checks, *vocabulary.failures]
    targets += [probe.target for probe in vocabulary.probes]
    assert vocabulary.clock is not None
    for target in [*targets, vocabulary.clock.tick]:
        module, _, name = target.partition(":")
        found: object = __import__(module, fromlist=["_"])
        for part in name.split("."):
            found = getattr(found, part)
        assert found is not None
