"""What does recording cost? Campaigns with evidence and without, in pairs, by processor time; and its size.

Use: ``python benchmarks/evidence.py [--pairs 5] [--example paper] [--selection published.txt] [--rounds 5]``.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def campaign(given: argparse.Namespace, folder: Path, evidence: bool) -> float:
    """Processor seconds of a campaign and all its processes, in a copy of the example."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(
        ROOT / "examples" / given.example, folder, ignore=shutil.ignore_patterns(".mutabot", "__pycache__")
    )
    if not evidence:
        file = folder / "pyproject.toml"
        text = file.read_text(encoding="utf-8").replace("[tool.mutabot]", "[tool.mutabot]\nevidence = 0")
        file.write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "mutabot", "-C", str(folder), "run", "--rounds", str(given.rounds)]
    if given.selection:
        command += ["--only", f"@{given.selection}"]
    before = os.times()
    subprocess.run(command, check=True, capture_output=True)
    after = os.times()
    return (after.children_user - before.children_user) + (after.children_system - before.children_system)


def main() -> None:
    """Print a line per pair, and what all say."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--example", default="paper")
    parser.add_argument("--selection", default="published.txt")
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    ratios = []
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home, given.example)
        for number in range(given.pairs):
            order = (True, False) if number % 2 else (False, True)
            found = {evidence: campaign(given, folder, evidence) for evidence in order}
            ratios.append(found[True] / found[False])
            print(f"pair {number + 1}: {found[True]:.2f} s with, {found[False]:.2f} s without", flush=True)
        campaign(given, folder, True)
        sizes = {path.name: path.stat().st_size for path in sorted(folder.glob(".mutabot/*.sqlite"))}
    print(f"ratio: median {statistics.median(ratios):.3f}, from {min(ratios):.3f} to {max(ratios):.3f}")
    print(", ".join(f"{name} {size / 1e6:.2f} MB" for name, size in sizes.items()))


if __name__ == "__main__":
    main()
