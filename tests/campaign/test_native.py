"""Campaigns on callables that do not tell their arguments."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.model import Verdict
from tests.campaign.project import Quiet, by_forks, request_for, write_project

#: ``hexlify(data, sep, bytes_per_sep)`` is native, tells no signature, and takes keywords
ROBOT = """
    from binascii import hexlify as group
"""
MISSION = """
    import robot

    def by_position():
        return robot.group(bytes([1, 2, 3]), ":", 2)

    def by_keyword():
        return robot.group(bytes([1, 2, 3]), ":", bytes_per_sep=2)
"""
TESTS = """
    import mission

    def test_by_position():
        assert mission.by_position() == b"01:0203"

    def test_by_keyword():
        assert mission.by_keyword() == b"01:0203"
"""
VOCABULARY = """
    [[operation]]
    call = "robot:group"
    arguments.bytes_per_sep = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""


def test_check_says_once_what_to_write_for_a_native_function(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
    progress = Quiet()
    report = check(request_for(tmp_path), progress)
    about = "robot.toml:2 · robot:group · signature:"
    (remark,) = [line for line in (*progress.lines, *report.lines) if about in line]
    assert remark.startswith("note      ")
    assert [item["key"] for item in report.data["remarks"]] == ["signature"]


@pytest.mark.whole
def test_with_a_signature_every_argument_of_a_native_function_is_mutated(tmp_path: Path) -> None:
    vocabulary = VOCABULARY.replace("arguments", 'signature = "(data, sep, bytes_per_sep)"\n    arguments')
    write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=vocabulary)
    found = {mutant: outcome for (mutant, _), outcome in by_forks(tmp_path).items()}
    reversed_ = {mutant: outcome for mutant, outcome in found.items() if mutant.endswith(":reverse")}
    assert len(reversed_) == 2
    assert {outcome.verdict for outcome in reversed_.values()} == {Verdict.KILLED}
    assert {outcome.example for outcome in reversed_.values()} == {(2, -2)}
    assert check(request_for(tmp_path), Quiet()).data["remarks"] == []
