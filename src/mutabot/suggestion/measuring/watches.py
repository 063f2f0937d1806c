"""What has to be watched in a test so that a reading along its way can be held against something."""

from __future__ import annotations

import re
from collections.abc import Sequence

from mutabot.suggestion.sources.project import Project
from mutabot.suggestion.sources.texts import name_in
from mutabot.suggestion.styles.style import Place, Watch

from .commands import Command

_OF_COMMANDED = "args[0]"


def watch_of(
    project: Project, commands: Sequence[Command], place: Place, look: str
) -> tuple[Watch, tuple[str, ...]]:
    """What looks at this expression after every command, and the imports that it needs.

    An expression of the object that was commanded is looked at after the commands of objects alone.
    """
    module = project.module(place.file)
    assert module is not None
    found: dict[tuple[str, str], None] = {}
    needs: list[str] = []
    for where, owner, name in commands:
        if not owner and _OF_COMMANDED in look:
            continue
        if owner:
            first, dot, rest = owner.partition(".")
            holder = name_in(module, where, first, place.names)
            text = holder.text + dot + rest
            needs += [holder.needs] if holder.needs else []
        else:
            text = where
            needs.append(f"import {where}")
        found[text, name] = None
    parts = re.findall(r"[^\W\d]\w*", look.replace(_OF_COMMANDED, ""))
    slug = "_".join(dict.fromkeys(parts[-2:])).lower()
    return Watch(f"seen_{slug}", look, tuple(found)), tuple(dict.fromkeys(needs))
