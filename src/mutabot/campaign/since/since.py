"""Since a revision: which mutants the changes can have altered, and what is taken over of the others.

A revision is seen as a campaign would have seen it: its files, configuration and vocabulary. Git is asked by
its own program: it is where there are revisions, and nothing else reads all repositories. Nothing is ever
written, not even the index.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.plan import Plan
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.reuse.keys import Dependencies, says_same
from mutabot.campaign.reuse.reuse import GONE, Earlier, Pair, Reused
from mutabot.campaign.reuse.snapshot import WRITTEN, State, counts_by_name, is_note, own_files
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load
from mutabot.errors import ConfigurationError, JournalError, UsageError
from mutabot.frozen import frozen
from mutabot.journal.files import find_journal
from mutabot.journal.journal import Journal
from mutabot.journal.lock import refuse_tracked
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import SINCE, Since
from mutabot.model import Mutant
from mutabot.model.codec import to_data

_OPTION = "--since"


@frozen
class Revision:
    """A revision of the repository that a project lies in.

    Attributes:
        project: the project's folder.
        top: the repository's folder.
        ref: the revision as the user named it.
        commit: its commit.
        changed: files of the repository, relative to it, that are not now as they were then, also untracked
            ones; and whether they were there.
    """

    project: Path
    top: Path
    ref: str
    commit: str
    changed: dict[str, bool]

    @classmethod
    def find(cls, project: Path, ref: str) -> Revision:
        """Look it up. Raises UsageError, saying what to do."""
        project = project.resolve()
        top = Path(
            _asked(project, "rev-parse", "--show-toplevel", why=f"{project} is in no repository of git")
        )
        commit = _commit(project, ref)
        told = _git(top, "diff", "--name-status", "--no-renames", "-z", commit, "--").decode(
            "utf-8", "replace"
        )
        words = told.split("\0")[:-1]
        changed = {name: status != "A" for status, name in zip(words[::2], words[1::2], strict=True)}
        for name in _words(top, "ls-files", "--others", "--exclude-standard", "-z"):
            changed.setdefault(name, False)
        return cls(project, top.resolve(), ref, commit, changed)

    @property
    def short(self) -> str:
        """``main (1a2b3c4)``."""
        abbreviated = self.commit[:7]
        return self.ref if self.ref.startswith(abbreviated) else f"{self.ref} ({abbreviated})"

    @property
    def prefix(self) -> str:
        """Where the project lies in the repository: empty, or a folder with a slash."""
        folder = self.project.relative_to(self.top).as_posix()
        return "" if folder == "." else f"{folder}/"

    def is_changed(self, path: Path) -> bool:
        """Whether a file is not as it was; one outside of the repository is taken for unchanged."""
        return self._name(path) in self.changed

    def read(self, path: Path) -> bytes | None:
        """What a file held then; None if it was not there. What lies outside of the repository is as now."""
        name = self._name(path)
        if name not in self.changed:
            try:
                return path.read_bytes()
            except OSError:
                return None
        if not self.changed[name]:
            return None
        return _git(self.top, "cat-file", "blob", f"{self.commit}:{name}")

    def gone(self) -> list[str]:
        """Files of the project, relative to it, that were there and are not any more."""
        here = [
            name for name, was_there in self.changed.items() if was_there and name.startswith(self.prefix)
        ]
        names = (name.removeprefix(self.prefix) for name in here)
        return [name for name in names if not (self.project / name).is_file()]

    def _name(self, path: Path) -> str:
        folder = path.parent.resolve()  # a link in the project is a file of its own
        try:
            return (folder / path.name).relative_to(self.top).as_posix()
        except ValueError:
            return ""


def _commit(project: Path, ref: str) -> str:
    if ref.startswith("-"):
        raise UsageError(f"{_OPTION} {ref}: that is no name of a revision")
    done = _run(project, "rev-parse", "--verify", "--quiet", f"{ref}^{{commit}}")
    if done.returncode == 0:
        return done.stdout.decode().strip()
    if _git(project, "rev-parse", "--is-shallow-repository").strip() == b"true":
        raise UsageError(
            f"{_OPTION} {ref}: this clone is shallow and does not hold that revision; fetch it: `git fetch "
            f"--unshallow`, in GitHub Actions `fetch-depth: 0` of actions/checkout, in GitLab `GIT_DEPTH: 0`"
        )
    hint = f"; `git fetch origin {ref}` and origin/{ref}?" if "/" not in ref else ""
    raise UsageError(f"{_OPTION} {ref}: git knows no such revision{hint}")


def _asked(folder: Path, *question: str, why: str) -> str:
    done = _run(folder, *question)
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").strip()
        if "dubious ownership" in said:
            raise UsageError(f"{_OPTION}: git refuses {folder}: {said.splitlines()[0]}")
        raise UsageError(f"{_OPTION}: {why}; without one, `mutabot run` itself runs what has changed")
    return done.stdout.decode("utf-8", "surrogateescape").removesuffix("\n")


def _words(folder: Path, *command: str) -> list[str]:
    """What git says, ended by zeros."""
    return _git(folder, *command).decode("utf-8", "surrogateescape").split("\0")[:-1]


def _git(folder: Path, *command: str) -> bytes:
    done = _run(folder, *command)
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").strip()
        raise UsageError(f"{_OPTION}: git {command[0]} failed: {said or f'exit code {done.returncode}'}")
    return done.stdout


def _run(folder: Path, *command: str) -> subprocess.CompletedProcess[bytes]:
    environment = {**os.environ, "GIT_OPTIONAL_LOCKS": "0", "LC_ALL": "C"}
    try:
        return subprocess.run(
            ["git", "-C", str(folder), *command], capture_output=True, check=False, env=environment
        )
    except OSError as error:
        raise UsageError(f"{_OPTION} needs git, which cannot be started: {error.strerror}") from error


_CONFIGURATIONS = ("mutabot.toml", "pyproject.toml")


def dependencies_then(
    revision: Revision, request: Request, baseline: Baseline, tests: Iterable[str], now: Dependencies
) -> Dependencies:
    """What the same outcomes depended on at a revision.

    Raises ConfigurationError where its configuration or vocabulary cannot be read.
    """
    files, texts = _files(revision, request.root, now)
    then = _request(revision, request, files, texts)
    for name in {*own_files(request), *own_files(then)} & files.keys():
        del files[name]
        texts.pop(name, None)
    return Dependencies(then, baseline, tests, State(files, texts, now.names), read=revision.read)


def _files(revision: Revision, root: Path, now: Dependencies) -> tuple[dict[str, str], dict[str, bytes]]:
    """The files with their digests, and what stood in the Python files."""
    files: dict[str, str] = {}
    texts: dict[str, bytes] = {}
    for name, digest in now.files.items():
        if revision.is_changed(root / name) and digest != WRITTEN:
            _add(files, texts, name, revision.read(root / name))
            continue
        files[name] = digest
        if name in now.texts:
            texts[name] = now.texts[name]
    for name in revision.gone():
        if counts_by_name(name) and not is_note(name):
            _add(files, texts, name, revision.read(root / name))
    return files, texts


def _add(files: dict[str, str], texts: dict[str, bytes], name: str, text: bytes | None) -> None:
    if text is None:
        return
    files[name] = f"#{hashlib.blake2b(text, digest_size=12).hexdigest()}"
    if name.endswith(".py"):
        texts[name] = text


def _request(
    revision: Revision, request: Request, files: Iterable[str], texts: Mapping[str, bytes]
) -> Request:
    """What the campaign would have been asked then."""
    configuration = request.configuration
    root = request.root
    own = {*_CONFIGURATIONS, *configuration.vocabulary}
    if not any(revision.is_changed(root / name) for name in own):
        return request
    with TemporaryDirectory(prefix="mutabot-since-") as folder:
        copy = Path(folder).resolve()
        for name in files:  # which files there are decides what a pattern of the configuration means
            _put(copy, name, texts.get(name, b""))
        for name in own:
            _put(copy, name, revision.read(root / name))
        try:
            then = load_configuration(copy, request.families)
            for name in {*then.vocabulary} - own:
                _put(copy, name, revision.read(root / name))
            vocabulary = load(then.vocabulary, copy, request.families)
        except (ConfigurationError, UsageError) as error:
            raise ConfigurationError(f"at {revision.short}: {error}") from error
    seed = then.seed if request.seed == configuration.seed else request.seed
    return replace(
        request, configuration=then.model_copy(update={"root": root}), vocabulary=vocabulary, seed=seed
    )


def _put(folder: Path, name: str, text: bytes | None) -> None:
    parts = PurePosixPath(name).parts
    if text is None or PurePosixPath(name).is_absolute() or ".." in parts:
        return
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text)


def open_others(request: Request, progress: Progress) -> list[JournalReader]:
    """The journal that was named beside the project's own, if it can be read.

    Raises UsageError if there is none and nothing else says what to run, and JournalError for one that git
    tracks.
    """
    if request.other_journal is None:
        return []
    path = find_journal(request.other_journal) if request.other_journal.is_dir() else request.other_journal
    own = request.journal_path
    if path.is_file() and own.is_file() and path.samefile(own):
        return []
    refuse_tracked(path)  # before all that might only be noted
    try:
        return [JournalReader.open(path)]
    except JournalError as error:
        if request.since is None:
            raise UsageError(f"--journal: {error}") from error
        progress.note(f"--journal: {error}; nothing is taken over from it")
        return []


def altered_since(
    revision: Revision,
    campaign: Campaign,
    tests: Iterable[str],
    now: Dependencies,
    mutants: Sequence[Mutant],
) -> dict[Pair, str]:
    """Mutants and rounds that the changes since a revision can have altered, and why."""
    request = campaign.request
    pairs = [(mutant, round) for round in range(request.rounds) for mutant in mutants]
    try:
        then = dependencies_then(revision, request, campaign.baseline, tests, now)
    except ConfigurationError as error:
        campaign.progress.note(f"{error}; so everything counts as changed")
        reason = f"the configuration of {revision.ref} cannot be read"
        return {(mutant.id, round): reason for mutant, round in pairs}
    earlier = Earlier(now, then.parts.get, reaches={then.tree: then.reach})
    return {
        (mutant.id, round): earlier.why(was, mutant, round)
        for mutant, round in pairs
        if not says_same(now.key(mutant, round), was := then.key(mutant, round))
    }


def only_altered(
    journal: Journal,
    revision: Revision,
    altered: Mapping[Pair, str],
    found: Reused,
    plan: Plan,
    rounds: int,
    progress: Progress,
) -> Plan:
    """The plan without mutants of which nothing is known nor run.

    What the changes cannot have altered is not run, also where no journal holds an outcome of it: ``found``
    says so from then on. An outcome that depends on all tests is run again as without a revision.
    """
    pairs = [(mutant.id, round) for round in range(rounds) for mutant in plan.mutants]
    again = {pair: why for pair, why in found.why.items() if why == GONE or pair in found.whole}
    why = {**altered, **again}
    left = [pair for pair in pairs if pair not in found.done and pair not in why]
    run = {pair: reason for pair, reason in why.items() if pair not in found.done}
    reasons = Counter(_why_not_taken(found, pair) for pair in left)
    since = Since(
        ref=revision.ref,
        commit=revision.commit,
        run=dict(Counter(run.values()).most_common()),
        taken_over=len(found.done),
        not_judged=dict(reasons.most_common()),
    )
    _tell(since, revision.short, progress)
    journal.set_meta(SINCE, to_data(since))
    known = {mutant for mutant, _ in found.done | run.keys()}
    kept = [mutant for mutant in plan.mutants if mutant.id in known]
    journal.keep_planned(known)
    found.done.update(left)
    return Plan(kept, plan.left_out, plan.drawing)


def _why_not_taken(found: Reused, pair: Pair) -> str:
    if pair in found.unsound:
        return "they ended in an error or unstable"
    return found.why.get(pair, "no journal holds an outcome of them")


def _tell(since: Since, short: str, progress: Progress) -> None:
    """Print what is run and what is not, by the kind of reason."""
    total = sum(since.run.values())
    unjudged = sum(since.not_judged.values())
    progress.note(
        f"since {short}: {total} to run, {since.taken_over} taken over"
        + (f", {unjudged} not judged" if unjudged else "")
    )
    for why, count in since.run.items():
        progress.note(f"  {count} to run: {why}")
    for why, count in since.not_judged.items():
        progress.note(f"  {count} not judged, though no change can have altered them: {why}")
