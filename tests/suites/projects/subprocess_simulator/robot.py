"""The simulator is a process of its own; the driver talks to it through pipes."""

import json
import subprocess
import sys

SIMULATOR = """
import json, sys
state = {"z": 0, "dips": 0, "drip": False}
for line in sys.stdin:
    name, value = json.loads(line)
    if name == "down":
        state["z"] += value
        state["dips"] += state["z"] >= 30
    elif name == "drip":
        state["drip"] = value
    print(json.dumps(state), flush=True)
"""


class Arm:
    def __init__(self):
        self.process = subprocess.Popen(
            [sys.executable, "-c", SIMULATOR], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def _ask(self, *command):
        self.process.stdin.write(json.dumps(command) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def down(self, mm):
        self._ask("down", mm)

    def drip(self, on):
        self._ask("drip", on)

    def dipped(self):
        return self._ask("state", None)["dips"]

    def state(self):
        return self._ask("state", None)

    def stop(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
