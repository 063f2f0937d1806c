"""Compare every vocabulary that mutabot ships with the package it describes: callables and arguments.

Native callables tell no signature. Where they are functions of Python's C interface, they are asked by calls
that cannot succeed; where they come from pybind11, their documentation names every overload.

    python tools/check_shipped.py [NAME…]

Exit code 1 if anything does not fit. A package that is not installed is named and left out; --strict makes
that an error as well.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import packages_distributions, version
from pathlib import Path
from typing import Any

from mutabot.config.vocabulary import load_vocabulary
from mutabot.config.vocabulary.load import shipped_vocabularies
from mutabot.model import Operation, Vocabulary
from mutabot.model.events import Problem
from mutabot.model.job import Job
from mutabot.model.signature import parse_signature, signature_of
from mutabot.runtime.event_file import Held
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.session import Session

#: a member of an enumeration, as pybind11 writes one that is a default
_DEFAULT_MEMBER = re.compile(r"<[^<>]*>")
_PARAMETERS = re.compile(r"\((.*)\)(?: -> .*)?$")


def main() -> int:
    """Print what fits and what does not."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    others = [name for name in shipped_vocabularies() if name != "cell"]  # that one is the suite's
    parser.add_argument("names", nargs="*", default=others, help="shipped vocabularies; default all but cell")
    parser.add_argument("--strict", action="store_true", help="a package that is missing is an error")
    given = parser.parse_args()
    failed = False
    for name in given.names:
        vocabulary = load_vocabulary([name], Path())
        packages = sorted({operation.module.partition(".")[0] for operation in vocabulary.operations})
        missing = [package for package in packages if not _imports(package)]
        if missing:
            print(f"{name}: left out, {', '.join(missing)} is not installed")
            failed = failed or given.strict
            continue
        problems = list(compare(vocabulary))
        failed = failed or bool(problems)
        shown = ", ".join(_version(package) for package in packages)
        print(f"{name}: {len(vocabulary.operations)} operations, {len(problems)} do not fit ({shown})")
        for problem in problems:
            print(f"  {problem}")
    return int(failed)


def compare(vocabulary: Vocabulary) -> Iterator[str]:
    """What does not fit the installed packages. What it wraps stays wrapped in this process."""
    writer = Held()
    job = Job(root=".", program=(), oracle=(), vocabulary=vocabulary, seed=1, round=0, inspect=True)
    session = Session(job, writer, Locator(job.root, job.program, job.oracle))
    with contextlib.redirect_stdout(io.StringIO()):
        session.install()
        session.inspect_targets()
    for line in writer.events:
        if isinstance(line, Problem):
            yield f"{line.source}: {line.text}"
    for operation in vocabulary.operations:
        original = session.callables.found.get(operation.target)
        if operation.signature is not None and original is not None:
            yield from (f"{operation.source}: {text}" for text in compare_native(operation, original))


def compare_native(operation: Operation, original: Any) -> Iterator[str]:
    """What is wrong with the signature that a vocabulary gives to a callable which tells none."""
    assert operation.signature is not None
    signature = parse_signature(operation.signature)
    names = [
        parameter.name
        for parameter in signature.parameters.values()
        if parameter.kind is parameter.POSITIONAL_OR_KEYWORD
    ]
    own = signature_of(original)
    if own is not None and not any(
        parameter.kind is parameter.VAR_KEYWORD for parameter in own.parameters.values()
    ):
        real = [name for name in own.parameters if name != "self"]
        if real[: len(names)] != names:
            yield f"its arguments are {real}, not {names}"
    elif "self" in (original.__doc__ or ""):
        overloads = list(_overloads(original.__doc__ or "", operation.name.rpartition(".")[2]))
        if not any(_agrees(names, overload) for overload in overloads):
            yield f"no overload takes {names}: {overloads}"
    elif callable(original) and type(original).__name__ == "builtin_function_or_method":
        yield from _asked(original, names)


def _overloads(documentation: str, name: str) -> Iterator[list[str]]:
    """Names of the arguments in each signature that pybind11 wrote down."""
    for line in documentation.splitlines():
        match = _PARAMETERS.search(line)
        if re.match(rf"(?:\d+\. )?{name}\(self: ", line) and match is not None:
            parts = re.findall(r"(\w+): ", _DEFAULT_MEMBER.sub("", match[1]))
            yield parts[1:]


def _agrees(names: Sequence[str], overload: Sequence[str]) -> bool:
    """Whether these are the names of an overload, in its order; pybind11 calls those without one arg0 …"""
    pairs = list(zip(names, overload, strict=False))
    return len(names) == len(overload) and all(
        ours == real or re.fullmatch(r"arg\d+", real) for ours, real in pairs
    )


def _asked(function: Callable[..., Any], names: Sequence[str]) -> Iterator[str]:
    """Each argument once by position and by name: the refusal says which name has which position."""
    for index, name in enumerate(names):
        said = _refusal(function, [0] * (index + 1), {name: 0})
        twice = f"given by name ('{name}') and position ({index + 1})"
        missing = re.search(r"missing required argument '(\w+)' \(pos (\d+)\)", said)
        if twice in said or (missing and names[int(missing[2]) - 1] == missing[1]):
            continue
        if "takes at most" in said and "invalid keyword" not in _refusal(function, [], {name: 0}):
            continue
        yield f"argument {index + 1} is not {name!r}: {said}"


def _refusal(function: Callable[..., Any], args: Sequence[Any], kwargs: dict[str, Any]) -> str:
    try:
        function(*args, **kwargs)
    except Exception as error:
        return str(error)
    return "it was taken"


def _imports(package: str) -> bool:
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            importlib.import_module(package)
    except ImportError:
        return False
    return True


def _version(package: str) -> str:
    found = packages_distributions().get(package, [])
    return f"{found[0]} {version(found[0])}" if found else package


if __name__ == "__main__":
    sys.exit(main())
