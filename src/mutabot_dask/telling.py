"""What goes to workers and what stays here, in words."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from .bundle import Bundle
from .environment import decided
from .shipping import Shipment

#: names that a sentence shows
_SHOWN = 8
_ADVICE = "`git add` what workers need, or name it under `cluster.files`"


def summary(bundle: Bundle) -> str:
    """How much goes."""
    return f"{_files(bundle.files)}, {len(bundle.data) / 1000:.0f} kB"


def warnings(shipment: Shipment, bundle: Bundle) -> Iterator[str]:
    """What the user is to know before anything is sent."""
    if shipment.left_out:
        why = (
            "that git does not track"
            if shipment.is_tracked
            else "(there is no repository of git to say more)"
        )
        verb = "stays" if len(shipment.left_out) == 1 else "stay"
        yield f"{_files(len(shipment.left_out))} {why} {verb} on this machine: {listed(shipment.left_out)}"
    if bundle.outside:
        yield f"not sent, since it leads out of the project or cannot be read: {listed(bundle.outside)}"
    if shipment.suspicious:
        why = "git tracks it, or `cluster.files` names it"
        yield f"sent though it is named like a secret, since {why}: {listed(shipment.suspicious)}"


def lacking(shipment: Shipment, opened: Iterable[str] | None) -> str | None:
    """What tests of the baseline opened that workers will not have; None if that is nothing."""
    missed = shipment.missed(opened or ())
    return f"tests open files that workers will not have: {listed(missed)}; {_ADVICE}" if missed else None


def explained(shipment: Shipment, why: str) -> str:
    """What was wrong on a worker, with the files that it lacks, if that is what it speaks of."""
    names = shipment.named_in(why)
    return f"{why} (not sent: {listed(names)}; {_ADVICE})" if names else why


def check_lines(shipment: Shipment, opened: Iterable[str] | None) -> tuple[list[str], Mapping[str, Any]]:
    """What ``mutabot check`` says, for people and for machines."""
    bundle = Bundle.make(shipment)
    variables = sorted(decided())
    lines = [
        f"cluster   workers are sent {summary(bundle)}",
        f"cluster   and the variables {', '.join(variables)}",
        *(f"cluster   {text}" for text in warnings(shipment, bundle)),
    ]
    missed = lacking(shipment, opened)
    if missed is not None:
        lines.append(f"cluster   {missed}")
    data = {
        "files": [os.path.relpath(path, shipment.root) for path in shipment.files],
        "bytes": len(bundle.data),
        "variables": variables,
        "left_out": list(shipment.left_out),
        "outside": list(bundle.outside),
        "secret_names": list(shipment.suspicious),
        "opened_but_left_out": shipment.missed(opened or ()),
    }
    return lines, {
        key: [_printable(name) for name in value] if isinstance(value, list) else value
        for key, value in data.items()
    }


def listed(names: Collection[str]) -> str:
    """A few names, and how many more there are."""
    shown = [_printable(name) for name in list(names)[:_SHOWN]]
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(shown) + more


def _files(count: int) -> str:
    return "1 file" if count == 1 else f"{count} files"


def _printable(name: str) -> str:
    text = os.fsencode(name).decode("utf-8", "backslashreplace")
    return text if text.isprintable() else ascii(text)[1:-1]
