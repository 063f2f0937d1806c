"""Which reads of program text count: those after which somebody has it as text."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.plugins.test_faults import write

#: each reads the program in its way, in a function of its own
READERS = """
    import codecs, importlib.util, importlib.resources, inspect, linecache, logging, os, pkgutil
    import py_compile, runpy, shutil, subprocess, sys, tokenize, traceback, zipfile
    from pathlib import Path

    HERE = Path(__file__).parent
    PROGRAM = HERE / "mission.py"

    def imports():
        import mission
    def imports_by_its_place():
        spec = importlib.util.spec_from_file_location("other", PROGRAM)
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
    def runs():
        runpy.run_path(str(PROGRAM))
    def fails():
        import mission
        try:
            mission.fail()
        except ValueError:
            assert "raise" in traceback.format_exc()
            logging.getLogger("x").exception("it fails")
    def writes():
        with open(PROGRAM, "ab"):
            pass
    def reads():
        PROGRAM.read_text()
    def opens():
        open(PROGRAM, "rb").read()
    def opens_a_descriptor():
        os.close(os.open(PROGRAM, os.O_RDONLY))
    def opens_with_tokenize():
        tokenize.open(PROGRAM).read()
    def opens_with_codecs():
        codecs.open(PROGRAM).read()
    def gets_source():
        import mission
        inspect.getsource(mission.fail)
    def gets_lines():
        linecache.getline(str(PROGRAM), 1)
    def gets_source_of_a_traceback():
        fails()
        gets_source()
    def asks_its_loader():
        importlib.util.find_spec("mission").loader.get_source("mission")
    def asks_for_data():
        pkgutil.get_data("package", "part.py")
    def asks_for_a_resource():
        importlib.resources.files("package").joinpath("part.py").read_text()
    def copies():
        shutil.copy(PROGRAM, HERE / "copied.txt")
    def copies_everything():
        shutil.copytree(HERE / "package", HERE / "other")
    def compiles():
        py_compile.compile(str(PROGRAM), str(HERE / "compiled.pyc"))
    def has_it_copied():
        subprocess.run(["cp", PROGRAM, HERE / "copied.txt"], check=True)
    def has_it_searched():
        subprocess.check_output(["grep", "raise", "mission.py"], cwd=HERE)
    def asks_a_shell():
        os.system("sed s/fail/pass/ mission.py > other.txt")
    def asks_a_shell_for_all():
        subprocess.run("cat package/p*.py > other.txt", shell=True, cwd=HERE, check=True)
    def starts_python():
        subprocess.run([sys.executable, "mission.py"], cwd=HERE, check=True)
    def starts_a_python_apart():
        subprocess.run([sys.executable, "-S", "mission.py"], cwd=HERE, check=True)
    def starts_a_module_apart():
        subprocess.run([sys.executable, "-S", "-m", "mission"], cwd=HERE, check=True)
    def starts_a_line_apart():
        code = "import sys; sys.path.insert(0, ''); import mission; mission.fail"
        subprocess.run([sys.executable, "-I", "-c", code], cwd=HERE, check=True)
    def has_a_python_started_apart():
        os.system(f"{sys.executable} -S mission.py")
    def starts_a_script_that_starts_a_python_apart():
        (HERE / "run.sh").write_text(f"PYTHONPATH=lib {sys.executable} mission.py")
        subprocess.run(["sh", "run.sh"], cwd=HERE, check=True)
    def starts_python_without_the_campaigns_environment():
        os.waitpid(os.posix_spawn(sys.executable, ["python", "mission.py"], {}), 0)
    def has_python_started():
        os.system(f"{sys.executable} mission.py")
    def starts_the_file():
        os.chmod(HERE / "command.py", 0o755)
        subprocess.run([HERE / "command.py"], check=True)
        subprocess.run("./command.py", shell=True, cwd=HERE, check=True)
    def starts_what_is_no_command():
        try:
            subprocess.run([1])
        except TypeError as error:
            assert "not int" in str(error)
    def packs():
        zipfile.ZipFile(HERE / "packed.zip", "w").write(PROGRAM)
"""
#: what one has read no other knows
MAIN = """
    import json, os, sys
    import readers
    from mutabot.runtime.text_reads import TextReads

    for name in sys.argv[2:]:
        if os.fork() == 0:
            told = set()
            TextReads(sys.argv[1], lambda name, is_text: told.add(name) if is_text else None).install()
            getattr(readers, name)()
            print(json.dumps([name, sorted(told)]), flush=True)
            os._exit(0)
        os.wait()
"""
NONE = (
    "imports", "imports_by_its_place", "runs", "fails", "writes", "starts_python", "has_python_started",
    "starts_the_file", "starts_what_is_no_command",
)  # fmt: skip
OF_PACKAGE = ("asks_for_data", "asks_for_a_resource", "copies_everything", "asks_a_shell_for_all")


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """What each of the readers reads as text."""
    files = {
        "mission.py": "def fail():\n    raise ValueError\n",
        "package/__init__.py": "",
        "package/part.py": "",
        "command.py": "#!/bin/sh\n",
        "readers.py": READERS,
        "main.py": MAIN,
    }
    folder = write(tmp_path_factory.mktemp("reads"), files)
    names = [line.split()[1].removesuffix("():") for line in READERS.splitlines() if " def " in line]
    done = subprocess.run(
        [sys.executable, "main.py", str(folder), *names],
        cwd=folder,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return dict(map(json.loads, done.stdout.splitlines()))


def test_imports_and_what_shows_lines_read_no_text(found: dict[str, list[str]]) -> None:
    assert {name: found[name] for name in NONE} == {name: [] for name in NONE}


def test_whatever_else_reads_has_the_text(found: dict[str, list[str]]) -> None:
    others = {name: read for name, read in found.items() if name not in NONE}
    wanted = {name: ["package/part.py"] if name in OF_PACKAGE else ["mission.py"] for name in others}
    wanted["copies_everything"] = ["package/__init__.py", "package/part.py"]
    assert len(others) == 25
    assert others == wanted


def test_the_script_that_an_interpreter_runs_is_read_by_nobody(tmp_path: Path) -> None:
    """It is opened before there is any frame, by an interpreter whose start has joined a campaign."""
    start = """
        import atexit
        from mutabot.runtime.text_reads import TextReads

        told = []
        TextReads({root!r}, lambda name, is_text: told.append((name, is_text))).install()
        atexit.register(lambda: print([name for name, is_text in told if is_text]))
    """
    script = "import mission\nprint('it runs')\nopen(mission.__file__).close()\n"
    folder = write(tmp_path / "project", {"mission.py": "", "drive.py": script})
    home = write(tmp_path / "start", {"sitecustomize.py": start.format(root=str(folder))})
    done = subprocess.run(
        [sys.executable, "drive.py"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(home)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines() == ["it runs", "['mission.py']"], done.stderr
