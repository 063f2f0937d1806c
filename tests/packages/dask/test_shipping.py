"""What leaves the machine: what git tracks and the configuration names, and never what lies elsewhere."""

from __future__ import annotations

import io
import os
import subprocess
import tarfile
from pathlib import Path

import pytest

from mutabot.errors import ConfigurationError, UsageError
from mutabot_dask.bundle import Bundle, warnings
from mutabot_dask.environment import decided
from mutabot_dask.shipping import Shipment, may_be_secret
from tests.campaign.project import write_project

from .clusters import shipment_of

#: stands in each file that nobody may see
SECRET = b"hunter2-do-not-ship"
PRIVATE = (
    ".env", ".netrc", ".pypirc", "id_rsa", "notes.txt", "data/table.local.json", "tests/.env",
    "tests/credentials.json", "tests/local_settings.py", ".ssh/id_ed25519", "prod.env",
)  # fmt: skip


def git(folder: Path, *words: str) -> None:
    own = ("-c", "user.name=tests", "-c", "user.email=tests@localhost", "-c", "protocol.file.allow=always")
    subprocess.run(["git", *own, *words], cwd=folder, check=True, capture_output=True)


def put(folder: Path, *names: str, content: bytes = b"") -> None:
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def committed(folder: Path, *names: str) -> Path:
    """A project in a repository, with the secrets beside what is committed."""
    write_project(folder, "def run(arm):\n    arm.move_by(0.5)\n", "def test_run():\n    pass\n")
    put(folder, "data/table.json", "tests/conftest.py", *names)
    put(folder, ".gitignore", content=b"local_settings.py\n")
    if not any((above / ".git").exists() for above in (folder, *folder.parents)):
        git(folder, "init", "-q")
    git(folder, "add", "-A", ".")
    git(folder, "commit", "-qm", "first")
    put(folder, *PRIVATE, content=SECRET)
    return folder


def members(bundle: Bundle) -> dict[str, tuple[tarfile.TarInfo, bytes]]:
    """Everything in a bundle, as a worker would read it."""
    with tarfile.open(fileobj=io.BytesIO(bundle.data)) as tar:
        files = (
            (member, tar.extractfile(member) if member.isfile() else None) for member in tar.getmembers()
        )
        return {member.name: (member, file.read() if file is not None else b"") for member, file in files}


def sent(folder: Path) -> dict[str, tuple[tarfile.TarInfo, bytes]]:
    """What is sent of a project, by name in it; fails if a secret is."""
    bundle = Bundle.make(shipment_of(folder))
    found = members(bundle)
    assert not [name for name, (_, content) in found.items() if SECRET in content]
    assert SECRET not in bundle.data
    return {os.path.relpath(name, bundle.inner): value for name, value in found.items()}


def configured(folder: Path, files: str) -> Shipment:
    text = (folder / "mutabot.toml").read_text() + f"\n[cluster]\nfiles = {files}\n"
    (folder / "mutabot.toml").write_text(text)
    return shipment_of(folder)


def test_what_git_tracks_is_sent_and_nothing_else(tmp_path: Path) -> None:
    project = committed(tmp_path / "cell", "assets/gripper.stl", ".coveragerc")
    (project / "mission.py").write_text("edited = True\n")
    (project / "data" / "table.json").unlink()
    found = sent(project)
    assert found["mission.py"][1] == b"edited = True\n"
    assert {name for name, (info, _) in found.items() if not info.isdir()} == {
        ".coveragerc", ".gitignore", "assets/gripper.stl", "mission.py", "robot.py", "robot.toml",
        "mutabot.toml", "tests/conftest.py", "tests/test_mission.py",
    }  # fmt: skip
    assert found["data"][0].isdir()  # tests may write there


def test_what_the_configuration_names_is_sent_also_where_git_does_not_track_it(tmp_path: Path) -> None:
    project = committed(tmp_path / "cell")
    put(
        project, "tests/test_new.py", "lib/new.py", "data/a.json", "data/b.json", "data/.hidden", "maps/x.bin"
    )
    (project / "mutabot.toml").write_text(
        'program = ["mission.py", "lib"]\nvocabulary = ["robot.toml", "more.toml"]\n'
        'pytest_args = ["-c", "strange.ini"]\n'
    )
    put(project, "more.toml", "strange.ini")
    shipment = configured(project, '["data/[ab].json", "maps"]')
    names = {path.relative_to(project).as_posix() for path in shipment.files}
    assert names >= {
        "tests/test_new.py", "lib/new.py", "more.toml", "strange.ini", "data/a.json", "data/b.json",
        "maps/x.bin",
    }  # fmt: skip
    assert not names & set(PRIVATE)
    assert set(shipment.left_out) >= {".env", ".netrc", ".pypirc", "id_rsa", "tests/local_settings.py"}
    found = members(Bundle.make(shipment))
    assert not [name for name, (_, content) in found.items() if SECRET in content]


def test_a_secret_that_is_named_is_sent_and_that_is_said(tmp_path: Path) -> None:
    project = committed(tmp_path / "cell", "tests/keys/server.key")
    git(project, "add", "-f", "prod.env")
    git(project, "commit", "-qm", "oh")
    shipment = configured(project, '[".netrc"]')
    assert shipment.suspicious == (".netrc", "prod.env", "tests/keys/server.key")
    text = "\n".join(warnings(shipment, Bundle.make(shipment)))
    assert "sent though it is named like a secret" in text
    assert ".netrc, prod.env, tests/keys/server.key" in text


@pytest.mark.parametrize(
    ("name", "is_one"),
    [
        (".env", True), (".env.local", True), ("a/.netrc", True), ("id_rsa", True), ("x/id_rsa.pub", False),
        ("credentials.json", True), ("aws-credentials", True), ("tls/server.key", True),
        ("secrets.yaml", True), (".env.example", False), ("keyboard.py", False), ("tokens.py", False),
        ("environment.yml", False),
        (".ssh/config", True), ("secretary.py", False), ("robot_secret.toml", True),
    ],
)  # fmt: skip
def test_names_of_secrets(name: str, is_one: bool) -> None:
    assert may_be_secret(name) is is_one


def test_a_link_is_never_followed_out_of_the_project(tmp_path: Path) -> None:
    put(tmp_path, "home/key", "home/folder/key", content=SECRET)
    cell = tmp_path / "cell"
    cell.mkdir()
    for name, target in {
        "out": "../home/key",
        "out_absolute": str(tmp_path / "home" / "key"),
        "folder_out": "../home/folder",
        "dots": "data/../../home/key",
        "two": "one",
        "one": "../home/key",
        "loop": "loop",
        "inside": "data/table.json",
        "inside_absolute": str(cell / "data" / "table.json"),
        "folder_inside": "data",
        "to_a_secret": ".env",
    }.items():
        (cell / name).symlink_to(target)
    project = committed(cell, "real/key")
    (project / "real" / "key").unlink()
    (project / "real").rmdir()
    (project / "real").symlink_to("../home/folder")  # git tracks real/key, which is now a file elsewhere
    shipment = shipment_of(project)
    bundle = Bundle.make(shipment)
    found = sent(project)
    links = {name: info.linkname for name, (info, _) in found.items() if info.issym()}
    assert links == {
        "inside": "data/table.json", "inside_absolute": "data/table.json", "folder_inside": "data",
        "to_a_secret": ".env",  # it leads nowhere there
    }  # fmt: skip
    assert set(bundle.outside) == {
        "out",
        "out_absolute",
        "folder_out",
        "dots",
        "one",
        "two",
        "loop",
        "real/key",
    }
    assert any("leads out of the project" in text for text in warnings(shipment, bundle))
    place = tmp_path / "there"
    with tarfile.open(fileobj=io.BytesIO(bundle.data)) as tar:
        tar.extractall(place, filter="data")
    assert (place / "cell" / "folder_inside" / "table.json").is_file()


def test_a_file_that_becomes_a_link_while_it_is_packed_is_not_followed(tmp_path: Path) -> None:
    put(tmp_path, "home/key", content=SECRET)
    project = committed(tmp_path / "cell")
    shipment = shipment_of(project)
    (project / "mission.py").unlink()
    (project / "mission.py").symlink_to("../home/key")
    (project / "data" / "table.json").unlink()
    (project / "data" / "table.local.json").unlink()
    (project / "data").rmdir()
    put(tmp_path, "home/data/table.json", content=SECRET)
    (project / "data").symlink_to("../home/data")
    bundle = Bundle.make(shipment)
    assert set(bundle.outside) == {"mission.py", "data/table.json"}
    assert not [name for name, (_, content) in members(bundle).items() if SECRET in content]


def test_a_pipe_in_the_place_of_a_file_is_not_waited_for(tmp_path: Path) -> None:
    project = committed(tmp_path / "cell")
    shipment = shipment_of(project)
    (project / "robot.py").unlink()
    os.mkfifo(project / "robot.py")
    assert Bundle.make(shipment).outside == ("robot.py",)


def test_a_project_in_a_folder_of_a_repository_sends_nothing_of_the_others(tmp_path: Path) -> None:
    top = tmp_path / "repository"
    put(top, "pytest.ini", "others/key.py", "conftest.py")
    put(tmp_path, "setup.cfg", content=SECRET)
    git(tmp_path, "init", "-q", "repository")
    project = committed(top / "robots" / "cell")
    git(top, "add", "-A", "pytest.ini", "others")
    git(top, "commit", "-qm", "top")
    put(top, "conftest.py", "tox.ini", content=SECRET)  # not tracked
    found = sent(project)
    above = {name for name in found if name.startswith("..")}
    assert above == {"../../pytest.ini"}


def test_names_of_any_bytes_and_submodules_are_sent(tmp_path: Path) -> None:
    other = tmp_path / "other"
    put(other, "inner.py")
    git(tmp_path, "init", "-q", "other")
    git(other, "add", "-A")
    git(other, "commit", "-qm", "first")
    project = committed(tmp_path / "cell")
    odd = os.fsdecode(b"data/\xff \n'\".csv")
    put(project, odd)
    git(project, "add", "--", odd)
    git(project, "submodule", "add", "-q", str(other), "sub")
    git(project, "commit", "-qm", "second")
    put(project, "sub/.env", content=SECRET)
    found = sent(project)
    assert {odd, "sub/inner.py"} <= found.keys()
    place = tmp_path / "there"
    with tarfile.open(fileobj=io.BytesIO(Bundle.make(shipment_of(project)).data)) as tar:
        tar.extractall(place, filter="data")
    assert (place / "cell" / odd).is_file()


def test_without_a_repository_program_text_and_the_files_of_robots_are_sent(tmp_path: Path) -> None:
    project = write_project(tmp_path / "cell", "x = 1\n", "", more={"arm.urdf": "", "tests/task.feature": ""})
    put(project, *set(PRIVATE) - {"tests/local_settings.py"}, "config.yaml", "settings.json", content=SECRET)
    shipment = shipment_of(project)
    assert not shipment.is_tracked
    names = {path.relative_to(project).as_posix() for path in shipment.files}
    assert names == {
        "arm.urdf", "mission.py", "robot.py", "robot.toml", "mutabot.toml", "tests/test_mission.py",
        "tests/task.feature",
    }  # fmt: skip
    text = "\n".join(warnings(shipment, Bundle.make(shipment)))
    assert "there is no repository" in text
    assert "config.yaml" in text
    assert "settings.json" in {path.name for path in configured(project, '["settings.json"]').files}


def test_a_repository_that_git_refuses_is_not_guessed_at(tmp_path: Path) -> None:
    project = write_project(tmp_path / "cell", "x = 1\n", "")
    put(project, ".git/config")
    with pytest.raises(UsageError, match="the files that git tracks cannot be listed: git says: "):
        shipment_of(project)


def test_variables_of_a_hook_do_not_name_another_repository(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = committed(tmp_path / "cell")
    other = committed(tmp_path / "other", "of_other.py")
    monkeypatch.setenv("GIT_DIR", str(other / ".git"))
    monkeypatch.setenv("GIT_WORK_TREE", str(other))
    monkeypatch.setenv("GIT_INDEX_FILE", str(other / ".git" / "index"))
    assert "mission.py" in sent(project)
    assert "of_other.py" not in sent(project)


@pytest.mark.parametrize(
    ("files", "why"),
    [
        ('["../key"]', "leads out of the project's folder"),
        ('["/etc/passwd"]', "must be relative to the project's folder"),
        ('["out"]', "leads out of the project's folder"),
        ('["robt.toml"]', "there is no 'robt.toml'; did you mean 'robot.toml'?"),
        ('["*.nothing"]', "matches nothing"),
        ("7", "cluster.files"),
    ],
)
def test_files_for_workers_are_in_the_project(tmp_path: Path, files: str, why: str) -> None:
    project = write_project(tmp_path / "cell", "x = 1\n", "")
    put(tmp_path, "key", content=SECRET)
    (project / "out").symlink_to("../key")
    with pytest.raises(ConfigurationError, match=why.replace("?", r"\?").replace("*", r"\*")):
        configured(project, files)


def test_variables_are_sent_by_their_whole_names(monkeypatch: pytest.MonkeyPatch) -> None:
    secret = {
        "LANGSMITH_API_KEY", "LANGUAGE_TOKEN", "LC_SECRET", "TZ_TOKEN", "PYTHON_KEYRING_PASSWORD",
        "PYTEST_TOKEN", "PYTHONPATH_TOKEN", "MUJOCO_GL_KEY", "AWS_SECRET_NUM_THREADS",
    }  # fmt: skip
    for name in (*secret, "LANG", "LC_ALL", "TZ", "PYTHONWARNINGS", "PYTEST_ADDOPTS", "OMP_NUM_THREADS"):
        monkeypatch.setenv(name, "x")
    found = {name for name, value in decided().items() if value is not None}
    assert not found & secret
    assert found >= {"LANG", "LC_ALL", "TZ", "PYTHONWARNINGS", "PYTEST_ADDOPTS", "OMP_NUM_THREADS"}
