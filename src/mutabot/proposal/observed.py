"""One plain run of the tests, watched: the calls that the program really makes."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mutabot.execution.processes import command, kill_group
from mutabot.extensions import libraries, told_to_processes
from mutabot.model.job import WATCH_VARIABLE

from .layout import Layout
from .named.seen import Use, is_finite, uses

#: seconds that the tests may take; what was seen by then counts
LIMIT = 180.0
_MISSING = re.compile(r"No module named '([\w.]+)'")


@dataclass(frozen=True)
class Part:
    """A part of an argument or a result, with values that were seen.

    Attributes:
        path: where it lies.
        name: the last name on the way; empty for an index or the whole.
        doc: what the class that holds it says about itself.
        values: the first different values.
        length: least number of elements of a sequence, or None.
        type: name of its type.
        always: whether it was there in every call.
    """

    path: str
    name: str
    doc: str
    values: tuple[Any, ...]
    length: int | None
    type: str
    always: bool


@dataclass(frozen=True)
class SeenCommand:
    """What was seen of one of the commands of a callable.

    Attributes:
        text: what tells it from the others, such as the id of a node.
        calls: how often it was called.
        arguments, result: parts, as in a call.
    """

    text: str
    calls: int
    arguments: Mapping[str, tuple[Part, ...]]
    result: tuple[Part, ...]


@dataclass(frozen=True)
class SeenCall:
    """A callable that the program or the tests use, as the running program knows it.

    Attributes:
        target: as vocabularies name it.
        facts: what it says about itself: doc, owner, annotations and so on.
        sites: file, line, number of calls.
        arguments: parts by argument, in the order of the signature.
        positional: parts of arguments whose names nothing tells.
        result: parts of what it answered.
        told_by: path to what tells its commands apart; empty if nothing does.
        commands: these commands.
    """

    target: str
    facts: Mapping[str, Any]
    sites: tuple[tuple[str, int, int], ...]
    arguments: Mapping[str, tuple[Part, ...]]
    positional: tuple[Part, ...]
    result: tuple[Part, ...]
    told_by: str = ""
    commands: tuple[SeenCommand, ...] = ()

    @property
    def name(self) -> str:
        """Its own name."""
        return re.split(r"[.:]", self.target)[-1]

    @property
    def package(self) -> str:
        """The top-level package it comes from."""
        return re.split(r"[.:]", self.target)[0]

    @property
    def count(self) -> int:
        """How many calls were seen."""
        return sum(count for _, _, count in self.sites)


@dataclass
class Observed:
    """What the run showed.

    Attributes:
        calls: callables in the order in which they were first used.
        outcomes: number of tests by outcome.
        problems: what failed, in pytest's words.
        trouble: why the run tells less than it could; empty if it went well.
        extra: pytest arguments that it needed.
        names: what was done under names of a middleware.
        reached: file, line and name of everything that was called; the name is empty for a plain one.
    """

    calls: list[SeenCall] = field(default_factory=list)
    outcomes: dict[str, int] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    trouble: str = ""
    extra: list[str] = field(default_factory=list)
    names: list[Use] = field(default_factory=list)
    reached: list[tuple[str, int, str]] = field(default_factory=list)


def observe(layout: Layout, limit: float = LIMIT) -> Observed:
    """Run the tests once and watch the program; once more with the import paths that were missing."""
    found = _run(layout, [], limit)
    if found.outcomes or not any(_is_own(layout, text) for text in [*found.problems, found.trouble]):
        return found
    paths = " ".join(_relative(layout.root, home) for home in layout.homes)
    again = _run(layout, ["-o", f"pythonpath={paths}"], limit)
    return again if again.outcomes else found


def _run(layout: Layout, extra: list[str], limit: float) -> Observed:
    with TemporaryDirectory(ignore_cleanup_errors=True) as name:  # nodes may still write to their logs
        folder = Path(name)
        order, output, log = folder / "watch.json", folder / "seen.json", folder / "log.txt"
        order.write_text(json.dumps(_order(layout, output)), encoding="utf-8")
        own = ["-p", "mutabot.runtime.watching.plugin", "--assert=plain"]
        words = [*command([*layout.arguments, *extra], folder), *own]
        overdue = _wait(words, layout.root, order, log, limit)
        said = log.read_text(encoding="utf-8", errors="replace")
        found = _read(output)
        found.extra = extra
        if overdue:
            found.trouble = f"the tests took longer than {limit:.0f} s: only what was seen by then is known"
        elif not found.outcomes:
            found.trouble = "; ".join(found.problems[:3]) or _said(said)
        return found


def _order(layout: Layout, output: Path) -> dict[str, Any]:
    names = {kind: {os.path.realpath(path): layout.relative(path) for path in getattr(layout, kind)}
             for kind in ("program", "tests")}  # fmt: skip
    brought = {"extensions": told_to_processes(), "libraries": list(libraries())}
    return {**names, **brought, "root": str(layout.root), "output": str(output)}


def _wait(words: Sequence[str], root: Path, order: Path, log: Path, limit: float) -> bool:
    """Run pytest; whether it was ended because it took too long."""
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", WATCH_VARIABLE: str(order)}
    with (
        log.open("wb") as file,
        subprocess.Popen(
            words, cwd=root, env=environment, stdin=subprocess.DEVNULL, stdout=file,
            stderr=subprocess.STDOUT, start_new_session=True,
        ) as process,
    ):  # fmt: skip
        try:
            process.wait(limit)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)  # as a person would: pytest ends in an orderly way
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(5.0)
            return True
        finally:
            kill_group(process.pid)
            process.wait()
    return False


def _read(output: Path) -> Observed:
    try:
        data = json.loads(output.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return Observed()
    calls = [_call(raw) for raw in _together(data["calls"])]
    reached = list(dict.fromkeys((file, line, name) for file, line, name in data["reached"]))
    return Observed(calls, data["outcomes"], data["problems"], names=uses(data["names"]), reached=reached)


def _together(calls: Sequence[dict[str, Any]]) -> Iterable[dict[str, Any]]:
    """One entry for what several processes saw of a callable: the first one's values, all sites."""
    found: dict[tuple[str, bool], dict[str, Any]] = {}
    for raw in calls:
        first = found.setdefault((raw["target"], raw["of_tests"]), raw)
        if first is not raw:
            first["leads_to_names"] |= raw["leads_to_names"]
            counts = {(file, line): count for file, line, count in first["sites"]}
            for file, line, count in raw["sites"]:
                counts[file, line] = counts.get((file, line), 0) + count
            first["sites"] = [[file, line, count] for (file, line), count in counts.items()]
    return found.values()


def _call(raw: dict[str, Any]) -> SeenCall:
    arguments = _arguments(raw)
    ordered = [name for name in raw["annotations"] if name in arguments]
    arguments = {name: arguments[name] for name in [*ordered, *(set(arguments) - set(ordered))]}
    positional = _parts(raw.pop("positional"), 0)
    result = _parts(raw.pop("result"), raw["answered"])
    sites = tuple((file, line, count) for file, line, count in raw.pop("sites"))
    apart = raw.pop("told_apart")
    commands = tuple(
        SeenCommand(text, one["calls"], _arguments(one), _parts(one["result"], one["answered"]))
        for text, one in apart["commands"].items()
    )
    return SeenCall(raw["target"], raw, sites, arguments, positional, result, apart["by"], commands)


def _arguments(raw: dict[str, Any]) -> dict[str, tuple[Part, ...]]:
    found = raw.pop("arguments")
    return {name: _parts(leaves, raw["given"].get(name, 0)) for name, leaves in found.items()}


def _parts(leaves: Sequence[Mapping[str, Any]], times: int) -> tuple[Part, ...]:
    return tuple(part_of(leaf, times) for leaf in leaves)


def part_of(leaf: Mapping[str, Any], times: int = 0) -> Part:
    """A part as the watching plug-in writes it; ``times``: in how many calls it could have been."""
    values = tuple(value for value in leaf["values"] if is_finite(value))
    return Part(
        leaf["path"], leaf["name"], leaf["doc"], values, leaf["length"], leaf["type"],
        always=leaf["count"] >= times,
    )  # fmt: skip


def _is_own(layout: Layout, text: str) -> bool:
    """Whether a module that is missing is one of the project's."""
    return any(
        (home / top).is_dir() or (home / f"{top}.py").is_file()
        for missing in _MISSING.findall(text)
        for top in [missing.partition(".")[0]]
        for home in layout.homes
    )


def _relative(root: Path, path: Path) -> str:
    return path.relative_to(root).as_posix()


def _said(log: str) -> str:
    """What pytest said last that tells something."""
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    telling = [line for line in lines if re.search(r"error|Error|no tests|No module", line)]
    return (telling or lines or ["pytest said nothing"])[-1][:300]
