"""``mutabot init``: look at a project, write a configuration and a vocabulary, say what comes next."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from mutabot.config.vocabulary import load
from mutabot.errors import ConfigurationError, UsageError
from mutabot.model import ANY
from mutabot.proposal.commands import commands_of, tells_commands
from mutabot.proposal.vocabulary_text import vocabulary_text

from .compared import Unreached, compared_with, unreached
from .known import Known, known_vocabularies
from .layout import look
from .named.entries import Entry, entries, unused
from .observed import LIMIT, Observed, SeenCall, observe
from .operations import proposals

CONFIGURATION, VOCABULARY = "mutabot.toml", "robot.toml"


class _Look:
    """What was found out about a project.

    Attributes:
        layout: where what lies.
        seen: the watched run of the tests.
        known: shipped vocabularies that fit it.
        named: proposed operations that have a name on a middleware.
        stood_in: names of methods that only what stands in for the robot has.
        found: proposed operations that no shipped vocabulary has.
        others: calls of which nothing shows what they mean.
        oracle: files on the tests' side that read from the robot.
        unreached: calls of the program's text that no test makes.
    """

    def __init__(self, root: Path, given: Sequence[Path], limit: float, tell: Callable[[str], None]) -> None:
        self.layout = look(root, given)
        tell("running the tests once, to see what the program calls")
        self.seen: Observed = observe(self.layout, limit)
        self.program = [self.layout.relative(path) for path in self.layout.program]
        calls = without_doubles([call for call in self.seen.calls if call.sites])
        self.stood_in = [call.name for call in calls if call.target.startswith(ANY)]
        self.known: list[Known] = known_vocabularies(self.layout, calls)
        groups = compared_with(self.layout)
        self.named: list[Entry] = entries(self.seen.names)
        mine, rest = _by_side([call for call in calls if not call.facts["leads_to_names"]])
        ours, own = (
            [call for call in mine if not call.facts["own"]],
            [call for call in mine if call.facts["own"]],
        )
        self.found, self.others = proposals(self._new(ours), groups)
        if not self.found and not self.known and not self.named and own:  # program and robot share a file
            self.found, self.others = proposals([*ours, *own], groups)
        self._add_readings(rest, groups)
        if not self.found and not self.known and not self.named:
            self._fall_back()
        self.unreached: list[Unreached] = [
            *unused(self.seen.names),
            *unreached(self.layout, self._reached()),
        ]

    @property
    def vocabulary(self) -> list[str]:
        """Names for the configuration."""
        names = [one.name for one in self.known]
        return [*names, VOCABULARY] if self.found or self.named or not names else names

    @property
    def needs_vocabulary(self) -> bool:
        """Whether there is anything to say that no shipped vocabulary says."""
        return bool(self.found or self.named or self.others or self.unreached or not self.known)

    def _new(self, calls: Sequence[SeenCall]) -> list[SeenCall]:
        """Calls to be described here: those of shipped vocabularies only where nodes tell more."""
        shipped = [call for call in calls if any(one.describes(call) for one in self.known)]
        return [call for call in calls if call not in shipped or _says_more(call)]

    def _add_readings(self, rest: Sequence[SeenCall], groups: Sequence[Sequence[object]]) -> None:
        """Readings that only the tests take, and the files where they take any."""
        new = [one for one in proposals(self._new(rest), groups)[0] if one.is_reading and one.call.sites]
        known = {proposal.target: proposal for proposal in self.found}
        known.update((proposal.target, proposal) for proposal in new)
        self.found = list(known.values())
        targets = {proposal.target for proposal in self.found if proposal.is_reading}
        files = [
            file
            for call in self.seen.calls
            for file, _, _ in call.sites
            if call.target in targets or any(one.reads(call) for one in self.known)
        ]
        files += [file for entry in self.named if entry.of_tests for file in entry.files]
        self.oracle = [file for file in dict.fromkeys(files) if file not in self.program]

    def _fall_back(self) -> None:
        """Nothing looks like a robot's: what is called at all can be skipped and repeated."""
        for proposal in self.others:
            proposal.is_plain = not proposal.call.facts["problem"] and not proposal.call.facts["is_property"]
        self.found = [one for one in self.others if one.is_plain]
        self.others = [one for one in self.others if not one.is_plain]

    def _reached(self) -> list[tuple[str, int, str]]:
        made = [(file, line, call.name) for call in self.seen.calls for file, line, _ in call.sites]
        return [*made, *self.seen.reached]


def propose(
    root: Path,
    program: Sequence[Path] = (),
    *,
    limit: float = LIMIT,
    tell: Callable[[str], None] = lambda text: None,
) -> list[str]:
    """Write ``mutabot.toml`` and ``robot.toml``; the lines say what was found and what to do next.

    ``program`` are files or folders of the robot program, relative to the working folder or to ``root``;
    without any they are guessed. The tests are run once, for ``limit`` seconds at most, to see what the
    program calls; ``tell`` is told before. No existing file is touched.

    Raises UsageError if there is a configuration already, or no program.
    """
    root = root.resolve()
    _refuse_existing(root)
    found = _Look(root, program, limit, tell)
    text = _loadable(found)
    if found.needs_vocabulary:
        _write(root / VOCABULARY, text)
    _write(root / CONFIGURATION, _configuration(found))
    return _told(found)


def without_doubles(calls: Sequence[SeenCall]) -> list[SeenCall]:
    """Without methods of whatever has them where the robot's own was seen: a mock of it is one."""
    owned = {call.name for call in calls if not call.target.startswith(ANY) and call.facts["owner"]}
    return [call for call in calls if not (call.target.startswith(ANY) and call.name in owned)]


def _says_more(call: SeenCall) -> bool:
    return tells_commands(call) and any(guess.table for _, guess in commands_of(call))


def _by_side(calls: Sequence[SeenCall]) -> tuple[list[SeenCall], list[SeenCall]]:
    """What the program calls, and what only the tests do."""
    mine = [call for call in calls if not call.facts["of_tests"]]
    targets = {call.target for call in mine}
    return mine, [call for call in calls if call.target not in targets]


def _write(path: Path, text: str) -> None:
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise UsageError(f"cannot write {path}: {error.strerror or error}") from error


def _refuse_existing(root: Path) -> None:
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


def _loadable(found: _Look) -> str:
    """The vocabulary's text; what would not load, by a wrong guess, is a comment."""
    text = _text(found)
    if not (found.found or found.named) or _loads(text):
        return text
    for proposal in found.found:
        proposal.current = proposal.opposite = None
    kept = [proposal for proposal in found.found if _loads(vocabulary_text([proposal], [], found.program))]
    dropped = [proposal for proposal in found.found if proposal not in kept]
    found.found, found.others = kept, [*dropped, *found.others]
    for entry in found.named:
        entry.is_taken = _loads(vocabulary_text([], [], found.program, named=[entry]))
    return _text(found)


def _text(found: _Look) -> str:
    return vocabulary_text(found.found, found.others, found.program, found.unreached, found.named)


def _loads(text: str) -> bool:
    with TemporaryDirectory() as folder:
        (Path(folder) / VOCABULARY).write_text(text, encoding="utf-8")
        try:
            load([VOCABULARY], Path(folder))
        except ConfigurationError:
            return False
    return True


def _configuration(found: _Look) -> str:
    lines = [
        f"program = {_listed(found.program)}  # where the robot program's calls stand",
        *(
            [f"oracle = {_listed(found.oracle)}  # readings for the tests' own checks"]
            if found.oracle
            else []
        ),
        f"tests = {_listed(found.layout.arguments or ['tests'])}",
        *([f"pytest_args = {_listed(found.seen.extra)}"] if found.seen.extra else []),
        f"vocabulary = {_listed(found.vocabulary)}",
        "rounds = 1",
        "seed = 1",
    ]
    return "\n".join(lines) + "\n"


def _listed(names: Sequence[str]) -> str:
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


def _told(found: _Look) -> list[str]:
    how = " (guessed; name the files if that is wrong: mutabot init FILE…)" if found.layout.guessed else ""
    counts = ", ".join(f"{count} {outcome}" for outcome, count in found.seen.outcomes.items())
    lines = [f"program: {', '.join(found.program)}{how}"]
    if found.seen.trouble:
        lines.append(f"the tests could not be watched: {found.seen.trouble}")
    if counts:
        lines.append(f"tests: {counts}; {_counted(found)}")
    lines += [f"  {problem}" for problem in found.seen.problems[:3] if not found.seen.trouble]
    hint = ""
    if (found.layout.root / "pyproject.toml").exists():
        hint = "; its lines may as well stand in pyproject.toml, under [tool.mutabot]"
    lines.append(f"wrote {CONFIGURATION}{hint}")
    lines += [
        f"vocabulary {one.name}: comes with mutabot, describes {one.seen} of the calls" for one in found.known
    ]
    if found.needs_vocabulary:
        lines.append(_about_vocabulary(found))
    taken = [one.call.name for one in found.found if one.call.name in found.stood_in]
    if taken:
        text = "count for whatever object has them (method = …)"
        lines.append(f"the tests hand in mocks or fakes: {', '.join(taken)} {text}")
    return [*lines, _next(found)]


def _counted(found: _Look) -> str:
    mine, rest = _by_side([call for call in found.seen.calls if call.sites])
    calls = sum(call.count for call in mine)
    names = {(entry.key, entry.name) for entry in found.named if not entry.of_tests}
    return (
        f"the program calls {len(mine)} callables, {calls} times"
        + (f", the tests {len(rest)} more" if rest else "")
        + (f", and uses {len(names)} names of ROS" if names else "")
    )


def _about_vocabulary(found: _Look) -> str:
    commented = len(found.others) + len(found.unreached)
    more = "1 more call stands" if commented == 1 else f"{commented} more calls stand"
    also = f"; {more} there as comments" if commented else ""
    count = sum(entry.is_taken for entry in found.named) + len(found.found)
    if count:
        noun = "operation" if count == 1 else "operations"
        return f"wrote {VOCABULARY} with {count} {noun}, guessed from names and values{also}"
    if found.known:
        return f"wrote {VOCABULARY}, which is not used yet{also}"
    return f"wrote {VOCABULARY} without an operation: no call was seen{also}"


def _next(found: _Look) -> str:
    if found.found or found.named:
        return "next: correct the lines marked `guess`, then `mutabot check`, `mutabot list`, `mutabot run`"
    if found.known:
        return "next: `mutabot check`, `mutabot list`, `mutabot run`"
    names = " ".join(found.layout.arguments) or "tests"
    return (
        f"next: make `python -m pytest {names}` run tests that call the program, remove {CONFIGURATION} and "
        f"{VOCABULARY}, and run `mutabot init` again; or describe the robot by hand (docs/vocabulary.md)"
    )
