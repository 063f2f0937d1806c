"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    executors={
        "cluster": Described(
            "mutabot_dask.choice:ClusterChoice",
            "Run mutants on a Dask cluster: tcp://host:8786, tls://…, local:4, or a scheduler file.",
            "WHERE",
        )
    },
    tables={"cluster": "mutabot_dask.settings:ClusterTable"},
)
