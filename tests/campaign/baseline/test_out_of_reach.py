"""A test that starts the program where no mutant acts is no judge: what it lets through is not survived."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.out_of_reach import files_out_of_reach
from mutabot.campaign.run import run_campaign
from mutabot.faults import PlannedMutant
from mutabot.journal.journal import Journal
from mutabot.languages.imported_names import imported_names
from mutabot.model import Mutant, Verdict
from mutabot.model.activation import Activation
from mutabot.model.events import OutOfReach, TestEnd
from mutabot.model.mutant import Place, Site
from tests.campaign.project import REPLAY, Quiet, request_for, write_project

MISSION = """
    from robot import Arm

    def go():
        arm = Arm()
        arm.move_by(0.5)
        return arm.x

    if __name__ == "__main__":
        print(go())
"""
TESTS = """
    import subprocess
    import sys
    from pathlib import Path

    import mission

    HERE = str(Path(mission.__file__).parent)

    def script(folder):
        lines = [f"#!{sys.executable} -I", f"import sys; sys.path.insert(0, {HERE!r})", "import mission"]
        (folder / "cell").write_text("\\n".join(lines))
        (folder / "cell").chmod(0o755)
        return str(folder / "cell")

    def test_here():
        assert mission.go() is not None

    def test_there(tmp_path):  # its files are gone when it has ended
        command = {command}
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
"""


NESTED = "import subprocess, sys; subprocess.run([sys.executable, '-I', 'mission.py'])"
OUT_OF_REACH = {
    "env": '["env", "-i", sys.executable, "mission.py"]',
    "shell": '["sh", "-c", f"{sys.executable} -S -c \'import mission; mission.go()\'"]',
    "make": '["make", "-s", "go", f"PY={sys.executable}"]',
    "script": "[script(tmp_path)]",
    "a process that does not run the program": f"[sys.executable, '-c', {NESTED!r}]",
}
OTHERS = {
    "it runs nothing of the program": '[sys.executable, "-S", "-c", "pass"]',
    "the mutant acts there": '[sys.executable, "mission.py"]',
}


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize(
    "name",
    [
        name
        if name in ("env", "it runs nothing of the program")
        else pytest.param(name, marks=pytest.mark.whole)
        for name in OUT_OF_REACH | OTHERS
    ],
)
def test_what_a_process_out_of_reach_may_notice_is_not_survived(
    tmp_path: Path, name: str, engine: str
) -> None:
    folder = write_project(tmp_path, MISSION, TESTS.replace("{command}", (OUT_OF_REACH | OTHERS)[name]))
    (folder / "Makefile").write_text("go:\n\tenv -i $(PY) mission.py\n")
    path = run_campaign(request_for(folder, engine=engine, only=("skip",)), Quiet())
    with Journal.open(path) as journal:
        (outcome,) = journal.outcomes()
    assert outcome.verdict is (Verdict.UNSTABLE if name in OUT_OF_REACH else Verdict.SURVIVED)
    assert ("test_there might have failed" in (outcome.message or "")) is (name in OUT_OF_REACH)


@pytest.mark.needs("source")
@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize("asserted", ["", "; assert got"])
def test_a_mutant_of_the_text_is_judged_there_as_well(tmp_path: Path, asserted: str, engine: str) -> None:
    command = "subprocess.run([sys.executable, '-S', 'mission.py'], stdout=-1, text=True).stdout"
    before, _, _ = TESTS.partition("    def test_there")
    tests = f'{before}    def test_there():\n        got = {command} == "0.5\\n"{asserted}\n'
    folder = write_project(tmp_path, MISSION, tests)
    request = request_for(
        folder, engine=engine, families=("conventional",), only=("mission.py:go:arm.x#*neg",)
    )
    with Journal.open(run_campaign(request, Quiet())) as journal:
        verdicts = {outcome.verdict for outcome in journal.outcomes()}
    assert verdicts == {Verdict.KILLED if asserted else Verdict.SURVIVED}


@pytest.mark.parametrize(
    ("named", "found"),
    [
        (("run.py",), {"cell/__init__.py", "cell/arm.py"}),
        (("cell/arm.py",), {"cell/arm.py"}),
        (("other.py",), {"other.py"}),
        (("loads.py",), {"cell/__init__.py", "cell/arm.py", "other.py"}),
        (("tools/start.py",), {"cell/__init__.py", "cell/arm.py"}),
        ((), set()),
        (None, {"cell/__init__.py", "cell/arm.py", "other.py"}),
    ],
)
def test_a_process_may_run_the_files_that_those_it_names_import(
    tmp_path: Path, named: tuple[str, ...] | None, found: set[str]
) -> None:
    texts = {
        "run.py": "import cell.arm",
        "tools/__init__.py": "",
        "loads.py": "from importlib import import_module",
        "cell/__init__.py": "from .arm import go",
        "cell/arm.py": "import math",
        "other.py": "",
        "tools/start.py": "from tools.steps import run",  # neither this nor the next is of the program
        "tools/steps.py": "import run",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    files = None if named is None else tuple(str(tmp_path / name) for name in named)
    imports = tuple(name for file in named or () for name in imported_names(texts[file].encode()))
    process = OutOfReach("env -i python", "env clears its environment", files, imports)
    ends = [TestEnd("test_a", "passed", out_of_reach=(process,)), TestEnd("test_b", "passed")]
    ran = files_out_of_reach(tmp_path, ["cell", "other.py"], ends)
    assert {*ran["test_a"]} == found
    assert "test_b" not in ran


@pytest.mark.parametrize(("of_tests", "missing"), [(True, {"test_a"}), (False, {"test_a", "test_b"})])
def test_a_fault_of_the_world_does_not_act_in_such_a_process(of_tests: bool, missing: set[str]) -> None:
    """One of which nothing is left after a test misses the processes of the tests that reach it alone."""
    site = Site.of_parameter("test_a", "gravity")
    mutant = Mutant(1, "world", "disturb", site, "", None, None, "+", "")
    suite = ("test_a", "test_b", "test_c")
    found = {"mission.py": "env -i python (env clears its environment)"}
    baseline = Baseline(
        tests=[list(suite)],
        ends={(0, test): TestEnd(test, "passed") for test in suite},
        reaching={(0, Place.of(mutant)): ("test_a", "test_c")},
        out_of_reach={(0, "test_a"): found, (0, "test_b"): found},
    )
    baseline.faults.add(PlannedMutant(mutant, active=Activation("cell:Fault", is_of_tests=of_tests)))
    assert baseline.missing_judges(0, mutant).keys() == missing
