"""A revision as a campaign would have seen it: its files, configuration and vocabulary."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.request import Request
from mutabot.campaign.reuse.counted import WRITTEN, is_note, own_files
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.campaign.reuse.snapshot import counts_by_name
from mutabot.campaign.reuse.state import State
from mutabot.errors import ConfigurationError, UsageError
from mutabot.settings.configuration import load_configuration
from mutabot.vocabulary import load

from .git import Revision

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
