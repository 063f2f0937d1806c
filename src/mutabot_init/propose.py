"""``mutabot init``: inspects a project, writes a configuration and a vocabulary, and says what comes next."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any

from mutabot.api.reports import MutabotError, UsageError
from mutabot.api.values import Vocabulary, load_vocabulary, shipped_vocabularies

from .layout import (
    NOTHING_WRITTEN,
    Layout,
    compared_with,
    imported_modules,
    look,
    project_above,
    refuse_mistakes,
)
from .messages import MessageEntry, entries
from .observations import ANY, Holder, WatchedCallable
from .observe import LIMIT, merged, watch
from .operations import Proposal, commands_of, has_discriminator, proposals
from .proposers import brought_proposers
from .text import counted, probe_text, questions_in, value_text, vocabulary_text
from .words import ASKING, words_of

CONFIGURATION, VOCABULARY = "mutabot.toml", "robot.toml"
#: what is said of a test file that imports one that is no Python
_MISTAKE = re.compile(r": (?:Syntax|Indentation|Tab)Error: ")
#: vocabularies of environments that are reached through the wrappers of another one
_BEHIND = {"metaworld": "gymnasium"}


@dataclass(frozen=True)
class ShippedVocabulary:
    """A vocabulary of an installed package that describes calls of the program.

    Attributes:
        name: as the configuration names it.
        vocabulary: what it says.
        overridden: names of methods that it describes with all that override them.
        packages: where these may come from.
    """

    name: str
    vocabulary: Vocabulary
    overridden: frozenset[str]
    packages: frozenset[str]

    def describes(self, call: WatchedCallable) -> bool:
        """Return whether it has this callable, or what that wraps or overrides, as operation or clock."""
        clock = self.vocabulary.clock
        if call.name in self.overridden and call.package in self.packages:
            return True
        targets = [
            *(operation.target for operation in self.vocabulary.operations),
            *([clock.tick] if clock else []),
        ]
        return call.target in targets

    def knows_arguments(self, call: WatchedCallable) -> bool:
        """Return whether it says what the arguments of such a call mean."""
        return self.describes(call) and any(
            operation.arguments
            for operation in self.vocabulary.operations
            if operation.target.endswith(f".{call.name}")
        )

    def reads(self, call: WatchedCallable) -> bool:
        """Return whether it describes this callable as a reading."""
        return any(
            operation.target == call.target and not operation.command
            for operation in self.vocabulary.operations
        )


def known_vocabularies(layout: Layout, calls: Sequence[WatchedCallable]) -> list[ShippedVocabulary]:
    """Return shipped vocabularies with observed calls; without any calls, those that the text imports."""
    files = (*layout.program, *layout.tests)
    imported = {name.partition(".")[0] for path in files for name in imported_modules(path)}
    every: dict[str, ShippedVocabulary] = {}
    for name in shipped_vocabularies():
        vocabulary = load_vocabulary([name], layout.root)
        packages = frozenset(operation.module.partition(".")[0] for operation in vocabulary.operations)
        overridden = frozenset(
            operation.target.rpartition(".")[2] for operation in vocabulary.operations if operation.overrides
        )
        every[name] = ShippedVocabulary(name, vocabulary, overridden, packages)
    for name, wrapper in _BEHIND.items():
        if name in imported:
            own, other = every[name], every.pop(wrapper)
            names, packages = own.overridden | other.overridden, own.packages | other.packages
            every[name] = replace(own, overridden=names, packages=packages)
    return [
        known
        for known in every.values()
        if (any(map(known.describes, calls)) if calls else known.packages & imported)
    ]


class _Findings:
    """The findings about a project.

    Attributes:
        layout: where what lies.
        run: the watched run of the tests.
        seen: what all its processes saw.
        known: shipped vocabularies that fit it.
        named: proposed operations that have a name on a middleware.
        operations: calls that no shipped vocabulary describes, whether or not they are proposed.
        oracle: files on the tests' side that read from the robot.
        beside: lines of the configuration that packages beside this one propose.
    """

    def __init__(
        self, root: Path, given: Sequence[Path], limit: float, notify: Callable[[str], None]
    ) -> None:
        layout = look(root, given)
        refuse_mistakes(layout)
        notify("running the tests once, to see what the program calls")
        began = monotonic()
        self._watch(layout, limit)
        left = limit - (monotonic() - began)
        files = layout.below if self.is_empty else layout.importing(self._libraries)
        if files and self.run.outcomes and not self.run.trouble and left > 0:
            why = "none of these calls looks like one of a robot" if self.is_empty else "the robot is called"
            what = "what the program imports" if self.is_empty else "other files that import its library"
            notify(f"{why}; once more, with {what}")
            first, had, was_empty = dict(vars(self)), self.taken, self.is_empty
            self._watch(layout.extended(files), left, reaching=was_empty)
            if self.is_empty or self.taken < had or self.run.trouble:
                vars(self).update(first)
        if self.is_empty:  # what is called at all may be skipped and repeated
            for operation in self.operations:
                may_be_robot = self._may_be_robot(operation.call)
                operation.is_plain = may_be_robot and self._is_of_project(operation.call)
                if may_be_robot and not operation.is_plain:
                    operation.doubt = operation.doubt or "does it make the robot act?"
                operation.is_taken = operation.is_operation
        self.oracle = self._files_that_read()
        self.beside = [
            line
            for name, proposer in brought_proposers().items()
            for line in proposer.lines(self._seen_by(name))
        ]

    def _watch(self, layout: Layout, limit: float, *, reaching: bool = False) -> None:
        """Watch a program; ``reaching``: only what reaches a mock or a fake of the tests may be a robot's."""
        self.layout = layout
        self.run = watch(layout, limit)
        mistake = next((problem for problem in self.run.problems if _MISTAKE.search(problem)), None)
        if mistake is not None and not self.run.outcomes:
            collected, _, what = mistake.partition(": ")
            raise UsageError(f"{what} (while pytest collects {collected}); {NOTHING_WRITTEN}")
        self.seen = merged(self.run.seen)
        self.program = [self.layout.relative(path) for path in self.layout.program]
        self.calls = without_duplicates([call for call in self.seen.calls if call.sites])
        self.known = known_vocabularies(self.layout, self.calls)
        self.named = entries(self.seen.uses)
        groups = compared_with(self.layout)
        mine, rest = _by_side([call for call in self.calls if not call.leads_to_names])
        mine = [call for call in mine if call.reaches or not reaching]
        self.operations = proposals(self._new([call for call in mine if not call.own]), groups)
        if self.is_empty:  # program and robot share a file
            self.operations = proposals(mine, groups)
        if not self.is_empty:  # without an operation of the program, what its tests read is no robot
            known = {_holder(call) for call in mine}
            self.operations += [
                proposal
                for proposal in proposals(self._new(rest), groups)
                if proposal.is_taken
                and proposal.is_reading
                and self._may_be_read(proposal, is_known=_holder(proposal.call) in known)
            ]

    @property
    def _libraries(self) -> set[str]:
        """The installed packages of which the program's calls are proposed or known."""
        taken = [operation.call for operation in self.operations if operation.is_taken]
        calls = [*taken, *(call for call in self.calls if any(known.describes(call) for known in self.known))]
        return {call.package for call in calls if not (call.of_tests or self._is_of_project(call))}

    @property
    def drafts(self) -> list[Proposal | MessageEntry]:
        """Everything that the vocabulary is to contain, even if only as comments."""
        return [*self.named, *self.operations]

    @property
    def taken(self) -> int:
        """The number of proposed operations."""
        return sum(draft.is_taken for draft in self.drafts)

    @property
    def is_empty(self) -> bool:
        """Whether nothing is known about the program's calls."""
        return not (self.taken or self.known)

    @property
    def makes_no_call(self) -> bool:
        """Whether the tests run no call of the program."""
        calls = any(call.sites and not call.of_tests for call in self.seen.calls)
        return not (calls or any(not entry.of_tests for entry in self.named))

    @property
    def vocabulary(self) -> list[str]:
        """The vocabularies' names for the configuration."""
        names = [vocabulary.name for vocabulary in self.known]
        return [*names, VOCABULARY] if self.taken or not names else names

    @property
    def needs_vocabulary(self) -> bool:
        """Whether there is anything to describe that no shipped vocabulary describes."""
        return bool(self.drafts or not self.known)

    def text(self) -> str:
        """Return the vocabulary's text; what a wrong guess would keep from loading is a comment."""
        text = vocabulary_text(self.drafts, self.program) + self._probe_text()
        if not self.taken or _loads(text):
            return text
        for operation in self.operations:
            operation.current = operation.opposite = None
        for draft in self.drafts:
            draft.is_taken = draft.is_taken and _loads(vocabulary_text([draft], self.program))
        return vocabulary_text(self.drafts, self.program) + self._probe_text()

    def _probe_text(self) -> str:
        """Return how to name a probe, unless nothing is proposed or a shipped vocabulary brings some."""
        if not self.taken or any(known.vocabulary.probes for known in self.known):
            return ""
        readings = [operation for operation in self.operations if operation.is_taken and operation.is_reading]
        return probe_text([reading.call.target for reading in readings if not reading.call.arguments])

    def _new(self, calls: Sequence[WatchedCallable]) -> list[WatchedCallable]:
        """Return the calls to describe; known ones only where the program shows more about them."""
        return [
            call
            for call in calls
            if not any(vocabulary.describes(call) for vocabulary in self.known)
            or _has_named_nodes(call)
            or (_has_limits(call) and not any(vocabulary.knows_arguments(call) for vocabulary in self.known))
        ]

    def _may_be_robot(self, call: WatchedCallable) -> bool:
        """Return whether a call of which nothing is known may be left out: one of another package."""
        return not call.problem and not call.is_property and call.package not in self._own_packages

    def _is_of_project(self, call: WatchedCallable) -> bool:
        """Return whether the project itself contains the callable, rather than an installed library."""
        places = [folder / call.package for folder in (self.layout.root, self.layout.root / "src")]
        return call.target.startswith(ANY) or any(
            place.is_dir() or place.with_suffix(".py").is_file() for place in places
        )

    @property
    def _own_packages(self) -> set[str]:
        """The top-level packages and modules of the program."""
        folders = ((*Path(file).parts[:-1], Path(file).stem) for file in self.program)
        return {next(part for part in folder if part != "src") for folder in folders}

    def _may_be_read(self, proposal: Proposal, *, is_known: bool) -> bool:
        """Return whether what the tests alone read may be the robot's.

        What only computes is not, unless the program uses the same object; what only holds data never is.
        A truth value or a text of the program's own package is its state, unless the program uses the same
        object, or its name says "read".
        """
        call = proposal.call
        if call.only_computes and (call.holder is not Holder.ANYTHING or not is_known):
            return False
        kinds = {guess.table["kind"] for guess in proposal.result.values()}
        is_state = kinds <= {"flag", "label"} and not ASKING.intersection(words_of(call.name)[:1])
        return (is_known and bool(call.owner)) or not is_state or call.package not in self._own_packages

    def _seen_by(self, name: str) -> list[Any]:
        return [calls.beside[name] for calls in self.run.seen if name in calls.beside]

    def _files_that_read(self) -> list[str]:
        targets = {
            operation.target for operation in self.operations if operation.is_taken and operation.is_reading
        }
        files = [
            where.rpartition(":")[0]
            for call in self.seen.calls
            if call.target in targets or any(vocabulary.reads(call) for vocabulary in self.known)
            for where in call.sites
        ]
        files += [file for entry in self.named if entry.of_tests for file in entry.files]
        return [file for file in dict.fromkeys(files) if file not in self.program]


def propose(
    root: Path,
    program: Sequence[Path] = (),
    *,
    limit: float = LIMIT,
    notify: Callable[[str], None] = lambda text: None,
) -> list[str]:
    """Write ``mutabot.toml`` and ``robot.toml``; return lines on what was found and what to do next.

    ``program`` are files or folders of the robot program, relative to the working folder or to ``root``;
    without any they are guessed. The tests are run to see what the program calls, for ``limit`` seconds at
    most, without those for which they wait for a processor; ``notify`` is called before. No existing file is
    touched.

    Raises UsageError if there is a configuration already, no program, or a file that is no Python.
    """
    given = root.resolve()
    root = project_above(given) if given.is_dir() else given
    if root != given:
        notify(f"project: {root}")
    refuse_existing(root)
    found = _Findings(root, program, limit, notify)
    text = found.text()
    if found.needs_vocabulary:
        _write(root / VOCABULARY, text)
    _write(root / CONFIGURATION, _configuration(found))
    return _summary(found, questions_in(text) if found.needs_vocabulary else 0)


def without_duplicates(calls: Sequence[WatchedCallable]) -> list[WatchedCallable]:
    """Remove methods of arbitrary objects, such as mocks, if the robot's own method was observed."""
    owned = {
        call.name
        for call in calls
        if not call.target.startswith(ANY) and "." in call.target.partition(":")[2]
    }
    return [call for call in calls if not (call.target.startswith(ANY) and call.name in owned)]


def _holder(call: WatchedCallable) -> str:
    """Return the class or module that a callable belongs to."""
    return call.target.removesuffix(call.name)


def _has_named_nodes(call: WatchedCallable) -> bool:
    return has_discriminator(call) and any(guess.table for _, guess in commands_of(call))


def _has_limits(call: WatchedCallable) -> bool:
    """Return whether it takes an action with limits given by the environment."""
    return any(part.limits for values in call.arguments.values() for part in values.parts.values())


def _by_side(calls: Sequence[WatchedCallable]) -> tuple[list[WatchedCallable], list[WatchedCallable]]:
    """Return the calls of the program, and those that only the tests make."""
    mine = [call for call in calls if not call.of_tests]
    targets = {call.target for call in mine}
    return mine, [call for call in calls if call.target not in targets]


def _write(path: Path, text: str) -> None:
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise UsageError(f"cannot write {path}: {error.strerror or error}") from error


def refuse_existing(root: Path) -> None:
    """Raise UsageError if the project has a configuration, or does not exist."""
    if not root.is_dir():
        raise UsageError(f"{root}: there is no such folder")
    for name in (CONFIGURATION, VOCABULARY):
        if (root / name).exists():
            raise UsageError(f"{root / name} exists already; init never overwrites a file")
    try:
        data = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return
    if "mutabot" in data.get("tool", {}):
        raise UsageError(f"{root / 'pyproject.toml'} has [tool.mutabot] already; there is nothing to propose")


def _loads(text: str) -> bool:
    with TemporaryDirectory() as folder:
        (Path(folder) / VOCABULARY).write_text(text, encoding="utf-8")
        try:
            load_vocabulary([VOCABULARY], Path(folder))
        except MutabotError:
            return False
    return True


def _configuration(found: _Findings) -> str:
    # what pytest's own configuration names needs no line
    tests = found.layout.arguments or ["tests"] if found.run.tests == found.layout.arguments else []
    listed = {"program": found.program, "oracle": found.oracle, "tests": tests,
              "vocabulary": found.vocabulary}  # fmt: skip
    notes = {
        "program": "  # makes the robot's calls",
        "oracle": "  # reads from the robot for the tests' checks",
    }
    lines = [f"{key} = {value_text(names)}{notes.get(key, '')}" for key, names in listed.items() if names]
    return "\n".join([*lines, "rounds = 1", "seed = 1", *found.beside]) + "\n"


def _summary(found: _Findings, questions: int) -> list[str]:
    run = found.run
    how = " (guessed; to choose other files: mutabot init FILE…)" if found.layout.guessed else ""
    counts = ", ".join(f"{count} {outcome}" for outcome, count in run.outcomes.items())
    lines = [f"program: {', '.join(found.program)}{how}"]
    if run.trouble:
        what = "not all tests were watched" if counts else "the tests could not be watched"
        lines.append(f"{what}: {run.trouble}")
    if counts:
        lines.append(f"tests: {counts}; {_counted(found)}")
    lines += [f"  {problem}" for problem in run.problems[:3] if not run.trouble]
    lines.append(f"wrote {CONFIGURATION}")
    tables = (line for line in found.beside if re.match(r"\[\w", line))
    lines += [f"  {line.replace('  # ', ': ')}" for line in tables]
    for vocabulary in found.known:
        calls = counted(sum(map(vocabulary.describes, found.calls)), "call")
        lines.append(f"vocabulary {vocabulary.name}: comes with mutabot, describes {calls}")
    if found.needs_vocabulary:
        asked = f" and {counted(questions, 'question')}" if questions else ""
        what = f"with {counted(found.taken, 'operation')}{asked}" if found.taken else "without an operation"
        left = len(found.drafts) - found.taken
        also = f"; {counted(left, 'more call')} as comments" if left else ""
        lines.append(f"wrote {VOCABULARY} {what}{also}")
    mocked = [
        operation.call for operation in found.operations if operation.is_taken and operation.call.stands_in
    ]
    names = [call.name if call.target.startswith(ANY) else call.target for call in mocked]
    if names:
        alone = any(call.target.startswith(ANY) for call in mocked)
        how = "the class that they stand for" + (
            "; a name alone means any object that has it" if alone else ""
        )
        lines.append(f"the tests call these on mocks or fakes, written as calls of {how}: {', '.join(names)}")
    written = " and ".join([CONFIGURATION, *([VOCABULARY] if found.needs_vocabulary else [])])
    again = f"If another file is the program, remove {written}, and run `mutabot init FILE…`"
    if found.layout.guessed and found.makes_no_call and found.calls and run.outcomes:
        return [*lines, f"next: no test runs a call of the guessed program. {again}"]
    if not found.is_empty:
        answer = f"answer the questions in {VOCABULARY}, then " if questions else ""
        return [*lines, f"next: {answer}`mutabot check`, `mutabot list`, `mutabot run`"]
    by_hand = "describe the robot by hand (docs/vocabulary.md)"
    if not found.makes_no_call:
        none = "none of these calls looks like one of a robot or a device"
        other = f". {again}; else {by_hand}" if found.layout.guessed else f": {by_hand}"
        return [*lines, f"next: {none}{other}"]
    tests = " ".join(found.run.tests) or "tests"
    return [
        *lines,
        f"next: make `python -m pytest {tests}` run tests that call the program, remove {CONFIGURATION} and "
        f"{VOCABULARY}, and run `mutabot init` again; or {by_hand}",
    ]


def _counted(found: _Findings) -> str:
    mine, rest = _by_side([call for call in found.seen.calls if call.sites])
    times = counted(sum(call.count for call in mine), "time")
    names = {(entry.key, entry.name) for entry in found.named if not entry.of_tests}
    more = f"; the tests call {len(rest)} more" if rest else ""
    more += f", and uses {counted(len(names), 'name')} of ROS" if names else ""
    return f"the program calls {counted(len(mine), 'callable')}, {times}{more}"
