"""What goes to workers and what stays here, in words."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .bundle import Bundle
from .environment import decided
from .shipping import Shipment

if TYPE_CHECKING:
    from mutabot.settings.configuration import Configuration

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


def explained(shipment: Shipment, why: str) -> str:
    """What was wrong on a worker, with the files that it lacks, if that is what it speaks of."""
    names = shipment.named_in(why)
    return f"{why} (not sent: {listed(names)}; {_ADVICE})" if names else why


@dataclass(frozen=True, slots=True)
class Forecast:
    """See ``mutabot.campaign.request.Preview``: what workers will be sent."""

    shipment: Shipment

    @classmethod
    def of(cls, configuration: Configuration) -> Forecast:
        """That of a project. Raises ClusterError where git cannot tell what it tracks."""
        return cls(Shipment.of_configuration(configuration))

    @property
    def folders_left_out(self) -> set[str]:
        """See ``Preview``."""
        return self.shipment.folders_left_out

    def lacking(self, opened: Collection[str] | None) -> str | None:
        """See ``Preview``."""
        missed = self.shipment.missed(opened or ())
        return f"tests open files that workers will not have: {listed(missed)}; {_ADVICE}" if missed else None

    def check(self, opened: Collection[str] | None) -> tuple[list[str], Mapping[str, Any]]:
        """See ``Preview``."""
        shipment = self.shipment
        bundle = Bundle.make(shipment)
        variables = sorted(decided())
        missed = self.lacking(opened)
        said = [
            f"workers are sent {summary(bundle)}",
            f"and the variables {', '.join(variables)}",
            *warnings(shipment, bundle),
            *([missed] if missed is not None else []),
        ]
        names = {
            "files": [os.path.relpath(path, shipment.root) for path in shipment.files],
            "left_out": shipment.left_out,
            "outside": bundle.outside,
            "secret_names": shipment.suspicious,
            "opened_but_left_out": shipment.missed(opened or ()),
        }
        data = {key: [_printable(name) for name in value] for key, value in names.items()}
        lines = [f"cluster   {text}" for text in said]
        return lines, {**data, "bytes": len(bundle.data), "variables": variables}


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
