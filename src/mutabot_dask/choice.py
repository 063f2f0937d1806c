"""The option ``--cluster WHERE``."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

from mutabot.api.processes import ExecutorChoice, Request, Table

from .bundle import BundlePreview
from .settings import ClusterSettings, ClusterTable

if TYPE_CHECKING:
    from .cluster import Cluster


@dataclass(frozen=True, slots=True)
class ClusterChoice(ExecutorChoice):
    """The choice of a cluster."""

    settings: ClusterSettings

    @classmethod
    def parse(cls, value: str, root: Path, table: Table | None) -> Self:
        """Parse the option, with the certificate files of the configuration; see ``ExecutorChoice``."""
        own = ClusterTable.of(table)
        names = () if value.startswith(("tcp://", "local:")) else (own.ca, own.cert, own.key)
        settings = ClusterSettings(value, *(None if name is None else str(root / name) for name in names))
        settings.check()
        return cls(settings)

    def open(self, request: Request, notify: Callable[[str], None]) -> AbstractContextManager[Cluster]:
        """Open the cluster; see ``ExecutorChoice``. Raises UsageError."""
        from .cluster import Cluster  # noqa: PLC0415  # it needs Dask

        return Cluster.opened(request, self.settings, notify)

    @classmethod
    def preview(cls, request: Request) -> BundlePreview:
        """Return the preview of what workers are sent; see ``ExecutorChoice``."""
        return BundlePreview.of(request)
