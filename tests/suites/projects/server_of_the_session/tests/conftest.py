import subprocess
import sys

import pytest


@pytest.fixture(scope="session")
def station():
    pipe = subprocess.PIPE
    process = subprocess.Popen([sys.executable, "mission.py"], stdin=pipe, stdout=pipe, text=True, bufsize=1)

    def ask(word):
        process.stdin.write(word + "\n")
        process.stdin.flush()
        return process.stdout.readline().split()

    yield ask
    process.kill()
    process.wait()
