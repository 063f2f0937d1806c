"""Tests that read program text, and do not import it, see mutants as if somebody had edited the file."""

from __future__ import annotations

import pytest

from mutabot.model import Outcome, Verdict
from tests.campaign.project import no_private_files, run
from tests.plugins.test_faults import write

pytestmark = [
    pytest.mark.needs("source"),
    pytest.mark.skipif(
        no_private_files() is not None, reason="files cannot be changed for one process alone"
    ),
]

PROGRAM = """
    def limited(x):
        return x * 2

    def idle(x):
        return x * 2
"""
PROJECT = {
    "mutabot.toml": """
        program = ["in_process.py", "below.py", "copied.py", "reloaded.py", "early.py", "only_imported.py"]
        tests = ["tests"]
        families = ["conventional"]
        """,
    "in_process.py": PROGRAM,
    "below.py": PROGRAM,
    "copied.py": PROGRAM,
    "reloaded.py": PROGRAM,
    "early.py": PROGRAM,
    "only_imported.py": PROGRAM,
    "tests/test_it.py": """
        import importlib
        import inspect
        import shutil
        import subprocess
        import sys
        import traceback
        from pathlib import Path

        import below
        import copied
        import early
        import in_process
        import only_imported
        import reloaded

        HERE = Path(__file__).parents[1]
        EARLY = (HERE / "early.py").read_text()
        CODE = "s = {}; exec(open('below.py').read(), s); print(s['limited'](3), s['idle'](3))"

        def test_imports():
            for module in (below, copied, early, in_process, only_imported, reloaded):
                assert module.limited(2) == 4
                assert len(traceback.format_stack()) > 1

        def test_reads():
            space = {}
            exec(inspect.getsource(in_process), space)
            assert (space["limited"](3), space["idle"](3)) == (6, 6)

        def test_reads_below():
            done = subprocess.run([sys.executable, "-c", CODE], cwd=HERE, capture_output=True, text=True)
            assert done.stdout.split() == ["6", "6"]

        def test_copies(tmp_path, monkeypatch):
            shutil.copy(HERE / "copied.py", tmp_path / "other.py")
            monkeypatch.syspath_prepend(tmp_path)
            other = importlib.import_module("other")
            assert (other.limited(3), other.idle(3)) == (6, 6)

        def test_reloads():
            assert reloaded.limited(2) == 4
            assert "limited" in Path(reloaded.__file__).read_text()
            importlib.reload(reloaded)
            assert (reloaded.limited(3), reloaded.idle(3)) == (6, 6)

        def test_has_read():
            space = {}
            exec(EARLY, space)
            assert (space["limited"](3), space["idle"](3)) == (6, 6)
        """,
}
#: what stands for ``x * 2`` in each function
POWER = "AOR=pow"


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    """The outcomes of mutants that square, which the test that imports lets through, by file and function."""
    folder = write(tmp_path_factory.mktemp("texts"), PROJECT)
    ran = run(folder, families=("conventional",), only=(f"*{POWER}",), engine="auto")
    return {":".join(name.split(":")[:2]): outcome for name, outcome in ran.items()}


@pytest.mark.parametrize(
    ("file", "test", "engine"),
    [
        ("in_process", "test_reads", "fork"),
        ("below", "test_reads_below", "fork"),
        ("copied", "test_copies", "fork"),
        ("reloaded", "test_reloads", "fork"),
        ("early", "test_has_read", "replay"),  # it is read before any process can be forked
    ],
)
def test_who_reads_the_text_notices_a_mutant(
    found: dict[str, Outcome], file: str, test: str, engine: str
) -> None:
    for function in ("limited", "idle"):
        outcome = found[f"{file}.py:{function}"]
        assert (outcome.verdict, outcome.test) == (Verdict.KILLED, f"tests/test_it.py::{test}")
        assert outcome.engine == engine


def test_a_file_that_is_only_imported_is_judged_as_ever(found: dict[str, Outcome]) -> None:
    assert found["only_imported.py:idle"].verdict is Verdict.NOT_COVERED
    outcome = found["only_imported.py:limited"]
    assert (outcome.verdict, outcome.engine) == (Verdict.NO_EFFECT, "fork")
