"""Make a virtual environment beside this one that has all that this one has, and takes more.

ROS 1 and ROS 2 have Python packages of equal names, so each gets an environment of its own.

    python tools/beside.py .venv-ros2
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import venv
from pathlib import Path


def main(folder: Path) -> None:
    """Make it, or make it anew."""
    venv.create(folder, clear=True, symlinks=True)
    place = subprocess.run(
        [str(folder / "bin" / "python"), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    ours = sysconfig.get_path("purelib")
    Path(place, "beside.pth").write_text(f"import site; site.addsitedir({ours!r})\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
