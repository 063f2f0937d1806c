"""A session of pytest that a test starts in its own process is none of the job's."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from mutabot.runtime import pytest_plugin

INNER = """
    import pytest

    @pytest.fixture(scope="module")
    def shared(mutabot_seed):
        return mutabot_seed

    def test_seeds(shared, mutabot_seed):
        assert shared == mutabot_seed == 0
"""


@pytest.fixture
def hooks(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """The hooks of a job whose session is this one; whatever is asked of them fails."""
    hooks = SimpleNamespace(config=object())
    monkeypatch.setattr(pytest_plugin, "_hooks", hooks)
    return hooks


def run(folder: Path, **texts: str) -> int:
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text.replace("\n    ", "\n"), encoding="utf-8")
    arguments = ["-q", "-p", "no:cacheprovider", "--rootdir", str(folder), str(folder)]
    return int(pytest.main(arguments, plugins=[pytest_plugin]))


@pytest.mark.usefixtures("hooks")
def test_its_tests_run_as_they_do_without_a_job(tmp_path: Path) -> None:
    assert run(tmp_path, test_inner=INNER) == 0


@pytest.mark.usefixtures("hooks")
def test_what_goes_wrong_in_it_is_for_its_test_to_judge(tmp_path: Path) -> None:
    assert (
        run(tmp_path, conftest="raise RuntimeError('no robot')\n", test_broken="")
        == pytest.ExitCode.USAGE_ERROR
    )
