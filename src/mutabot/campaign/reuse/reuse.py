"""Decide which outcomes of earlier campaigns still hold, and why the others are run again.

What is taken over names lines as they are now. Since a revision, only those mutants are run that the changes
can have altered. A revision is seen as a campaign would have seen it. Git is asked by its own program: it is
where there are revisions, and nothing else reads all repositories.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.reuse.keys import Dependencies, PastDependencies
from mutabot.campaign.reuse.parts import tool_table
from mutabot.campaign.reuse.source_tree import SourceTree
from mutabot.errors import JournalError, UsageError, in_short
from mutabot.frozen import frozen
from mutabot.journal.files import find_journal, refuse_tracked
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import SINCE, Kept, Since
from mutabot.model import Mutant, Verdict
from mutabot.repository import GitError, git, unignored

from .snapshot import WRITTEN, State, counts_by_name, digest_of, is_note, is_source, own_files, read

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign, RunId
    from mutabot.campaign.plan import Plan
    from mutabot.campaign.request import Progress, Request
    from mutabot.journal.journal import Journal

#: names that are given before it is said how many more there are
_SHOWN = 3


class Earlier:
    """The outcomes in a journal, and their dependencies.

    Args:
        now: what outcomes depend on now.
        journal: the journal.
    """

    def __init__(self, now: Dependencies, journal: JournalReader) -> None:
        self.kept = journal.found()
        self._now, self._journal = now, journal
        parts = cache(journal.parts)
        tree = cache(lambda digest: SourceTree(parts(digest) or {}, lambda name, text: journal.text(text)))
        #: what an outcome with this key depended on
        self.was = cache(lambda key: now.was(key, parts, tree))

    def why(self, pair: RunId, mutant: Mutant, *, is_known: bool = True) -> str | None:
        """Return why an existing outcome may be different now; None if it still holds."""
        names = self._now.why(self.was(self.kept[pair].key), mutant, pair[1], is_known=is_known)
        return in_short(names) if names else None

    def row(self, pair: RunId, mutant: Mutant) -> Kept | None:
        """Return an outcome with its current lines; None if its source line no longer exists."""
        row = self._journal.row(*pair)
        if row is None:
            return None
        was = self.was(row.key)
        data = was.tree.moved(row.data, self._now.tree)
        if data is None:
            return None
        return replace(row, data=data, key=self._now.renewed(row.key, was, mutant, row.round))

    def is_unasked(self, row: Kept, mutant: Mutant) -> bool:
        """Return whether only tests that do not reach this survivor could notice what changed."""
        some, all = (self._now.tests(mutant, row.round, whole=whole) for whole in (False, True))
        if row.verdict != Verdict.SURVIVED or len(some) == len(all):
            return False
        return self.was(self.kept[row.mutant, row.round].key).tree.unit_digests != self._now.tree.unit_digests


#: why an outcome is not taken over although it holds, or although nothing that it depends on has changed
GONE, _UNSOUND = "a line that they name is gone", "they ended in an error or unstable"


@dataclass(slots=True)
class Reused:
    """The outcomes of earlier campaigns: those that were reused, and why others were not.

    Attributes:
        done: mutants, by id, and rounds whose outcomes are taken over.
        why: of the others that there are outcomes of, why these do not hold.
        unsound: of which there are outcomes that say nothing.
        first: how many there are none of.
        before: what the others were that do not hold.
        unasked: how many that are taken over are survivors that some tests do not reach, while something has
            changed that only these could notice.
        sources: what the journals hold.
    """

    done: set[RunId] = field(default_factory=set)
    why: dict[RunId, str] = field(default_factory=dict)
    unsound: set[RunId] = field(default_factory=set)
    first: int = 0
    before: dict[RunId, Verdict] = field(default_factory=dict)
    unasked: int = 0
    sources: Sequence[Earlier] = ()


def reuse(
    journal: Journal,
    dependencies: Dependencies,
    mutants: Sequence[Mutant],
    rounds: int,
    progress: Progress,
    others: Sequence[JournalReader] = (),
) -> Reused:
    """Reuse the outcomes that still hold, and report why the others do not.

    Args:
        others: journals of other campaigns of this project, to be looked into beside its own.
    """
    sources = [Earlier(dependencies, source) for source in (journal, *others)]
    found = Reused(sources=sources)
    if not any(source.kept for source in sources):
        found.first = rounds * len(mutants)
        return found
    pairs = [(mutant, round) for round in range(rounds) for mutant in mutants]
    taken = [_taken(found, mutant, round) for mutant, round in pairs]
    journal.add_parts(dependencies.new_parts())
    journal.take_over(row for row in taken if row is not None)
    progress.note(reuse_text(found))
    if found.unasked:
        progress.note(
            f"{found.unasked} of them are survivors that tests do not reach which may have changed: "
            "these are not asked again; `mutabot run --fresh` asks all"
        )
    return found


def _taken(found: Reused, mutant: Mutant, round: int) -> Kept | None:
    """Reuse an outcome from the first source in which it holds; if there is none, note why."""
    pair = (mutant.id, round)
    first: str | None = None
    for earlier in found.sources:
        outcome = earlier.kept.get(pair)
        if outcome is None:
            continue
        why = earlier.why(pair, mutant)
        if why is None and not outcome.is_sound:
            found.unsound.add(pair)
        elif why is None:
            row = earlier.row(pair, mutant)
            if row is not None:
                found.done.add(pair)
                found.unsound.discard(pair)
                found.unasked += earlier.is_unasked(row, mutant)
                return row
            first = first or GONE
        elif first is None:
            first = why
            found.before[pair] = outcome.verdict
    if first is not None:
        found.why[pair] = first
    elif pair not in found.unsound:
        found.first += 1
    return None


def note_outdated(journal: Journal, request: Request, dependencies: Dependencies) -> None:
    """Find out which mutants of earlier campaigns depend on something that has changed since."""
    known = [mutant for mutant, _ in journal.known()]
    if not known:
        return
    earlier = Earlier(dependencies, journal)

    def is_outdated(mutant: Mutant) -> bool:
        pairs = [(mutant.id, round) for round in range(request.rounds)]
        is_known = mutant.family in request.families
        return any(
            pair not in earlier.kept or earlier.why(pair, mutant, is_known=is_known) is not None
            for pair in pairs
        )

    journal.set_known([(mutant, is_outdated(mutant)) for mutant in known])


def reuse_text(found: Reused) -> str:
    """Describe how many outcomes were reused, and why the rest was not."""
    reused = len(found.done)
    planned = len(found.done) + len(found.why) + len(found.unsound - found.why.keys()) + found.first
    if reused == planned:
        return f"reused all {planned} outcomes: nothing that they depend on has changed"
    parts = [f"reused {reused} of {planned} outcomes"]
    parts += describe_reasons(found.why.values())
    unsound = len(found.unsound - found.why.keys())
    if unsound:
        parts.append(f"{unsound} run again: {_UNSOUND}")
    if found.first:
        is_all = not (reused or found.why or unsound)
        parts.append(f"{found.first} {'run for the first time' if is_all else 'not run before'}")
    return "; ".join(parts)


def describe_reasons(why: Iterable[str]) -> list[str]:
    """Describe how many mutants are run again, by reason."""
    counts = Counter(why)
    parts = [f"{count} run again: {reason}" for reason, count in counts.most_common(_SHOWN)]
    rest = sum(count for _, count in counts.most_common()[_SHOWN:])
    return [*parts, *([f"{rest} run again for other reasons"] if rest else [])]


_OPTION = "--since"


@frozen
class Revision:
    """A revision of the repository that contains a project.

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
        """Look up a revision. Raises UsageError, saying what to do."""
        project = project.resolve()
        try:
            top = Path(_text(project, "rev-parse", "--show-toplevel").removesuffix("\n"))
        except _FailedError as error:
            hint = "without a revision, `mutabot run` itself runs what has changed"
            raise UsageError(f"{_OPTION}: {project} is in no repository of git ({error}); {hint}") from error
        commit = _commit(project, ref)
        fields = _text(top, "diff", "--name-status", "--no-renames", "-z", commit, "--").split("\0")[:-1]
        changed = {name: status != "A" for status, name in zip(fields[::2], fields[1::2], strict=True)}
        for name in unignored(top):
            changed.setdefault(name, False)
        return cls(project, top.resolve(), ref, commit, changed)

    @property
    def short(self) -> str:
        """``main (1a2b3c4)``."""
        abbreviated = self.commit[:7]
        return self.ref if self.ref.startswith(abbreviated) else f"{self.ref} ({abbreviated})"

    def is_changed(self, path: Path) -> bool:
        """Return whether a file has changed; one outside of the repository is assumed unchanged."""
        return self._name(path) in self.changed

    def read(self, path: Path) -> bytes | None:
        """Return a file's content at this revision; None if there was none. Outside files are read as now."""
        name = self._name(path)
        if name not in self.changed:
            return read(path)
        return _git(self.top, "cat-file", "blob", f"{self.commit}:{name}") if self.changed[name] else None

    def gone(self) -> list[str]:
        """Return the files of the project, relative to it, that existed then and do not now."""
        folder = self.project.relative_to(self.top).as_posix()
        prefix = "" if folder == "." else f"{folder}/"
        there = (name for name, was_there in self.changed.items() if was_there and name.startswith(prefix))
        return [name for file in there if not (self.project / (name := file.removeprefix(prefix))).is_file()]

    def _name(self, path: Path) -> str:
        folder = path.parent.resolve()  # a link in the project is a file of its own
        try:
            return (folder / path.name).relative_to(self.top).as_posix()
        except ValueError:
            return ""


def _commit(project: Path, ref: str) -> str:
    if ref.startswith("-"):
        raise UsageError(
            f"{_OPTION} {ref}: that is not the name of a revision; write a branch, a tag or a commit"
        )
    try:
        return _text(project, "rev-parse", "--verify", "--quiet", f"{ref}^{{commit}}").strip()
    except _FailedError as error:
        if _text(project, "rev-parse", "--is-shallow-repository").strip() == "true":
            raise UsageError(
                f"{_OPTION} {ref}: this clone is shallow and does not hold that revision; fetch it: `git "
                "fetch --unshallow`, in GitHub Actions `fetch-depth: 0` of actions/checkout, in GitLab "
                "`GIT_DEPTH: 0`"
            ) from error
        hint = f"; `git fetch origin {ref}` and origin/{ref}?" if "/" not in ref else ""
        raise UsageError(f"{_OPTION} {ref}: git does not know this revision{hint}") from error


class _FailedError(UsageError):
    """Raised if git fails."""


def _text(folder: Path, *command: str) -> str:
    return _git(folder, *command).decode("utf-8", "surrogateescape")


def _git(folder: Path, *command: str) -> bytes:
    """Run git and return its output. Raises UsageError if it fails."""
    try:
        done = git(folder, *command)
    except GitError as error:
        raise UsageError(f"{_OPTION} needs git: {error}") from error
    if done.returncode:
        message = done.stderr.decode("utf-8", "replace").strip()
        raise _FailedError(f"{_OPTION}: git {command[0]}: {message or f'exit code {done.returncode}'}")
    return done.stdout


def _then(revision: Revision, campaign: Campaign, now: Dependencies) -> Dependencies:
    """Return the dependencies of the same outcomes at a revision, if its configuration was that of now."""
    root = campaign.request.root

    def digests_then(known: Mapping[str, str]) -> dict[str, str]:
        other = {
            name: revision.read(root / name)
            for name, digest in known.items()
            if digest != WRITTEN and revision.is_changed(root / name)
        }
        same = {name: digest for name, digest in known.items() if name not in other}
        return same | {name: digest_of(text) for name, text in other.items() if text is not None}

    gone = {name: "" for name in revision.gone() if counts_by_name(name) and not is_note(name)}
    own = own_files(campaign.request)
    files = digests_then({**now.files, **{name: digest for name, digest in gone.items() if name not in own}})
    texts = {name: revision.read(root / name) or b"" for name in files if is_source(name, campaign.request)}
    tree = SourceTree({name: files[name] for name in texts}, lambda name, digest: texts[name])
    absent = {test for _, test in campaign.baseline.ends if not now.is_of(test, tree)}
    state = State(files, digests_then(now.notes), texts)
    return Dependencies(campaign.request, campaign.baseline, state, now.installed, revision.read, absent)


def _other_configuration(revision: Revision, request: Request) -> str | None:
    """Return a file of the configuration or vocabulary that differs from now; None if all are equal."""
    files = [request.configuration.file, *request.configuration.vocabulary]
    changed = [name for name in files if revision.is_changed(request.root / name)]
    for name in changed:
        texts = revision.read(request.root / name), read(request.root / name)
        tables = [tool_table(text, "mutabot") if name == "pyproject.toml" else text for text in texts]
        if tables[0] != tables[1]:
            return name
    return None


def open_others(request: Request, progress: Progress) -> list[JournalReader]:
    """Open the journal that was named beside the project's own, if it can be read.

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
    revision: Revision, campaign: Campaign, now: Dependencies, found: Reused, mutants: Sequence[Mutant]
) -> dict[RunId, str]:
    """Return the runs whose outcomes the changes may have altered, with the reasons.

    Of a mutant that no journal knows, all counts that its tests execute of the original, and what no test
    does: a mutant might. Where the configuration or the vocabulary has changed, everything counts as changed.
    """
    request = campaign.request
    pairs = [(mutant, round) for round in range(request.rounds) for mutant in mutants]
    left = [(mutant, round) for mutant, round in pairs if (mutant.id, round) not in found.done]
    other = _other_configuration(revision, request)
    if other is not None:
        return {(mutant.id, round): f"{other} changed" for mutant, round in left}
    then = _then(revision, campaign, now)
    altered: dict[RunId, str] = {}
    for mutant, round in left:
        pair = (mutant.id, round)
        known = next(
            (source.was(source.kept[pair].key) for source in found.sources if pair in source.kept), None
        )
        whole, until = now.asked(known) if known is not None else (False, "")
        was = PastDependencies(
            then.common,
            then.place(mutant, round, whole, until),
            # what another provider makes its mutants from is not known to have been the same at the revision
            then.own(mutant, round) if known is None or mutant.operation else known.own,
            then.tree,
            known.found_in if known is not None else now.tree,
            known.executed if known is not None else now.executed_by(mutant, round),
            {name: then.notes.get(name, "") for name in known.notes} if known is not None else {},
        )
        why = now.why(was, mutant, round)
        if why:
            altered[pair] = in_short(why)
        elif pair in found.why and (whole or found.why[pair] == GONE):
            altered[pair] = found.why[pair]  # as without a revision
    return altered


def only_altered(
    journal: Journal,
    revision: Revision,
    altered: Mapping[RunId, str],
    found: Reused,
    plan: Plan,
    rounds: int,
    progress: Progress,
) -> Plan:
    """Return the plan with only mutants that the changes may have altered, or whose outcome is known.

    What the changes cannot have altered is not run, also where no journal holds an outcome of it: ``found``
    says so from then on.
    """
    pairs = [(mutant.id, round) for round in range(rounds) for mutant in plan.mutants]
    left = [pair for pair in pairs if pair not in found.done and pair not in altered]
    why = found.why | dict.fromkeys(found.unsound, _UNSOUND)
    reasons = Counter(why.get(pair, "no journal holds an outcome of them") for pair in left)
    since = Since(
        ref=revision.ref,
        commit=revision.commit,
        run=dict(Counter(altered.values()).most_common()),
        taken_over=len(found.done),
        not_judged=dict(reasons.most_common()),
    )
    _report_selection(since, revision.short, progress)
    journal.set_meta(SINCE, since)
    known = {mutant for mutant, _ in found.done | altered.keys()}
    journal.keep_planned(known)
    found.done.update(left)
    return replace(plan, mutants=[mutant for mutant in plan.mutants if mutant.id in known])


def _report_selection(since: Since, short: str, progress: Progress) -> None:
    """Print which mutants are run and which are not, by the kind of reason."""
    total = sum(since.run.values())
    unjudged = sum(since.not_judged.values())
    progress.note(
        f"since {short}: {total} to run, {since.taken_over} taken over"
        + (f", {unjudged} not judged" if unjudged else "")
    )
    for why, count in since.run.items():
        progress.note(f"  {count} to run: {why}")
    for why, count in since.not_judged.items():
        progress.note(f"  {count} not judged; their tests execute nothing that has changed: {why}")
