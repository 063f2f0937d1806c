"""The page about conventional operators is generated; here is what keeps it true."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).parents[3] / "tools" / "make_conventional_page.py"


def test_docs_conventional_md_is_up_to_date() -> None:
    done = subprocess.run([sys.executable, str(SCRIPT), "--check"], check=False)
    assert done.returncode == 0, "run python tools/make_conventional_page.py"
