"""``mutabot init``: look at a project, write a configuration and a vocabulary, say what comes next."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from mutabot.errors import ConfigurationError, UsageError
from mutabot.vocabulary import load

from .operations import Proposal, proposals
from .resolve import Resolver
from .sources import Definition, Module, Sources, python_files
from .text import vocabulary_text
from .uses import Use, Uses

CONFIGURATION, VOCABULARY = "mutabot.toml", "robot.toml"
#: file names that say "this is a robot program", where there is a choice
_PROGRAM_NAMES = (
    "mission",
    "program",
    "main",
    "task",
    "job",
    "app",
    "process",
    "pick",
    "place",
    "pallet",
    "sort",
)


@dataclass(frozen=True)
class _Project:
    root: Path
    program: list[Path]
    tests: list[Path]
    sources: Sources
    resolver: Resolver


def propose(root: Path, program: Sequence[Path] = ()) -> list[str]:
    """Write ``mutabot.toml`` and ``robot.toml``; the lines say what was found and what to do next.

    ``program`` are files or folders of the robot program, relative to the working folder or to ``root``;
    without any they are guessed. Nothing is imported and no existing file is touched.

    Raises UsageError if there is a configuration already, or nothing to propose.
    """
    root = root.resolve()
    _refuse_existing(root)
    project = _look(root, program)
    names = [_relative(root, path) for path in project.program]
    uses = Uses(project.resolver, [project.sources.at(path) for path in project.program])
    if not proposals(list(uses.found.values()), project.resolver)[0]:
        raise UsageError(
            f"{', '.join(names) or root}: no call that looks like a robot's was found; name the files of the "
            "robot program: mutabot init FILE…"
        )
    oracle = _oracle(project)
    found, others = proposals([*uses.found.values(), *_only_new(oracle, uses)], project.resolver)
    others = [use for use in others if project.sources.is_local(use.definition.module)]
    _write(root / VOCABULARY, _loadable(found, others, names))
    _write(root / CONFIGURATION, _configuration(project, names, [_relative(root, path) for path in oracle]))
    return _next_steps(root, names, found, guessed=not program)


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


def _look(root: Path, given: Sequence[Path]) -> _Project:
    files = python_files(root)
    tests = [path for path in files if _is_test_side(path.relative_to(root))]
    chosen = _named(root, given) if given else []
    tests = [path for path in tests if path.resolve() not in chosen]
    code = [path for path in files if path not in tests and path.name not in ("setup.py", "noxfile.py")]
    test_folders = list(dict.fromkeys(path.parent for path in tests))
    sources = Sources([root, root / "src", *test_folders])
    program = chosen or _guess_program(sources, code)
    own = {path.resolve() for path in program}
    known: dict[str, Definition] = {}
    for path in code:
        if path.resolve() not in own:
            known.update(_classes(sources, path))
    return _Project(root, program, tests, sources, Resolver(sources, known))


def _is_test_side(path: Path) -> bool:
    in_folder = any(part in ("tests", "test", "testing", "features") for part in path.parts[:-1])
    return (
        in_folder
        or path.name.startswith("test_")
        or path.name.endswith("_test.py")
        or path.name == "conftest.py"
    )


def _named(root: Path, given: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in given:
        place = next((one for one in (path, root / path) if one.exists()), None)
        if place is None:
            raise UsageError(f"{path}: there is no such file or folder")
        if not place.resolve().is_relative_to(root):
            raise UsageError(f"{path} does not lie in {root}; -C names the project's folder")
        found += python_files(place) if place.is_dir() else [place]
    return list(dict.fromkeys(path.resolve() for path in found))


def _guess_program(sources: Sources, code: Sequence[Path]) -> list[Path]:
    """Files that use others of the project and are used by none."""
    modules = [module for path in code if (module := _read(sources, path)) is not None]
    imported = {name for module in modules for name in _imported(module)}
    using = [one for one in modules if _imported(one) & {other.name for other in modules} - {one.name}]
    free = [module for module in using or modules if module.name not in imported]
    telling = [module for module in free if any(word in module.path.stem for word in _PROGRAM_NAMES)]
    return [module.path for module in telling or free]


def _read(sources: Sources, path: Path) -> Module | None:
    try:
        return sources.at(path)
    except ConfigurationError:
        return None


def _imported(module: Module) -> set[str]:
    names = {source for source, _ in module.imports.values()}
    return names | {f"{source}.{inner}" for source, inner in module.imports.values() if inner}


def _classes(sources: Sources, path: Path) -> dict[str, Definition]:
    module = _read(sources, path)
    if module is None:
        return {}
    nodes = module.definitions.items()
    return {name: Definition(module, name, node) for name, node in nodes if isinstance(node, ast.ClassDef)}


def _oracle(project: _Project) -> dict[Path, list[Use]]:
    """Files on the tests' side that read from the robot or the cell, with those readings."""
    found = {}
    inside = {path.resolve() for path in (*project.program, *project.tests)}
    for path in project.tests:
        module = _read(project.sources, path)
        if module is None:
            continue
        uses = [
            use
            for use in Uses(project.resolver, [module]).found.values()
            if use.certain
            and project.sources.is_local(use.definition.module)
            and use.definition.module.path.resolve() not in inside
        ]
        proposed, _ = proposals(uses, project.resolver)
        targets = {proposal.target for proposal in proposed if proposal.is_reading}
        if targets:
            found[path] = [use for use in uses if use.definition.target in targets]
    return found


def _only_new(oracle: Mapping[Path, Sequence[Use]], uses: Uses) -> list[Use]:
    new = {use.definition.target: use for readings in oracle.values() for use in readings}
    return [use for target, use in new.items() if target not in uses.found]


def _loadable(found: list[Proposal], others: list[Use], names: Sequence[str]) -> str:
    """The vocabulary's text; what would not load is left out, which only a wrong guess can cause."""
    text = vocabulary_text(found, others, names)
    if _loads(text):
        return text
    for proposal in found:
        proposal.current = proposal.opposite = None
    kept = [proposal for proposal in found if _loads(vocabulary_text([proposal], [], names))]
    dropped = [Use(proposal.definition) for proposal in found if proposal not in kept]
    return vocabulary_text(kept, [*others, *dropped], names)


def _loads(text: str) -> bool:
    with TemporaryDirectory() as folder:
        (Path(folder) / VOCABULARY).write_text(text, encoding="utf-8")
        try:
            load([VOCABULARY], Path(folder))
        except ConfigurationError:
            return False
    return True


def _configuration(project: _Project, program: Sequence[str], oracle: Sequence[str]) -> str:
    tests = list(dict.fromkeys(path.relative_to(project.root).parts[0] for path in project.tests))
    lines = [
        f"program = {_listed(program)}  # where the robot program's calls stand",
        *([f"oracle = {_listed(oracle)}  # readings taken for the tests' own checks"] if oracle else []),
        f"tests = {_listed(tests or ['tests'])}",
        f'vocabulary = ["{VOCABULARY}"]',
        "rounds = 1",
        "seed = 1",
    ]
    return "\n".join(lines) + "\n"


def _listed(names: Sequence[str]) -> str:
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


def _relative(root: Path, path: Path) -> str:
    return path.resolve().relative_to(root).as_posix()


def _next_steps(root: Path, names: Sequence[str], found: Sequence[Proposal], *, guessed: bool) -> list[str]:
    how = " (guessed; name the files if that is wrong: mutabot init FILE…)" if guessed else ""
    hint = ""
    if (root / "pyproject.toml").exists():
        hint = "; its lines may as well stand in pyproject.toml, under [tool.mutabot]"
    return [
        f"program: {', '.join(names)}{how}",
        f"wrote {CONFIGURATION}{hint}",
        f"wrote {VOCABULARY} with {len(found)} operations, all guessed from names",
        "next: correct the lines marked `guess`, then `mutabot check`, `mutabot list`, `mutabot run`",
    ]
