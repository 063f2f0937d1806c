"""The command line in the process of the tests, which begins none that has to import all of ours first."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from mutabot import extensions, faults
from mutabot.cli.app import main
from mutabot.languages import registry as languages
from mutabot.operators import registry as operators


def mutabot(folder: Path, *words: str, beside: Path | None = None) -> CompletedProcess[str]:
    """Run ``mutabot`` with these arguments in a folder; what is installed in ``beside`` is found as well."""
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2))
    with installed(beside), chdir(folder), redirect_stdout(out), redirect_stderr(err):
        code = main(words)
    return CompletedProcess(words, code, *(_written(stream) for stream in (out, err)))


@contextmanager
def installed(site: Path | None) -> Iterator[None]:
    """Let this process and those of its campaigns find the packages in a folder; forget them afterwards."""
    if site is None:
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(site)
        patch.setenv("PYTHONPATH", str(site))
        before = set(sys.modules)
        _forget_parts()
        try:
            yield
        finally:
            for name in set(sys.modules) - before:
                if str(getattr(sys.modules[name], "__file__", None)).startswith(f"{site}/"):
                    del sys.modules[name]
            _forget_parts()


def _forget_parts() -> None:
    for module in (extensions, faults, languages, operators):
        for found in vars(module).values():
            if hasattr(found, "cache_clear"):
                found.cache_clear()


def _written(stream: io.TextIOWrapper) -> str:
    stream.seek(0)
    return stream.read()
