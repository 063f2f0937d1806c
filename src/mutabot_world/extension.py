"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

PROVIDER, FAMILY = "world", "world"

EXTENSION = Extension(
    interface=2,
    faults={PROVIDER: "mutabot_world.provider:WorldFaults"},
    tables={"world": "mutabot_world.tables:WorldTable"},
    commands={
        "world": Described(
            "mutabot_world.command:world",
            "Show which disturbances of the world the tests notice.",
            before="results",
        )
    },
)

#: what `mutabot init` asks for parameters of the world that it has seen
PROPOSER = "mutabot_world.proposer:PROPOSER"
