import subprocess
import sys
from pathlib import Path

PROGRAM = Path(__file__).with_name("controller.py")


class Controller:
    """A controller that runs as a process of its own."""

    def __enter__(self):
        pipe = subprocess.PIPE
        self._process = subprocess.Popen([sys.executable, PROGRAM], stdin=pipe, stdout=pipe, text=True)
        return self

    def __exit__(self, *error):
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def ask(self, axis, by):
        print(axis, by, file=self._process.stdin, flush=True)
        return float(self._process.stdout.readline())


class Arm:
    def __init__(self, controller):
        self.controller = controller

    def lift(self, dz):
        self.controller.ask("z", dz)

    def turn(self, angle):
        self.controller.ask("angle", angle)
