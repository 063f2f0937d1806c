"""Put the box on a scale: red to the left, any other colour to the right. Usage: python sort_box.py PORT"""

from __future__ import annotations

import sys

from line import Line

line = Line(int(sys.argv[1]))
line.send("pick")
line.send("lift/5")
if line.read("color") == "red":
    line.send("turn/90")
else:
    line.send("turn/270")
line.send("drop/5")
line.send("release")
