"""What this package brings to mutabot: the operator creep."""

from mutabot.extensions import Extension

EXTENSION = Extension(interface=1, operators={"creep": "mutabot_creep.creep:Creep"})
