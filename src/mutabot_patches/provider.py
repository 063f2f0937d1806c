"""Plans patches: a mutant for each unified diff that applies to the project."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from mutabot.api.faults import (
    Activation,
    FaultProvider,
    Original,
    Planned,
    PlannedMutant,
    ProgramText,
    Project,
    Rule,
    Site,
    TextPlace,
)
from mutabot.api.reports import UsageError

from .applying import HunkExtent
from .changes import Patch, read_patch
from .diffs import PatchError
from .extension import FAMILY, PROVIDER, TABLE
from .functions import ChangedFunction, changed_functions, extent_of, first_statement
from .suite import FilesOfTests
from .tables import PatchesTable

ACTIVE = "mutabot_patches.active:PatchedFiles"
_SUFFIXES = (".patch", ".diff")
#: families beside which functions may be looked at: the text of a file has the places of one provider
_BESIDE = {FAMILY, "robot", "graded", "catalogue", "middleware", "world"}


class ApplyPatch(Rule):
    """Files of the project are as a patch makes them: several lines, in several files, files of data too.

    Where: what unified diffs of the project's folder of patches change.

    Stands for: Whatever the patches are: bugs that were found, fixes that were reverted, faults that people
    or programs wrote.
    """

    name = "patch"
    family = FAMILY


@dataclass(frozen=True, slots=True)
class _PatchToPlan:
    """A patch that applies to the program.

    Attributes:
        name: of its file, relative to the project.
        patch: what it makes of files.
        functions: by path, the functions that differ, if nothing else does; else empty.
        beginnings: where these functions begin: file, extent of the first statement, qualified name.
    """

    name: str
    patch: Patch
    functions: Mapping[str, tuple[ChangedFunction, ...]]
    beginnings: tuple[tuple[str, HunkExtent, str], ...]

    @classmethod
    def of(cls, name: str, patch: Patch) -> _PatchToPlan:
        """Find out what a patch changes."""
        functions = _functions(patch)
        found = list[tuple[str, HunkExtent, str]]()
        for file in patch.files if functions else ():
            tree = ast.parse(file.before or b"")
            for function in functions[file.path]:
                node = first_statement(tree, function)
                if node is None:
                    return cls(name, patch, {}, ())
                found.append((file.path, extent_of(node), function.name))
        return cls(name, patch, functions, tuple(found))


class PatchFaults(FaultProvider):
    """Provides patches of the project's files."""

    name = PROVIDER
    families = (FAMILY,)
    location = "patch"

    def rules(self) -> Sequence[Rule]:
        """Return the only operator, which is used for every patch."""
        return [ApplyPatch()]

    def texts(self, project: Project, first: int, notify: Callable[[str], None]) -> Sequence[ProgramText]:
        """Return the places where changed functions begin, to find out which tests call them."""
        if not set(project.families) <= _BESIDE:
            return ()
        patches = [patch for _, patch in _read_all(project, ()) if isinstance(patch, _PatchToPlan)]
        return _places(patches, project.root, first)

    def plan(self, project: Project, original: Original) -> Planned:
        """Return a mutant for each patch; those that do not apply are left out, with the reason."""
        tests = [test for each in original.tests for test in each]
        planned = Planned()
        found = list(_read_all(project, tests))
        looked_at = original.texts.get(self.name, ())
        known = {(text.file, place.extent): place.number for text in looked_at for place in text.places}
        for file, patch in found:
            if isinstance(patch, _PatchToPlan):
                self._plan_one(planned, patch, original, known)
            else:
                site = Site.of_parameter(file, "patch")
                planned.mutants.append(PlannedMutant(self.mutant(ApplyPatch(), site, file), str(patch)))
        return planned

    def _plan_one(
        self,
        planned: Planned,
        patch: _PatchToPlan,
        original: Original,
        known: Mapping[tuple[str, HunkExtent], int],
    ) -> None:
        files = patch.patch.files
        hunks = [(file.path, extent) for file in files for extent in file.extents]
        site = Site.of_patch(patch.name, hunks)
        contents = {file.path: file.after.decode("latin-1") for file in files}
        reaching = _reaching(patch, original, known)
        functions = {
            path: [[each.name, each.old, each.new] for each in found]
            for path, found in patch.functions.items()
            if reaching is not None
        }
        keys = (Activation.EACH_TEST,) if reaching is not None else ()
        data = {"files": contents, "functions": functions}
        active = Activation(ACTIVE, data, keys, Activation.AT_ONCE)
        mutant = self.mutant(ApplyPatch(), site, _description(patch))
        does = {path: sha256(text.encode()).hexdigest() for path, text in contents.items()}
        planned.mutants.append(PlannedMutant(mutant, does=does, active=active))
        for round, tests in enumerate(original.tests):
            planned.reach(round, site, tests if reaching is None else reaching[round])


def _read_all(project: Project, tests: Iterable[str]) -> Iterator[tuple[str, _PatchToPlan | PatchError]]:
    """Yield a project's patches by name; a PatchError for one that makes no mutant."""
    suite = FilesOfTests(tests, project.program_files())
    table = project.tables.get(TABLE)
    # who asks for several families need not have the usual folder
    is_wanted = table is not None or {*project.families} == {FAMILY} or _has_folder(project)
    for path in files_of(table or PatchesTable(), project.root) if is_wanted else ():
        name = path.relative_to(project.root).as_posix()
        try:
            patch = read_patch(path.read_bytes(), project.root, suite.has)
            yield name, _PatchToPlan.of(name, patch)
        except OSError as error:
            yield name, PatchError(f"it cannot be read: {error.strerror or error}")
        except PatchError as error:
            yield name, error


def _has_folder(project: Project) -> bool:
    """Return whether the default folder of patches exists."""
    return (project.root / PatchesTable().files[0]).exists()


def files_of(table: PatchesTable, root: Path) -> list[Path]:
    """Return the files of patches, in order. Raises UsageError if there are none."""
    found = dict[Path, None]()
    for pattern in table.files:
        if Path(pattern).is_absolute() or ".." in Path(pattern).parts:
            raise UsageError(f"[tool.mutabot.{TABLE}] files: {pattern!r} is not in the project's folder")
        if (root / pattern).is_dir():
            fitting = [path for path in (root / pattern).rglob("*") if path.suffix in _SUFFIXES]
        else:
            fitting = [path for path in root.glob(pattern) if path.is_file()]
        if not fitting:
            raise UsageError(
                f"[tool.mutabot.{TABLE}] files: {pattern!r} fits no patch of the project; it is a file, a "
                "pattern, or a folder with files *.patch or *.diff"
            )
        found.update(dict.fromkeys(sorted(fitting)))
    return list(found)


def _functions(patch: Patch) -> dict[str, tuple[ChangedFunction, ...]]:
    """Return the functions that a patch changes, by path; empty if it changes anything else."""
    found = dict[str, tuple[ChangedFunction, ...]]()
    for file in patch.files:
        functions = None
        if file.path.endswith(".py") and file.before is not None:
            with suppress(SyntaxError, ValueError):
                functions = changed_functions(file.before, file.after, file.path)
        if functions is None:
            return {}
        found[file.path] = functions
    return found


def _places(patches: Sequence[_PatchToPlan], root: Path, first: int) -> list[ProgramText]:
    """Return the texts with a place where each function begins."""
    found = dict[str, dict[HunkExtent, str]]()
    for patch in patches:
        for file, extent, name in patch.beginnings:
            found.setdefault(file, {}).setdefault(extent, name)
    texts, number = list[ProgramText](), first
    for file, names in found.items():
        content = (root / file).read_bytes()
        statements = (node for node in ast.walk(ast.parse(content)) if isinstance(node, ast.stmt))
        kinds = {extent_of(statement): type(statement).__name__ for statement in statements}
        places = [
            TextPlace(
                n, Site.in_program(file, extent, name, name).span, name, 1, kinds[extent], statement=True
            )
            for n, (extent, name) in enumerate(names.items(), start=number)
        ]
        number += len(places)
        texts.append(ProgramText.of(file, content, places, {}))
    return texts


def _reaching(
    patch: _PatchToPlan, original: Original, known: Mapping[tuple[str, HunkExtent], int]
) -> list[list[str]] | None:
    """Return the tests of each round that call what a patch changes, also in processes below the tests.

    None if a process that runs cannot become the mutant, or if who calls it is not known: tests that read a
    file as text need not call what stands in it.
    """
    numbers = {known.get((file, extent)) for file, extent, _ in patch.beginnings}
    is_unknown = not numbers or None in numbers or len(original.text) < len(original.tests)
    files = {file.path for file in patch.patch.files}
    if is_unknown or files & {*original.refused_files()} or any(map(original.is_read, files)):
        return None
    found = list[list[str]]()
    for round, tests in enumerate(original.tests):
        seen = original.text[round]
        by_test = (pair for each in (seen.reached, *seen.below.values()) for pair in each.items())
        reached = {test for test, places in by_test if numbers & {*places}}
        if "" in reached:
            return None
        found.append([test for test in tests if test in reached])
    return found


def _description(patch: _PatchToPlan) -> str:
    title = f": {patch.patch.title}" if patch.patch.title else ""
    notes = f" ({', '.join(patch.patch.notes)})" if patch.patch.notes else ""
    return f"{patch.name}{title}{notes}"
