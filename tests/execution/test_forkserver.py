"""Imports and collection are done once for all runs, and no run sees what another one did."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.campaign.run import run_campaign
from mutabot.errors import BaselineError, MutabotError
from mutabot.model import Verdict
from tests.campaign.project import CONFIGURATION, Quiet, outcomes, request_for, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.125)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.125
"""


def project(folder: Path, common: Path, *, conftest: str, tests: str = TESTS) -> Path:
    """A project whose diary, in ``common``, says what happened in its processes."""
    head = f"""
    import atexit, os, random, tempfile, threading, time
    import pytest

    def note(text):
        with open({str(common / "diary")!r}, "a") as diary:
            diary.write(text + chr(10))
    """
    root = folder / "project"
    root.mkdir()
    return write_project(
        root,
        MISSION,
        tests,
        configuration=CONFIGURATION + "rounds = 2\n",
        more={"conftest.py": head + conftest},
    )


def diary(common: Path) -> list[str]:
    return (common / "diary").read_text().splitlines()


def campaign(root: Path, engine: str = "fork") -> tuple[Quiet, dict[tuple[str, int], Verdict]]:
    progress = Quiet()
    path = run_campaign(request_for(root, engine=engine, only=("*:reverse",), fresh=True), progress)
    return progress, {(outcome.mutant, outcome.round): outcome.verdict for outcome in outcomes(path)}


@pytest.mark.whole
def test_program_is_imported_once_for_all_rounds_and_mutants_and_draws_the_same_in_both_engines(
    tmp_path: Path,
    common: Path,
) -> None:
    root = project(tmp_path, common, conftest="note(str(random.random()))")
    _, verdicts = campaign(root)
    once = diary(common)
    assert len(once) == 1
    (common / "diary").unlink()
    assert campaign(root, "replay")[1] == verdicts
    again = diary(common)
    assert len(again) > len(verdicts)
    assert set(again) == set(once)


@pytest.mark.whole
def test_tests_that_are_not_safe_to_fork_start_anew_and_that_is_reported(
    tmp_path: Path, common: Path
) -> None:
    waiting = "threading.Thread(target=threading.Event().wait, daemon=True, name='spinner').start()"
    root = project(tmp_path, common, conftest=f"note('imported')\n    {waiting}")
    progress, verdicts = campaign(root, "auto")
    assert any("each run starts anew" in line and "spinner" in line for line in progress.lines)
    assert set(verdicts.values()) == {Verdict.KILLED}
    assert len(diary(common)) > 2
    report = check(request_for(root), Quiet())
    assert report.data


def test_what_was_made_before_the_fork_lasts_for_all_runs_and_each_takes_it_down(
    tmp_path: Path,
    common: Path,
) -> None:
    root = project(
        tmp_path,
        common,
        conftest="""
    FOLDER = tempfile.TemporaryDirectory()
    atexit.register(note, "left")

    @pytest.fixture(autouse=True)
    def folder():
        assert os.path.isdir(FOLDER.name)
        note(FOLDER.name)

    def pytest_sessionfinish():
        note("finished")
    """,
    )
    _, verdicts = campaign(root)
    assert set(verdicts.values()) == {Verdict.KILLED}
    found = diary(common)
    # every run ends as if it had a process of its own: hooks and exit handlers may decide about its exit code
    assert found.count("finished") > 2
    assert found.count("left") == found.count("finished")
    (folder,) = set(found) - {"left", "finished"}
    assert not Path(folder).exists()


def test_what_a_run_makes_goes_with_it(tmp_path: Path, common: Path) -> None:
    root = project(
        tmp_path,
        common,
        conftest="""
    @pytest.fixture(autouse=True)
    def leaves():
        atexit.register(note, "left")
    """,
    )
    progress = Quiet()
    request = request_for(root, engine="fork")
    check(request, progress)
    found = diary(common)
    # two rounds of the original, the fork parent of the controls, the identity, and the control of the last
    # test, to which the end belongs
    assert found == ["left"] * 5


def test_no_run_finds_what_another_one_left_in_the_cache(tmp_path: Path, common: Path) -> None:
    root = project(
        tmp_path,
        common,
        conftest="""
    @pytest.fixture(autouse=True)
    def once(cache):
        assert cache.get("mutabot/seen", None) is None
        cache.set("mutabot/seen", os.getpid())
    """,
    )
    _, verdicts = campaign(root)
    assert set(verdicts.values()) == {Verdict.KILLED}


def test_output_of_a_run_does_not_mix_into_another_ones(tmp_path: Path, common: Path) -> None:
    tests = """
    import mission
    from robot import Arm

    def test_run(capfd):
        print("begin")
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.125
        assert capfd.readouterr().out == "begin\\n"
    """
    _, verdicts = campaign(project(tmp_path, common, conftest="print('imported')", tests=tests))
    assert set(verdicts.values()) == {Verdict.KILLED}


def test_death_of_the_process_that_collected_the_tests_is_a_clear_error(tmp_path: Path, common: Path) -> None:
    shot = """
    @pytest.fixture(autouse=True)
    def shot():
        if os.getpid() != HERE:
            os.kill(HERE, 9)
            time.sleep(60)  # a copy that is quick may be done before it is taken along
    """
    root = project(tmp_path, common, conftest="HERE = os.getpid()\n" + shot)
    with pytest.raises(BaselineError, match="killed by signal 9"):
        campaign(root)
    assert not list((root / ".mutabot").glob("work-*"))


@pytest.mark.whole
def test_interrupted_session_of_a_copy_ends_like_one_of_its_own(tmp_path: Path, common: Path) -> None:
    tests = TESTS.replace("arm = Arm()", "import pytest; pytest.exit('enough')")
    root = project(tmp_path, common, conftest="", tests=tests)
    texts = []
    for engine in ("fork", "replay"):
        with pytest.raises(MutabotError) as caught:
            campaign(root, engine)
        texts.append(str(caught.value))
    assert texts[0] == texts[1]


@pytest.mark.whole
def test_error_in_a_test_file_is_reported_as_without_sharing(tmp_path: Path, common: Path) -> None:
    root = project(tmp_path, common, conftest="", tests="import nothing_of_that_name")
    texts = []
    for engine in ("fork", "replay"):
        with pytest.raises(BaselineError, match="cannot be collected") as caught:
            campaign(root, engine)
        texts.append(str(caught.value))
    assert texts[0] == texts[1]
