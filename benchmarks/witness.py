"""Record what a version of mutabot says about every project here, to hold another version against it.

    python benchmarks/witness.py FOLDER [NAME …]         a file for each example and project of the corpus
    python benchmarks/witness.py FOLDER --as RECORDED    the same mutants as in an earlier record
    python benchmarks/same_results.py RECORDED FOLDER    what differs

``benchmarks/witness_records`` holds what commit 96189ca said, before the redesign. Install both versions as
wheels to compare projects that use Hypothesis, which takes constants for its examples from every module that
lies outside of site-packages.

Only the command line is used (``list``, ``run``, ``results``), so ``--command`` may name another version. Of
each mutant and round a record keeps the verdict, what noticed the mutant, the test, the exception, its
message, the hits, and what ended otherwise than in the original; not what it cost. Over DDS, where messages
cross between processes at times of their own, it keeps the verdict alone. Mutants of the program text are
drawn by a hash of their id, so that adding a mutant leaves the others in.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from suites.corpus import copied, corpus  # noqa: E402

#: example -> rounds, and mutants of each family at most
EXAMPLES: Mapping[str, tuple[int, Mapping[str, int]]] = {
    "paper": (2, {"robot": 1000, "conventional": 40, "catalogue": 30}),
    "scales": (2, {"robot": 1000, "conventional": 40, "text": 30, "catalogue": 30}),
    "pick_and_place": (1, {"robot": 60, "conventional": 20, "catalogue": 20}),
    "loop": (1, {"robot": 30, "conventional": 10}),
    "ros1": (1, {"robot": 12, "middleware": 12}),
    "ros2": (1, {"robot": 12, "middleware": 12}),
}
#: examples whose messages cross DDS or a ROS master, and the module that they need
ROS = {"ros1": "rospy", "ros2": "rclpy"}
#: the same for a project of the corpus
SMALL: Mapping[str, int] = {"robot": 60, "conventional": 8}
#: what is kept of an outcome; of ROS the first alone
FACTS = ("verdict", "by", "test", "exception", "message", "hits", "acted", "divergence", "gaps", "example")
#: what differs between equal runs: addresses, temporary and installation folders, process numbers, times
ACCIDENTS = (
    (re.compile(r"0x[0-9a-fA-F]{6,}"), "0x…"),
    (re.compile(r"pytest-\d+"), "pytest-…"),
    (re.compile(r"/tmp/[\w.-]+"), "/tmp/…"),
    (re.compile(r"/[\w./-]+/(bin/python|src/mutabot|site-packages)\b"), r"…/\1"),
    (re.compile(r"\b(pid|process|parent)[ =]\d+"), r"\1 …"),
    (re.compile(r"; it said last: .*", re.DOTALL), ""),
)


def projects() -> dict[str, Path]:
    """Every project that can be recorded, by its name."""
    examples = {name: ROOT / "examples" / name for name in EXAMPLES}
    return examples | {folder.name: folder for folder in corpus()}


def record(name: str, folder: Path, command: Sequence[str], wanted: Iterable[str] | None) -> dict[str, Any]:
    """What this version says about a project.

    Args:
        command: the version, such as ``["mutabot"]``.
        wanted: ids of the mutants to run; None to draw them.
    """
    rounds, limits = EXAMPLES.get(name, (1, SMALL))
    with tempfile.TemporaryDirectory() as place:
        copy = copied(folder, Path(place).resolve() / name)
        shared = ["--family", ",".join(limits), "--rounds", str(rounds), "--seed", "1"]
        plan = _json([*command, "-C", str(copy), "list", *shared, "--json"])
        ids = [mutant["id"] for mutant in plan["mutants"]]
        chosen = set(drawn(plan["mutants"], limits) if wanted is None else wanted)
        run = [mutant_id for mutant_id in ids if mutant_id in chosen]
        selection = Path(place, "selection.txt")
        selection.write_text("".join(f"{mutant_id}\n" for mutant_id in run), encoding="utf-8")
        _json([*command, "-C", str(copy), "run", *shared, "--only", f"@{selection}", "--json"])
        results = _json([*command, "-C", str(copy), "results", "--json"])
    facts = FACTS[:1] if name in ROS else FACTS
    return {
        "plan": [[mutant["id"], mutant["description"]] for mutant in plan["mutants"]],
        "left_out": [[omission["id"], omission["reason"]] for omission in plan["left_out"]],
        "outcomes": {
            f"{mutant['id']} [{outcome['round']}]": {key: told(outcome.get(key), str(copy)) for key in facts}
            for mutant in results["mutants"]
            for outcome in mutant["rounds"]
        },
    }


def drawn(mutants: Iterable[Mapping[str, Any]], limits: Mapping[str, int]) -> list[str]:
    """Of each family as many as its limit, those whose ids have the least hashes."""
    families: dict[str, list[str]] = {}
    for mutant in mutants:
        families.setdefault(mutant["family"], []).append(mutant["id"])
    return [
        mutant_id
        for family, ids in families.items()
        for mutant_id in sorted(ids, key=_hash)[: limits.get(family, 0)]
    ]


def _hash(text: str) -> bytes:
    return hashlib.sha256(text.encode()).digest()


def told(value: Any, root: str) -> Any:
    """A value without what differs between equal runs."""
    if isinstance(value, str):
        value = value.replace(root, "…")
        for pattern, text in ACCIDENTS:
            value = pattern.sub(text, value)
    elif isinstance(value, list):
        value = [told(part, root) for part in value]
    return value


def read(file: Path) -> dict[str, Any]:
    """A record."""
    found: dict[str, Any] = json.loads(gzip.decompress(file.read_bytes()))
    return found


def write(file: Path, data: Mapping[str, Any]) -> None:
    """Keep a record; equal records are equal files."""
    text = json.dumps(data, indent=0, sort_keys=True, ensure_ascii=False)
    file.write_bytes(gzip.compress(text.encode(), mtime=0))


def _json(words: Sequence[str]) -> dict[str, Any]:
    done = subprocess.run(words, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if not done.stdout.lstrip().startswith("{"):
        raise SystemExit(f"{' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--as", dest="earlier", type=Path, help="an earlier record")
    parser.add_argument("--command", nargs="+", default=[str(Path(sys.executable).parent / "mutabot")])
    given = parser.parse_intermixed_args()
    every = projects()
    unknown = sorted({*given.names} - {*every})
    if unknown:
        parser.error(f"no project {', '.join(unknown)}")
    given.folder.mkdir(parents=True, exist_ok=True)
    for name in given.names or every:
        if name in ROS and find_spec(ROS[name]) is None:
            print(f"{name}: not recorded, since this Python has no {ROS[name]}")
            continue
        began = time.monotonic()
        before = None
        if given.earlier is not None and not (given.earlier / f"{name}.json.gz").exists():
            print(f"{name}: not recorded, since the earlier record has no such project")
            continue
        if given.earlier is not None:
            before = {key.rpartition(" [")[0] for key in read(given.earlier / f"{name}.json.gz")["outcomes"]}
        found = record(name, every[name], given.command, before)
        write(given.folder / f"{name}.json.gz", found)
        counts = f"{len(found['plan'])} mutants, {len(found['outcomes'])} outcomes"
        print(f"{name}: {counts}, {time.monotonic() - began:.0f} s", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
