"""Run the core's tests on an installed wheel from which the packages beside the core are deleted.

    python tools/core_alone.py [ARGUMENT …]      arguments for pytest; without any, all tests of the core

The environment is a new one: it sees what is installed here, but neither the sources nor a link to them.
Tests that need a package beside the core skip themselves (``needs`` in ``tests/conftest.py``).
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: tests of the packages themselves, of the examples, which drive the cell, and of the repository
NOT_OF_THE_CORE = (
    "tests/packages", "tests/examples", "tests/docs", "tests/benchmarks", "tests/test_architecture.py",
    "tests/test_release.py", "tests/test_recipes.py", "tests/plugins/test_operators_page.py",
    "tests/plugins/test_configuration_page.py",
)  # fmt: skip


def wheel_in(folder: Path) -> Path:
    """A wheel of the sources."""
    words = [
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--disable-pip-version-check",
        "--no-deps",
        "--no-build-isolation",
    ]
    subprocess.run([sys.executable, *words, "-w", str(folder), str(ROOT)], check=True)
    (found,) = folder.glob("*.whl")
    return found


def without_packages(folder: Path) -> Path:
    """A Python that has the core from a wheel, and what is installed here beside mutabot's own sources."""
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    place = subprocess.run(
        [str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    with zipfile.ZipFile(wheel_in(folder)) as wheel:
        wheel.extractall(place)
    for package in Path(place).glob("mutabot_*"):
        shutil.rmtree(package)
    # a path alone: files that link to the sources are not read there
    Path(place, "beside.pth").write_text(f"{sysconfig.get_path('purelib')}\n", encoding="utf-8")
    return python


def main(arguments: list[str]) -> int:
    """Run them; the exit code is that of pytest."""
    with tempfile.TemporaryDirectory() as place:
        python = without_packages(Path(place, "venv"))
        tests = Path(place, "project")
        tracked = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.split("\0")
        for name in filter(None, tracked):
            if not name.startswith("src/") and (ROOT / name).is_file():
                (tests / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, tests / name)
        ignored = [f"--ignore={name}" for name in NOT_OF_THE_CORE]
        words = [str(python), "-m", "pytest", "-p", "no:cacheprovider", *ignored, *arguments]
        environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
        return subprocess.run(words, cwd=tests, env=environment, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
