import importlib.util
import os
import runpy
import shutil
import subprocess
import sys
import zipapp
import zipfile

import mission

SAID = "0.25 30 3\n"


def test_the_program_says_something(capsys):
    mission.main()
    assert len(capsys.readouterr().out.split()) == 3


def test_a_zipapp(tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    for name in ("mission.py", "robot.py"):
        shutil.copy(name, source)
    zipapp.create_archive(source, tmp_path / "app.pyz", main="mission:main")
    assert subprocess.check_output([sys.executable, tmp_path / "app.pyz"], text=True) == SAID


def test_a_module_under_another_name(tmp_path, capsys):
    path = shutil.copy2("mission.py", tmp_path / "other.py")
    spec = importlib.util.spec_from_file_location("other", path)
    other = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(other)
    other.main()
    assert capsys.readouterr().out.startswith("0.25")


def test_a_script_that_another_program_has_copied(tmp_path):
    subprocess.run(["cp", "mission.py", "robot.py", tmp_path], check=True)
    assert subprocess.check_output([sys.executable, "mission.py"], cwd=tmp_path, text=True) == SAID


def test_a_module_in_a_zip_file(tmp_path, monkeypatch, capsys):
    with zipfile.ZipFile(tmp_path / "cell.zip", "w") as archive:
        archive.write("mission.py", "cell/zipped.py")
        archive.writestr("cell/__init__.py", "")
    monkeypatch.syspath_prepend(tmp_path / "cell.zip")
    from cell import zipped

    zipped.main()
    assert " 30 " in capsys.readouterr().out


def test_a_hard_link(tmp_path, capsys):
    os.link("mission.py", tmp_path / "linked.py")
    runpy.run_path(str(tmp_path / "linked.py"), run_name="__main__")
    assert capsys.readouterr().out == SAID
