"""What this package brings to mutabot: the operator creep."""

from mutabot.api.faults import Extension

EXTENSION = Extension(interface=2, operators={"creep": "mutabot_creep.creep:Creep"})
