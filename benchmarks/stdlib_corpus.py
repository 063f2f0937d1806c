"""Ordinary Python with all alternatives in it and none active: the standard library through its own tests.

Each module is instrumented with all alternatives of all operators and run through its tests of CPython, once
as it is and once instrumented (``--record``: recording, as in a baseline). Every test must end the same way.

Usage: python benchmarks/stdlib_corpus.py [--record] [module ...]
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import subprocess
import sys
import tempfile
import time
import unittest
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mutabot.model import Instrumentation
from mutabot.model.codec import from_data, to_data

#: module -> test module, relative to ``test``
CORPUS = {
    "argparse": "test_argparse",
    "ast": "test_unparse",
    "base64": "test_base64",
    "bisect": "test_bisect",
    "calendar": "test_calendar",
    "cmd": "test_cmd",
    "code": "test_code_module",
    "colorsys": "test_colorsys",
    "configparser": "test_configparser",
    "contextlib": "test_contextlib_async",
    "copy": "test_copy",
    "csv": "test_csv",
    "dataclasses": "test_dataclasses",
    "datetime": "datetimetester",
    "_pydecimal": "test_decimal",
    "difflib": "test_difflib",
    "fileinput": "test_fileinput",
    "fnmatch": "test_fnmatch",
    "fractions": "test_fractions",
    "getopt": "test_getopt",
    "graphlib": "test_graphlib",
    "gettext": "test_gettext",
    "heapq": "test_heapq",
    "html.parser": "test_htmlparser",
    "http.cookies": "test_http_cookies",
    "ipaddress": "test_ipaddress",
    "json.decoder": "test_json",
    "json.encoder": "test_json",
    "mimetypes": "test_mimetypes",
    "netrc": "test_netrc",
    "optparse": "test_optparse",
    "pickle": "test_pickle",
    "plistlib": "test_plistlib",
    "pprint": "test_pprint",
    "queue": "test_queue",
    "quopri": "test_quopri",
    "random": "test_random",
    "reprlib": "test_reprlib",
    "sched": "test_sched",
    "shlex": "test_shlex",
    "statistics": "test_statistics",
    "string": "test_string",
    "tabnanny": "test_tabnanny",
    "textwrap": "test_textwrap",
    "timeit": "test_timeit",
    "tokenize": "test_tokenize",
    "typing": "test_typing",
    "urllib.parse": "test_urlparse",
    "uuid": "test_uuid",
    "wave": "test_wave",
    "xml.etree.ElementPath": "test_xml_etree",
    "zipfile": "test_zipfile",
}
#: wall clock for one run of one module's tests
_SECONDS = 900


@dataclass(frozen=True)
class Run:
    """One run of a module's tests: how each ended, and how long it took."""

    outcomes: dict[str, str]
    seconds: float
    problems: dict[str, str]
    imported: list[str]
    reached: int = 0


def main() -> int:
    """Run the corpus, or one module of it in this process."""
    parser = argparse.ArgumentParser()
    parser.add_argument("modules", nargs="*", metavar="module")
    parser.add_argument("--record", action="store_true", help="record instead of offering alternatives")
    parser.add_argument("--inside", metavar="JOB", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.inside:
        _inside(json.loads(Path(options.inside).read_text(encoding="utf-8")))
        return 0
    unequal = [module for module in options.modules or CORPUS if not compare(module, record=options.record)]
    print(f"unequal: {', '.join(unequal)}" if unequal else "all end the same way")
    return 1 if unequal else 0


def compare(module: str, *, record: bool = False) -> bool:
    """Whether a module's tests end the same way with all alternatives in it; prints one line."""
    places, alternatives, job = _job(module, record=record)
    plain = _run({**job, "instrumentation": None})
    instrumented = _run(job)
    differing = {
        test: (plain.outcomes.get(test), instrumented.outcomes.get(test))
        for test in plain.outcomes.keys() | instrumented.outcomes.keys()
        if plain.outcomes.get(test) != instrumented.outcomes.get(test)
    }
    passed = sum(outcome == "ok" for outcome in instrumented.outcomes.values())
    good = not differing and not instrumented.problems and bool(instrumented.imported) and passed > 0
    factor = instrumented.seconds / max(plain.seconds, 1e-3)
    reached = f", {instrumented.reached} places reached" if record else ""
    print(
        f"{'ok ' if good else 'BAD'} {module:22} {places:6} places {alternatives:7} alternatives "
        f"{passed:5} of {len(plain.outcomes):5} tests pass, {plain.seconds:6.2f} s -> "
        f"{instrumented.seconds:6.2f} s ({factor:.2f}x){reached}",
        flush=True,
    )
    for test, (before, after) in sorted(differing.items())[:10]:
        print(f"      {test}: {before} -> {after}")
    for file, problem in instrumented.problems.items():
        print(f"      {file}: {problem}")
    return good


def _job(module: str, *, record: bool) -> tuple[int, int, dict[str, Any]]:
    from mutabot_source.registry import names  # noqa: PLC0415  # not wanted inside
    from mutabot_source.texts import find_texts  # noqa: PLC0415  # likewise

    file = Path(os.__file__).parent / (module.replace(".", "/") + ".py")
    if not file.exists():
        file = file.with_suffix("") / "__init__.py"
    root = Path(os.__file__).parent
    texts = find_texts(root, [str(file.relative_to(root))], names())
    alternatives = sum(len(place.alternatives) for place in texts[0].places)
    data = to_data(Instrumentation(texts, record))
    job = {"root": str(root), "module": module, "test": CORPUS[module], "instrumentation": data}
    return len(texts[0].places), alternatives, job


def _run(job: dict[str, Any]) -> Run:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "job.json"
        file.write_text(json.dumps(job), encoding="utf-8")
        command = [sys.executable, str(Path(__file__).resolve()), "--inside", str(file)]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=_SECONDS, check=False
        )
        answer = Path(folder) / "answer.json"
        if not answer.exists():
            return Run({}, 0.0, {"worker": done.stderr[-1500:]}, [])
        return Run(**json.loads(answer.read_text(encoding="utf-8")))


def _inside(job: dict[str, Any]) -> None:
    answer = Path.cwd() / "answer.json"
    hook = None
    if job["instrumentation"] is not None:
        from mutabot.runtime.program_text.instrument import SessionText  # noqa: PLC0415  # only where it is needed

        hook = SessionText(job["root"], from_data(Instrumentation, job["instrumentation"]))
    for name in list(sys.modules):
        if name == job["module"]:
            del sys.modules[name]
    if hook is not None:
        hook.install()
    importlib.import_module(job["module"])
    from test import support  # noqa: PLC0415  # the tests of CPython

    support.use_resources = []
    suite = unittest.defaultTestLoader.loadTestsFromName(f"test.{job['test']}")
    result = _Result()
    started = time.process_time()
    suite.run(result)
    seconds = time.process_time() - started
    data = {
        "outcomes": result.outcomes,
        "seconds": seconds,
        "problems": dict(hook.problems) if hook is not None else {},
        "imported": hook.imported if hook is not None else [],
        "reached": len(hook.sightings.seen()) if hook is not None and hook.sightings is not None else 0,
    }
    answer.write_text(json.dumps(data), encoding="utf-8")


class _Result(unittest.TestResult):
    """How each test ended, by its name."""

    def __init__(self) -> None:
        super().__init__()
        self.outcomes: dict[str, str] = {}

    def startTest(self, test: unittest.TestCase) -> None:  # noqa: N802  # unittest's name
        super().startTest(test)
        self.outcomes.setdefault(test.id(), "ok")

    def addError(self, test: unittest.TestCase, err: Any) -> None:  # noqa: N802
        super().addError(test, err)
        self.outcomes[test.id()] = "error"
        print(self.errors[-1][1], file=sys.stderr)

    def addFailure(self, test: unittest.TestCase, err: Any) -> None:  # noqa: N802
        super().addFailure(test, err)
        self.outcomes[test.id()] = "failure"
        print(self.failures[-1][1], file=sys.stderr)

    def addSubTest(self, test: Any, subtest: Any, err: Any) -> None:  # noqa: N802
        super().addSubTest(test, subtest, err)
        if err is not None:
            self.outcomes[test.id()] = "failure"

    def addSkip(self, test: unittest.TestCase, reason: str) -> None:  # noqa: N802
        super().addSkip(test, reason)
        self.outcomes[test.id()] = "skipped"


if __name__ == "__main__":
    sys.exit(main())
