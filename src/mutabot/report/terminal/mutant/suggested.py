"""The check that would catch a survivor, if one was suggested; else how to look for one."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from mutabot.analysis.results import MutantResult
from mutabot.analysis.suggested import Suggestions
from mutabot.report.suggested.text import lines_of
from mutabot.report.terminal.console import heading, plain


def suggested_parts(result: MutantResult, found: Suggestions | None) -> Iterator[RenderableType]:
    """The section of a survivor; nothing for other mutants."""
    if not result.is_survivor or result.mutant.ladder:
        return
    yield heading("A check that would catch it")
    for line in _lines(result, found):
        yield Padding(Text(plain(line), overflow="fold"), (0, 0, 0, 2), expand=False)


def _lines(result: MutantResult, found: Suggestions | None) -> Iterator[str]:
    mutant = result.mutant
    suggestions = found.suggestions if found is not None else ()
    for one in suggestions:
        if mutant.id in one.kills and found is not None:
            yield f"at the end of {one.test}:" if one.moment.startswith("end") else f"in {one.test}:"
            yield from lines_of(one, found)
            yield "`mutabot suggest` prints it as a diff."
            return
    for left in found.unsolved if found is not None else ():
        if left.mutant == mutant.id:
            yield f"none was found: {left.reason}"
            return
    if result.indistinguishable:
        yield "nothing differs that was compared: it needs another probe or another test, or is no fault"
    else:
        yield f"`mutabot suggest --only {mutant.number}` looks for one, and proves it"
