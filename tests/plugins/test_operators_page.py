"""The page about operators is generated; here is what keeps it true."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from mutabot.operators import names, operator

ROOT = Path(__file__).parents[2]
PAGES = {
    "robot": "operators.md",
    "graded": "operators.md",
    "catalogue": "operators.md",
    "middleware": "middleware.md",
}
SCRIPT = ROOT / "tools" / "make_docs.py"


def test_docs_operators_md_is_up_to_date() -> None:
    done = subprocess.run([sys.executable, str(SCRIPT), "--check"], check=False)
    assert done.returncode == 0, "run python tools/make_docs.py"


def test_every_operator_has_its_section() -> None:
    texts = {page: (ROOT / "docs" / page).read_text(encoding="utf-8") for page in PAGES.values()}
    missing = [name for name in names() if f"\n### {name}\n" not in texts[PAGES[operator(name).family]]]
    assert missing == []


def test_every_row_of_the_published_table_is_made_by_one_of_ours() -> None:
    told = (operator(name).published for name in names())
    rows = sorted(int(row) for text in told for row in re.findall(r"(\d+)\. .* → ", text.replace("; ", "\n")))
    assert rows == [*range(1, 14)]
