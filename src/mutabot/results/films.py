"""Films of mutants, kept beside the journal so that pages of its campaign show them."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.journal.files import clear

#: facts that distinguish campaigns of the same journal
_STARTED = "started"
_LIST = "films.json"


@frozen
class KeptFilm:
    """A film of a mutant beside the original.

    Attributes:
        file: where it is: H.264 in MP4.
        round: which, from 0.
        test: node id.
    """

    file: Path
    round: int
    test: str


def keep_film(journal: Path, meta: Mapping[str, Any], mutant: str, film: KeptFilm) -> None:
    """Copy the film of a mutant, by its id, and remove those of earlier campaigns.

    Raises UsageError if that fails.
    """
    folder = _folder(journal)
    known = _known(folder, meta)
    try:
        if not known:
            clear(folder)
        folder.mkdir(exist_ok=True)
        shutil.copyfile(film.file, folder / _name(mutant))
        data = {_STARTED: meta.get(_STARTED), "films": {**known, mutant: [film.round, film.test]}}
        (folder / _LIST).write_text(json.dumps(data), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"the film cannot be kept in {folder}: {error.strerror}") from error


def kept_films(journal: Path, meta: Mapping[str, Any]) -> dict[str, KeptFilm]:
    """Return the films of this campaign by mutant id, as far as their files exist."""
    folder = _folder(journal)
    found = {
        mutant: KeptFilm(folder / _name(mutant), round, test)
        for mutant, (round, test) in _known(folder, meta).items()
    }
    return {mutant: film for mutant, film in found.items() if _is_file(film.file)}


def _known(folder: Path, meta: Mapping[str, Any]) -> dict[str, tuple[int, str]]:
    try:
        data = json.loads((folder / _LIST).read_text(encoding="utf-8"))
        if data[_STARTED] != meta.get(_STARTED):
            return {}
        return {str(mutant): (int(round), str(test)) for mutant, (round, test) in data["films"].items()}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return {}


def _is_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def _name(mutant: str) -> str:
    return f"{blake2b(mutant.encode(), digest_size=12).hexdigest()}.mp4"


def _folder(journal: Path) -> Path:
    return journal.with_name(f"{journal.stem}-films")
