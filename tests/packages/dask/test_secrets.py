"""Secrets do not reach workers: what the processes of a real worker see, and what is said about it."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from mutabot.campaign.run import run_campaign
from mutabot.cli.app import app
from mutabot_dask.link import Link
from tests.campaign.project import Quiet, request_for

from .clusters import cluster, ends, on_cluster, run_twice, write

MISSION = "def run(arm):\n    arm.move_by(0.5)\n"
#: on a worker, which is marked, the test says what it can see; at home there is all of it
TESTS = """
    import os
    from pathlib import Path
    from mission import run
    from robot import Arm

    HERE = Path(__file__).parents[1]

    def seen():
        names = (".env", ".netrc", ".pypirc", "id_rsa", "key", "folder/key")
        files = [name for name in names if (HERE / name).exists()]
        return files + [name for name in os.environ if name.startswith(("LANGSMITH", "PYTHON_KEYRING"))]

    def test_run():
        arm = Arm()
        run(arm)
        if "OF_TEST_SECRETS" in os.environ and seen():
            raise RuntimeError(f"a worker sees {seen()}")
        assert arm.x < 0.9
"""
#: a test that needs a file that nobody has added to git
NEEDY = """
    from pathlib import Path
    from mission import run
    from robot import Arm

    def test_run():
        limit = float((Path(__file__).parents[1] / "limits.yaml").read_text())
        arm = Arm()
        run(arm)
        assert arm.x < limit
"""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A worker, as on another machine: it has none of our variables."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OF_TEST_SECRETS", "1")
        with cluster(tmp_path_factory.mktemp("dask"), 1) as found:
            patch.delenv("OF_TEST_SECRETS")
            yield found


def commit(folder: Path) -> None:
    own = ("git", "-c", "user.name=tests", "-c", "user.email=tests@localhost")
    for words in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "first"]):
        subprocess.run([*own, *words], cwd=folder, check=True, capture_output=True)


@pytest.mark.whole
def test_a_worker_sees_no_secret(address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("LANGSMITH_API_KEY", "PYTHON_KEYRING_PASSWORD"):
        monkeypatch.setenv(name, "hunter2")
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "key").write_text("hunter2")
    project = write(tmp_path / "project", mission=MISSION, tests=TESTS)
    (project / "key").symlink_to("../home/key")
    (project / "folder").symlink_to("../home")
    commit(project)
    for name in (".env", ".netrc", ".pypirc", "id_rsa"):
        (project / name).write_text("hunter2")
    asked = []
    ask = Link.ask
    monkeypatch.setattr(Link, "ask", lambda *given: asked.append(given[2].__name__) or ask(*given))
    plain, found, told = run_twice(project, address, engine="replay", only=("reverse",))
    assert found == plain
    assert "run_unit" in asked
    text = "\n".join(told.lines)
    assert "is not used" not in text, text
    assert "4 files that git does not track stay on this machine: .env, .netrc, .pypirc, id_rsa" in text
    assert "leads out of the project or cannot be read: folder, key" in text


@pytest.mark.whole
def test_a_file_that_tests_need_and_workers_lack_is_named(address: str, tmp_path: Path) -> None:
    project = write(tmp_path / "project", mission=MISSION, tests=NEEDY)
    commit(project)
    (project / "limits.yaml").write_text("0.9")
    request = request_for(project, engine="replay", only=("reverse",))
    plain = ends(run_campaign(request, Quiet()))
    told = Quiet()
    found = ends(run_campaign(on_cluster(request, address), told))
    assert found == plain  # what a worker lacks is never a kill
    lines = told.lines
    lacking = [line for line in lines if line.startswith("tests open files that workers will not have: ")]
    assert "limits.yaml" in lacking[0]
    assert "`git add` what workers need, or name it under `cluster.files`" in lacking[0]
    assert lines.index(lacking[0]) < next(
        at for at, line in enumerate(lines) if line.startswith("workers are sent ")
    )
    assert any("is not used: " in line and "limits.yaml" in line for line in lines), lines

    with (project / "mutabot.toml").open("a") as file:
        file.write('\n[cluster]\nfiles = ["*.yaml"]\n')
    told = Quiet()
    request = request_for(project, engine="replay", only=("reverse",))
    assert ends(run_campaign(on_cluster(request, address), told)) == plain
    assert not any("limits.yaml" in line for line in told.lines), told.lines


def test_check_lists_what_workers_would_be_sent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LANGSMITH_API_KEY", "hunter2")
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    project = write(tmp_path / "project", mission=MISSION, tests=NEEDY)
    (project / "server.key").write_text("")
    (project / "mutabot.toml").write_text(
        (project / "mutabot.toml").read_text() + '\n[cluster]\nfiles = ["server.key"]\n'
    )
    commit(project)
    for name in ("limits.yaml", ".env"):
        (project / name).write_text("0.9")
    done = CliRunner().invoke(app, ["-C", os.fspath(project), "check"])
    lines = [line for line in done.output.splitlines() if line.startswith("cluster ")]
    text = "\n".join(lines)
    assert "workers are sent 6 files, " in text, done.output
    assert " LC_ALL," in text
    assert "LANGSMITH" not in done.output
    assert "2 files that git does not track stay on this machine: .env, limits.yaml" in text
    assert "named like a secret, since git tracks it, or `cluster.files` names it: server.key" in text
    assert "tests open files that workers will not have: limits.yaml" in text
    data = json.loads(CliRunner().invoke(app, ["-C", os.fspath(project), "check", "--json"]).stdout)
    assert data["cluster"]["left_out"] == [".env", "limits.yaml"]
    assert data["cluster"]["opened_but_left_out"] == ["limits.yaml"]
    assert "hunter2" not in json.dumps(data)
