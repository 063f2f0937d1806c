"""Put the box on a scale: red to the left, any other colour to the right."""

from __future__ import annotations

import link


def run() -> None:
    """Take one box from the feeder and put it on its scale."""
    link.send("pick")
    link.send("lift/5")
    if link.read("color") == "red":
        link.send("turn/90")
    else:
        link.send("turn/270")
    link.send("drop/5")
    link.send("release")
