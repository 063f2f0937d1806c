"""Write the hashes of all files of each release into the lock files, or into those that are named.

    python tools/locks.py [requirements.lock …]

The versions stay as they are: to take another one, edit the line and run this. The hashes are those of the
index, for all machines and Pythons, not of what happens to be downloaded here. Needs uv
(requirements-audit.lock).
"""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).parents[1]
_PINNED = re.compile(r"[A-Za-z0-9][\w.-]*==[^\s\\]+(?: ; [^\\]+)?")
#: the oldest Python for which each file is
_PYTHON = "3.11.5"


def pinned(text: str) -> list[str]:
    """The versions that a lock file names, a line each."""
    return [found[0].strip() for line in text.splitlines() if (found := _PINNED.match(line))]


def main(files: list[Path]) -> None:
    """Write them."""
    for file in files or sorted(ROOT.glob("requirements*.lock")):
        text = file.read_text(encoding="utf-8")
        words = ["pip", "compile", "-", "--no-config", "--no-deps", "--generate-hashes", "--no-annotate"]
        words += ["--no-header", "--universal", "--python-version", _PYTHON, "--quiet"]
        uv = Path(sysconfig.get_path("scripts"), "uv")
        done = subprocess.run(
            [uv, *words], input="\n".join(pinned(text)), capture_output=True, text=True, check=False
        )
        if done.returncode:
            sys.exit(f"{file.name}: {done.stderr}")
        comments = [line for line in text.splitlines() if line.startswith("#")]
        file.write_text("\n".join([*comments, done.stdout]), encoding="utf-8")


if __name__ == "__main__":
    main([Path(name) for name in sys.argv[1:]])
