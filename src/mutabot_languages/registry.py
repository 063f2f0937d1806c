"""The languages of this package, by the suffixes of their files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .core.language import RobotLanguage
from .krl.language import KRL
from .rapid.language import RAPID
from .urscript.language import URSCRIPT

if TYPE_CHECKING:
    from .mutation.rewriting import Rewriter

LANGUAGES: tuple[RobotLanguage, ...] = (URSCRIPT, RAPID, KRL)


def language_for(file: str) -> RobotLanguage | None:
    """Return the language of a file by its suffix; None if it is none of these."""
    name = file.lower()
    return next((language for language in LANGUAGES if name.endswith(language.suffixes)), None)


def rewriter_of(language: RobotLanguage) -> type[Rewriter]:
    """Return the class that makes mutants of programs in a language."""
    from .krl.rewriting import KrlRewriter  # noqa: PLC0415  # likewise
    from .rapid.rewriting import RapidRewriter  # noqa: PLC0415  # of no use to the tests' processes
    from .urscript.rewriting import UrRewriter  # noqa: PLC0415  # likewise

    found: dict[str, type[Rewriter]] = {"urscript": UrRewriter, "rapid": RapidRewriter, "krl": KrlRewriter}
    return found[language.name]
