"""Accepted survivors and excluded mutants: those of the project's file, and comments in the program.

A comment stands at the end of a line of the call, or alone above it::

    arm.translate(dz=-0.1)  # mutabot: accept reverse, skip: the table is symmetric
"""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.faults.providers import family_of, operators_of_packages
from mutabot.config.mistakes import raise_errors
from mutabot.config.suppressions import read_suppressions
from mutabot.errors import ConfigurationError, UnknownNameError, unknown_name_text
from mutabot.journal import records
from mutabot.languages.registry import front_end_of, program_files
from mutabot.model import LeftOut
from mutabot.model.suppression import Acceptance, Accepted, Action, LinesOf, Suppression, first_fitting
from mutabot.operators import registry

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.campaign.plan import Plan
    from mutabot.campaign.request import Request
    from mutabot.journal.journal import Journal
    from mutabot.model import Mutant

_MARK = "mutabot:"
_COMMENT = re.compile(rf"\W*{_MARK}\s*(?P<action>[\w-]*)\s*(?P<operators>[^:]*)(?::\s*(?P<why>.*))?")
#: a comment of a language whose front end is of a package, by the signs that languages have for them
_ANY_COMMENT = re.compile(rf"(?P<before>.*?)(?P<comment>(?:#|//|--|[;!'%])\s*{_MARK}.*)")
_COMMENT_LINE = re.compile(r"#|//|--|[;!'%]")
_USAGE = f"write `# {_MARK} accept OPERATOR: why`, or `exclude`; several operators with commas, * for any"


def suppressions_of(request: Request) -> tuple[Suppression, ...]:
    """Return all decisions of a project. Raises ConfigurationError, about all mistakes at once."""
    configuration = request.configuration
    found = [*read_suppressions(request.root)]
    for file in program_files(request.root, (*configuration.program, *configuration.oracle)):
        found += comments_in(file, source_text(request.root / file))
    raise_errors([*_unknown_operators(found)])
    return tuple(found)


def source_text(file: Path) -> str:
    """Return a program text with plain newlines, decoded as far as possible."""
    source = file.read_bytes()
    try:
        return front_end_of(str(file)).text_of(source)
    except (SyntaxError, ValueError):
        return source.decode("utf-8", "replace")


def _unknown_operators(found: Iterable[Suppression]) -> Iterator[ConfigurationError]:
    for suppression in found:
        if (
            suppression.operator
            and not {"*", "?"} & {*suppression.operator}
            and suppression.operator not in registry.names()
        ):
            known = [*registry.names(), *operators_of_packages()]
            if suppression.operator not in known:
                file, _, line = suppression.source.rpartition(":")
                text = unknown_name_text("operator", suppression.operator, known)
                yield UnknownNameError(text, file=file, line=int(line))


def comments_in(file: str, text: str) -> list[Suppression]:
    """Return the decisions in the comments of a program file. Raises ConfigurationError."""
    if _MARK not in text:
        return []
    lines, found, errors = text.split("\n"), list[Suppression](), list[ConfigurationError]()
    for number, comment, is_alone in _comments(file, text):
        parts = _COMMENT.match(comment)
        if parts is None:
            continue
        operators = [name.strip() for name in parts["operators"].split(",") if name.strip()]
        why, action = (parts["why"] or "").strip(), parts["action"]
        if action not in [*Action] or not operators or not why:
            lacking = "names no operator" if not operators else "has no reason"
            problem = f"there is no {action!r}" if action not in [*Action] else f"`{action}` {lacking}"
            errors.append(ConfigurationError(f"{problem}; {_USAGE}", file=file, line=number))
            continue
        at = _next_code(lines, number) if is_alone else number
        suppression = Suppression(
            Action(action), why, f"{file}:{number}", file=file, numbers=(at, at), in_source=True
        )
        found += [replace(suppression, operator=operator) for operator in operators]
    raise_errors(errors)
    return found


def _comments(file: str, text: str) -> Iterator[tuple[int, str, bool]]:
    """Yield the line of each marked comment, its text, and whether the line has no code."""
    if not file.lower().endswith(".py"):
        for number, line in enumerate(text.split("\n"), start=1):
            if _MARK in line and (found := _ANY_COMMENT.match(line)):
                yield number, found["comment"], not found["before"].strip()
        return
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.COMMENT and re.match(rf"\W*{_MARK}", token.string):
                yield token.start[0], token.string, not token.line[: token.start[1]].strip()
    except (tokenize.TokenError, SyntaxError):
        return  # the tests will say what is wrong with this file


def _next_code(lines: Sequence[str], number: int) -> int:
    """Return the first line below a comment, by numbers from 1, that is neither a comment nor empty."""
    below = ((at, lines[at - 1].strip()) for at in range(number + 1, len(lines) + 1))
    return next((at for at, text in below if text and not _COMMENT_LINE.match(text)), number)


def divided(campaign: Campaign, plan: Plan) -> tuple[Plan, tuple[str, ...]]:
    """Return the plan without excluded mutants, and descriptions of decisions that match no mutant.

    Excluded mutants are left out, with the reason. Numbers stay as they are.
    """
    if not campaign.suppressions:
        return plan, ()
    lines, left_out = _lines_of(campaign.request.root), list(plan.left_out)
    excluding = [suppression for suppression in campaign.suppressions if suppression.action is Action.EXCLUDE]
    kept = []
    for mutant in plan.mutants:
        found = first_fitting(excluding, mutant, lines)
        if found is None:
            kept.append(mutant)
        else:
            left_out.append(LeftOut(mutant.id, mutant.description, f"excluded: {found.why}"))
    unmatched = tuple(_unmatched(campaign, plan, lines))
    for text in unmatched:
        campaign.progress.note(text)
    return replace(plan, mutants=kept, left_out=left_out), unmatched


def _unmatched(campaign: Campaign, plan: Plan, lines: LinesOf) -> Iterator[str]:
    """Describe the decisions that match no mutant of this campaign's families."""
    ids = {omission.id for omission in plan.left_out}
    for suppression in campaign.suppressions:
        named = [mutant for mutant in plan.mutants if suppression.names(mutant)]
        if suppression.id in ids or any(suppression.fits(mutant, lines) for mutant in named):
            continue
        if suppression.id and named:
            now = line_at(lines, named[0])
            change = f"the line of {suppression.id} has changed from {suppression.line!r} to {now!r}"
            yield f"{suppression.source}: {change}: decide again"
        elif _is_of(suppression, campaign.request.families):
            yield f"{suppression.source}: no mutant is {suppression.mutants_text}: the decision has no effect"


def _is_of(suppression: Suppression, families: Collection[str]) -> bool:
    """Return whether a decision may be about mutants of these families."""
    if not suppression.id and (not suppression.operator or {"*", "?"} & {*suppression.operator}):
        return True
    return family_of(suppression.id or suppression.operator) in families


def note_accepted(journal: Journal, suppressions: Iterable[Suppression], unmatched: Sequence[str]) -> None:
    """Record in a journal which mutants are accepted if they survive, and which decisions match none."""
    accepting = [candidate for candidate in suppressions if candidate.action is Action.ACCEPT]
    lines = cache(lambda file: (journal.source(file) or "").split("\n"))
    found = {}
    mutants = (*journal.mutants(), *(mutant for mutant, _ in journal.known())) if accepting else ()
    for mutant in mutants:
        suppression = first_fitting(accepting, mutant, lines)
        if suppression is not None:
            found[mutant.id] = Acceptance(
                suppression.why, suppression.source, suppression.date, suppression.in_source
            )
    journal.set_meta(records.ACCEPTED, Accepted(found, tuple(unmatched)))


def line_at(lines: LinesOf, mutant: Mutant) -> str:
    """Return the first line of a mutant's first place, without blanks around it; empty if there is none."""
    span = mutant.site.span
    return "".join(lines(span.file)[max(0, span.line - 1) : span.line]).strip()


def _lines_of(root: Path) -> LinesOf:
    """Return what gives the lines of a program's files; none for a file that does not exist."""
    return cache(lambda file: source_text(path).split("\n") if (path := root / file).is_file() else [])
