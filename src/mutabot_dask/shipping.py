"""What of a project is sent to workers: what git tracks, and what the configuration names.

Nothing else leaves this machine, since a project's folder also holds what nobody means to give away: keys,
passwords, the robot's own addresses. Where there is no repository, nobody has said what may be given away;
then it is program text and the kinds of files that robots are described in, without hidden ones and those
named like secrets.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath

from mutabot.campaign.reuse.snapshot import _is_folder_of_project
from mutabot.config.configuration import Configuration
from mutabot.errors import ClusterError
from mutabot.journal.files import HOME
from mutabot.repository import GitError, repository_of, tracked, unignored

from .settings import ClusterTable

#: files, in the project and above it, by which pytest finds its bearings
BEARINGS = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")
#: what is sent of a project that lies in no repository
_KINDS = {
    ".py", ".pyi", ".feature", ".urdf", ".xacro", ".srdf", ".sdf", ".mjcf", ".xml", ".stl", ".obj", ".dae",
    ".msg", ".srv", ".action", ".launch", ".rviz", ".sh", ".png", ".jpg", ".npy", ".npz", ".csv",
}  # fmt: skip
#: what Python makes by itself is not worth a word
_MADE = (".pyc", ".pyo")
_NO_MODULE = re.compile(r"No module named '([\w.]+)'")


@dataclass(frozen=True)
class Shipment:
    """The files that go to workers.

    Attributes:
        root: the project's folder.
        top: the highest folder with a file that goes along; the project's own, or one above it.
        files: paths of files and links, below ``top``.
        folders: folders without any of these, which tests may write to.
        left_out: files of the project, relative to it, that stay here.
        is_tracked: whether git says what the project consists of.
    """

    root: Path
    top: Path
    files: tuple[Path, ...]
    folders: tuple[Path, ...]
    left_out: tuple[str, ...]
    is_tracked: bool

    @classmethod
    def of(cls, root: Path, named: Iterable[str] = (), further: Iterable[str] = ()) -> Shipment:
        """What goes of the project in ``root``, which is a path without links.

        Args:
            root: the project's folder.
            named: what the configuration says the program and its tests are made of: of folders only Python
                files are taken.
            further: what the configuration names to be sent as well; patterns may be used.

        Raises ClusterError where git cannot tell what it tracks.
        """
        try:
            return cls._of(root, [*named], [*further])
        except GitError as error:
            why = "workers are sent the files that git tracks, and these cannot be listed"
            raise ClusterError(f"{why}: {error}") from error

    @classmethod
    def _of(cls, root: Path, named: list[str], further: list[str]) -> Shipment:
        repository = repository_of(root)
        known = tracked(root) if repository is not None else []
        chosen = {name for name in known if _is_there(root, name)}
        more = unignored(root) if known else _kinds_in(root)
        folders = [name for name in named if (root / name).is_dir()]
        chosen.update(name for name in named if _is_there(root, name))
        chosen.update(name for name in BEARINGS if (root / name).is_file())
        if known:
            chosen.update(name for name in more if name.endswith(".py") and _is_below(name, folders))
        else:
            chosen.update(more)
        chosen.update(_further(root, further))
        chosen = {name for name in chosen if PurePosixPath(name).parts[0] != HOME}
        above = _above(root, repository if known else None)
        files = sorted([*(root / name for name in chosen), *above])
        top = min((path.parent for path in above), key=lambda path: len(path.parts), default=root)
        left_out = sorted(set(_all_files(root)) - chosen)
        return cls(root, top, tuple(files), tuple(_empty(root, chosen)), tuple(left_out), bool(known))

    @classmethod
    def of_configuration(cls, configuration: Configuration) -> Shipment:
        """What goes of a configured project. Raises ClusterError where git cannot tell."""
        return cls.of(configuration.root, _named(configuration), ClusterTable.of(configuration).files)

    @cached_property
    def suspicious(self) -> tuple[str, ...]:
        """Files that go, relative to the project, though they are named like secrets."""
        names = (Path(os.path.relpath(path, self.root)).as_posix() for path in self.files)
        return tuple(name for name in names if may_be_secret(name))

    @property
    def folders_left_out(self) -> set[str]:
        """The folders that have files which stay here, relative to the project."""
        return {PurePosixPath(name).parent.as_posix() for name in self.left_out}

    def missed(self, opened: Iterable[str]) -> list[str]:
        """Files that stay here though tests open them."""
        return sorted(set(self.left_out) & set(opened))

    def named_in(self, text: str) -> list[str]:
        """Files that stay here, of those that a message names: as a file, or as a module to import."""
        modules = {name.replace(".", "/") for name in _NO_MODULE.findall(text)}
        ends = tuple(f"/{module}{end}" for module in modules for end in (".py", "/__init__.py"))
        return [
            name for name in self.left_out if _stands_in(name, text) or (ends and f"/{name}".endswith(ends))
        ]


def _named(configuration: Configuration) -> list[str]:
    """Paths that the configuration names, as far as they are there."""
    words = [argument.partition("::")[0] for argument in configuration.tests]
    options = [option.partition("=")[2] or option for option in configuration.pytest_args]
    files = [*configuration.vocabulary, *options, configuration.file, configuration.selection or ""]
    root = configuration.root
    return [
        *configuration.program, *configuration.oracle, *(word for word in words if _is_path(root, word)),
        *(name for name in files if _is_path(root, name) and (root / name).is_file()),
    ]  # fmt: skip


def _is_path(root: Path, name: str) -> bool:
    """Whether a word names something in the project."""
    if not name or "\0" in name or name.startswith(("-", "/", "~")) or ".." in PurePosixPath(name).parts:
        return False
    try:
        return (root / name).exists()
    except OSError:
        return False  # too long for a name


def _further(root: Path, patterns: Iterable[str]) -> Iterator[str]:
    """The files that patterns name; of folders without what is hidden or named like a secret."""
    for pattern in patterns:
        for path in [root / pattern] if os.path.lexists(root / pattern) else sorted(root.glob(pattern)):
            name = path.relative_to(root).as_posix()
            if path.is_symlink() and path.resolve().is_relative_to(root):  # a link goes as a link
                path = path.resolve()  # noqa: PLW2901
                yield name
                name = path.relative_to(root).as_posix()
            if not path.is_dir():
                yield name
                continue
            for inner in _all_files(path):
                if not _is_hidden(inner) and not may_be_secret(inner):
                    yield f"{name}/{inner}" if name != "." else inner


def _kinds_in(root: Path) -> list[str]:
    return [
        name
        for name in _all_files(root)
        if PurePosixPath(name).suffix.lower() in _KINDS and not _is_hidden(name) and not may_be_secret(name)
    ]


def _is_hidden(name: str) -> bool:
    return any(part.startswith(".") for part in PurePosixPath(name).parts)


def _is_below(name: str, folders: Iterable[str]) -> bool:
    path = PurePosixPath(name)
    return any(path.is_relative_to(folder) for folder in folders)


def _is_there(root: Path, name: str) -> bool:
    """Whether there is a file or a link. Git also tells of folders: of repositories of their own."""
    path = root / name
    return path.is_symlink() or path.is_file()


def _above(root: Path, repository: Path | None) -> list[Path]:
    """In folders above the project, what tells pytest how to run; in a repository only what git tracks."""
    found = []
    for folder in root.parents if repository != root else ():
        if folder == folder.parent:
            break
        there = [folder / name for name in BEARINGS if (folder / name).is_file()]
        if there and repository is not None:
            known = set(tracked(folder, *(path.name for path in there)))
            there = [path for path in there if path.name in known]
        found += there
        if folder == repository:
            break
    return found


def _all_files(root: Path) -> Iterator[str]:
    """Every file and link of the project, bar those in hidden folders, environments and caches."""
    for folder, folders, names in os.walk(root):
        here = Path(folder)
        inner = here.relative_to(root).as_posix()
        links = [name for name in folders if (here / name).is_symlink()]
        folders[:] = sorted(name for name in folders if _is_folder_of_project(here / name))
        for name in sorted([*names, *links]):
            if not name.endswith(_MADE):
                yield name if inner == "." else f"{inner}/{name}"


def _empty(root: Path, files: Iterable[str]) -> Iterator[Path]:
    """Folders of the project without any of these files."""
    holding = {parent.as_posix() for name in files for parent in PurePosixPath(name).parents}
    for folder, folders, _ in os.walk(root):
        here = Path(folder)
        folders[:] = sorted(
            name for name in folders if _is_folder_of_project(here / name) and not (here / name).is_symlink()
        )
        if here.relative_to(root).as_posix() not in holding and here != root:
            yield here


def _stands_in(name: str, text: str) -> bool:
    """Whether a text names a file: in full, or by its last part as a word of its own."""
    last = re.escape(PurePosixPath(name).name)
    return re.search(rf"(?<![\w.-]){last}(?![\w.-]*\w)", text) is not None


_NAMES = re.compile(
    r"""
      (\.env|\.envrc)(\..*)? | .*\.env
    | [._]netrc | \.(pypirc|npmrc|yarnrc|pgpass|htpasswd|git-credentials|my\.cnf|s3cfg|boto|dockercfg)
    | id_(rsa|dsa|ecdsa|ed25519)(_sk)? | .*\.(pem|key|p12|pfx|jks|keystore|kdbx|ppk|asc|gpg|ovpn)
    | \.?(secrets?|credentials?|passwords?|passwd)([._-].*)?
    | .*[._-](secrets?|credentials?|passwords?)(\..*)?
    | service[_-]?account.*\.json | rootkey\.csv | kubeconfig
    """,
    re.VERBOSE | re.IGNORECASE,
)
#: folders in which tools keep what lets them in
_FOLDERS = {".ssh", ".aws", ".gnupg", ".kube", ".azure", ".gcloud", ".docker", ".config"}
#: what is meant to be filled in
_SAMPLES = re.compile(r".*\.(example|sample|template|dist|pub)", re.IGNORECASE)


def may_be_secret(name: str) -> bool:
    """Whether a file of this name, relative to the project, is of the kind that holds secrets."""
    *folders, last = PurePosixPath(name).parts
    if _SAMPLES.fullmatch(last):
        return False
    return bool(_NAMES.fullmatch(last)) or not _FOLDERS.isdisjoint(folders)
