"""Seeds at every scope: of the test, or of what a shared fixture lives as long as."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Verdict
from mutabot.runtime.seeds import derive
from tests.campaign.project import CONFIGURATION, REPLAY, Quiet, outcomes, request_for, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.25)
"""
SHARED = """
    import os
    from pathlib import Path

    import mission
    import pytest
    from robot import Arm

    def seed_fixture(scope):
        @pytest.fixture(scope=scope, name=f"of_{scope}")
        def fixture(mutabot_seed):
            return mutabot_seed
        return fixture

    of_session, of_package, of_module, of_class, of_function = map(
        seed_fixture, ("session", "package", "module", "class", "function")
    )

    @pytest.fixture(scope="module")
    def asked_late(request):
        yield request.getfixturevalue("mutabot_seed")

    def tell(name, *seeds):
        with Path(os.environ["SEEDS"]).open("a") as file:
            print(name, *seeds, file=file)

    class TestInAClass:
        def test_one(self, of_session, of_package, of_module, of_class, of_function, mutabot_seed):
            tell("one", of_session, of_module, of_class, of_function, mutabot_seed)

        def test_two(self, mutabot_seed, of_class, mutabot_round_seed, asked_late):
            tell("two", mutabot_round_seed, asked_late, of_class, mutabot_seed)

    def test_three(of_session, mutabot_seed):
        tell("three", of_session, mutabot_seed)
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.25
"""
FILE = "tests/test_mission.py"


def seeds(path: Path) -> set[tuple[str, ...]]:
    """What tests told, without repetitions."""
    return {tuple(line.split()) for line in path.read_text().splitlines()}


def expected(round: int) -> set[tuple[str, ...]]:
    def of(node: str) -> str:
        return str(derive(1, round, node))

    session, module, group = of(""), of(FILE), of(f"{FILE}::TestInAClass")
    first, second, third = (
        of(f"{FILE}::{name}") for name in ("TestInAClass::test_one", "TestInAClass::test_two", "test_three")
    )
    return {
        ("one", session, module, group, first, first),
        ("two", session, module, group, second),
        ("three", session, third),
    }


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_a_shared_fixture_gets_the_seed_of_its_scope_and_a_test_its_own(
    tmp_path: Path, common: Path, engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = common / "seeds"
    monkeypatch.setenv("SEEDS", str(told))
    folder = write_project(tmp_path / "project", MISSION, SHARED)
    request = request_for(folder, engine=engine, rounds=2, only=("*:reverse",))
    found = outcomes(run_campaign(request, Quiet()))
    assert {outcome.verdict for outcome in found} == {Verdict.KILLED}
    assert seeds(told) == expected(0) | expected(1)


def plain_pytest(folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-o", "pythonpath=.", "tests"]
    return subprocess.run(
        words, cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True, check=False
    )


@pytest.mark.usefixtures("plugins")
def test_without_a_campaign_the_environment_gives_one_seed_for_all(tmp_path: Path) -> None:
    folder = write_project(tmp_path / "project", MISSION, SHARED)
    done = plain_pytest(folder, SEEDS=str(tmp_path / "seeds"), MUTABOT_SEED="5")
    assert done.returncode == 0, done.stdout
    numbers = {number for _, *found in seeds(tmp_path / "seeds") for number in found}
    assert numbers == {"5"}


OWN = """
    import pytest

    @pytest.fixture(scope="session")
    def mutabot_seed():
        return 7

    @pytest.fixture(scope="module")
    def cell(mutabot_seed):
        return mutabot_seed

    def test_own(cell, mutabot_seed):
        assert cell == mutabot_seed == 7
"""


def test_a_seed_that_the_suite_defines_itself_is_left_alone(tmp_path: Path) -> None:
    done = plain_pytest(write_project(tmp_path, MISSION, OWN, configuration=CONFIGURATION))
    assert done.returncode == 0, done.stdout
