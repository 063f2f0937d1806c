"""Plug-ins that mutabot switches off: what a project says about them is accepted and has no effect."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.errors import MutabotError
from mutabot.model import By, Outcome, Verdict
from tests.campaign.project import REPLAY, run, write_project

WITH_PLUGINS = pytest.mark.usefixtures("plugins")

MISSION = """
    def go(arm):
        arm.move_by(0.25)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_goes():
        arm = Arm()
        mission.go(arm)
        assert arm.x == 0.25
"""
SKIP = "mission.py:go:arm.move_by#1:call:skip"
#: everything that a project may say about xdist, cov and rerunfailures
CONFIGURED = """
    [pytest]
    addopts = {more} -n 2 --dist loadfile --maxprocesses=4 --cov=mission --cov-report term --cov-fail-under=99
        --reruns 2 --reruns-delay 1 --strict-config --strict-markers
    required_plugins = pytest-xdist pytest_cov>=1 pytest-rerunfailures
    filterwarnings = error
    reruns = 3
    rsyncdirs = .
"""
USED = """
    import mission
    import pytest
    from robot import Arm

    @pytest.mark.flaky(reruns=2)
    @pytest.mark.xdist_group("arms")
    @pytest.mark.no_cover
    def test_goes(worker_id, testrun_uid, cov, pytestconfig):
        assert (worker_id, cov) == ("master", None)
        assert pytestconfig.getoption("--reruns") is pytestconfig.getoption("numprocesses") is None
        assert pytestconfig.option.dist == "no"
        arm = Arm()
        mission.go(arm)
        assert arm.x == 0.25
"""
#: a plug-in in the place of another, which must not come into play
SHUFFLING = """
    def pytest_addoption(parser):
        parser.addoption("--randomly-seed", dest="randomly_seed", type=int)

    def pytest_collection_modifyitems(items):
        items.clear()
"""
HOOKS = """
    def pytest_xdist_setupnodes(config, specs):
        raise AssertionError("nothing is distributed")
"""


def is_killed_by_the_test(outcome: Outcome) -> bool:
    return outcome.verdict is Verdict.KILLED and outcome.by is By.CHECK


@WITH_PLUGINS
@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize("more", ["", "-p xdist -p pytest_cov.plugin -p no:cacheprovider -d"])
def test_options_settings_markers_fixtures_and_hooks_of_plugins_are_accepted_and_without_effect(
    tmp_path: Path, engine: str, more: str
) -> None:
    files = {"pytest.ini": CONFIGURED.replace("{more}", more), "conftest.py": HOOKS}
    outcomes = run(write_project(tmp_path, MISSION, USED, more=files), engine=engine)
    assert is_killed_by_the_test(outcomes[SKIP])
    assert len(outcomes) == 3
    assert not list(tmp_path.glob(".coverage*"))


@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize("place", ["addopts", "pytest_args"])
def test_a_suite_without_a_cache_may_take_warnings_for_errors(
    tmp_path: Path, engine: str, place: str
) -> None:
    without = {"addopts": "", "pytest_args": "", place: "-p no:cacheprovider"}
    more = {
        "pytest.ini": f"[pytest]\naddopts = {without['addopts']} --strict-config\nfilterwarnings = error\n"
    }
    words = ["-o", "pythonpath=.", *without["pytest_args"].split()]
    configuration = f'program = ["mission.py"]\nvocabulary = ["robot.toml"]\npytest_args = {words}\n'
    outcomes = run(
        write_project(tmp_path, MISSION, TESTS, configuration=configuration, more=more), engine=engine
    )
    assert is_killed_by_the_test(outcomes[SKIP])


@WITH_PLUGINS
def test_options_may_come_from_the_environment_and_name_plugins_of_the_project(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTEST_ADDOPTS", "-n auto -p pytest_randomly --randomly-seed=7")
    files = {"pytest_randomly.py": SHUFFLING, "setup.cfg": "[tool:pytest]\naddopts = -n2 --reruns=1\n"}
    outcomes = run(write_project(tmp_path, MISSION, TESTS, more=files))
    assert is_killed_by_the_test(outcomes[SKIP])


@pytest.mark.parametrize(
    ("tests", "files", "said"),
    [
        (TESTS, {"pytest.ini": "[pytest]\naddopts = --nonsense=3\n"}, "unrecognized arguments: --nonsense=3"),
        (
            TESTS,
            {"conftest.py": "import nowhere\n"},
            "conftest.py:1: in <module>\n      import nowhere\n  E   ModuleNotFoundError: No module named",
        ),
        pytest.param(
            TESTS,
            {"pytest.ini": "[pytest]\naddopts = --strict-config\nnonsense = 3\n"},
            "Unknown config option: nonsense",
            marks=pytest.mark.whole,
        ),
        pytest.param(
            TESTS,
            {"conftest.py": "def pytest_collection_modifyitems():\n    1 / 0\n"},
            "ZeroDivisionError: division by zero",
            marks=pytest.mark.whole,
        ),
        ("import nowhere\n", {}, "import nowhere\nE   ModuleNotFoundError: No module named 'nowhere'"),
        pytest.param(
            "def test_it(nowhere):\n    pass\n",
            {},
            "test_it: fixture 'nowhere' not found",
            marks=pytest.mark.whole,
        ),
        ("HERE = 1\n", {}, "pytest finds no tests with tests -o pythonpath=."),
    ],
)
def test_where_tests_cannot_be_run_pytests_own_message_is_shown(
    tmp_path: Path, tests: str, files: dict[str, str], said: str
) -> None:
    check_what_is_said(tmp_path, tests, files, said)


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_hook_of_the_suite_may_call_the_program_before_any_test(tmp_path: Path, engine: str) -> None:
    hook = """
        import mission
        from robot import Arm

        def pytest_collection_modifyitems():
            mission.go(Arm())
        """
    outcomes = run(write_project(tmp_path, MISSION, TESTS, more={"conftest.py": hook}), engine=engine)
    assert outcomes[SKIP].verdict is Verdict.KILLED


@WITH_PLUGINS
def test_a_plugin_that_is_required_and_not_installed_is_named(tmp_path: Path) -> None:
    files = {"pytest.ini": "[pytest]\nrequired_plugins = pytest-nowhere pytest-xdist\n"}
    check_what_is_said(tmp_path, TESTS, files, "Missing required plugins: pytest-nowhere")


def check_what_is_said(folder: Path, tests: str, files: dict[str, str], said: str) -> None:
    with pytest.raises(MutabotError) as caught:
        run(write_project(folder, MISSION, tests, more=files))
    assert said in str(caught.value)
    assert "rootdir" not in str(caught.value)


#: as pyfakefs does: a fake stands in the place of ``os`` in the modules that are loaded, but for some
FAKE = """
    import os
    import sys
    from contextlib import contextmanager

    class Fake:
        def __getattr__(self, name):
            raise OSError("nothing is there")

    class Patcher:
        SKIPMODULES = {os, os.path, sys}

    @contextmanager
    def fake_files():
        fake, replaced = Fake(), []
        for module in list(sys.modules.values()):
            is_faked = module.__name__.startswith(("mutabot", "mission")) and vars(module).get("os") is os
            if is_faked and module not in Patcher.SKIPMODULES:
                replaced.append(module)
                module.os = fake
        sys.modules["os"] = fake
        try:
            yield
        finally:
            sys.modules["os"] = os
            for module in replaced:
                module.os = os
"""
IN_FAKE = """
    import mission
    import pytest
    from pyfakefs.fake_filesystem_unittest import fake_files
    from robot import Arm

    @pytest.fixture
    def fs():
        with fake_files():
            yield

    def test_goes(fs):
        arm = Arm()
        mission.go(arm)
        assert arm.x == 0.25
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_a_fake_file_system_stands_in_the_place_of_none_of_our_files(tmp_path: Path, engine: str) -> None:
    fakes = {"pyfakefs/fake_filesystem_unittest.py": FAKE}
    folder = write_project(tmp_path, "import os\n" + dedent(MISSION), IN_FAKE, more=fakes)
    found = run(folder, engine=engine, only=(SKIP, SKIP.replace("skip", "repeat")))
    assert {(outcome.verdict, outcome.by) for outcome in found.values()} == {(Verdict.KILLED, By.CHECK)}
    assert {outcome.engine for outcome in found.values()} == {"replay"}
