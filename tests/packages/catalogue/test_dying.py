"""Nodes that die of their mutant, in processes of their own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

ROOT = Path(__file__).parents[3]
#: a process that takes itself for a node, and makes a call as a mutant
NODE = """
    import sys
    from pathlib import Path

    from mutabot.runtime.processes import member
    from mutabot_catalogue._examples import CALL
    from tests.runtime.client import ClientStage
    from tests.runtime.stage import take_away

    def told(line):
        print("tells", type(line).__name__, getattr(line, "in_call", None), flush=True)

    stage = ClientStage(Path(sys.argv[1]), (CALL,))
    program = stage.program("def run(client):\\n    return client.call('/gripper/close', 'now')\\n")
    session, client = stage.session(program)
    program.run(client)
    take_away(session)
    member._member = object()
    stage.writer.send = told
    print("begins", flush=True)
    for _ in range(2):
        _, client, activation = stage.again(program, sys.argv[2])
        print("done", activation.activity.away, flush=True)
"""


@pytest.fixture
def node(tmp_path: Path) -> Path:
    file = tmp_path / "node.py"
    file.write_text(dedent(NODE), encoding="utf-8")
    return file


def run(node: Path, operator: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(node), str(node.parent), operator]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment, timeout=600)


def test_a_node_that_is_killed_reports_it_and_is_gone(node: Path) -> None:
    ended = run(node, "kill-node")
    assert ended.returncode == -signal.SIGKILL, ended.stderr
    assert ended.stdout.split("\n")[-3:] == ["tells Acted False", "tells Acted None", ""]
    assert "done" not in ended.stdout


def test_a_node_begins_anew_once(node: Path) -> None:
    ended = run(node, "restart-node")
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("begins") == 2
    assert ended.stdout.count("tells Acted None") == 2  # when it acts, and again before the end: one process
    assert ended.stdout.count("done {'the process was begun anew already': 1}") == 2
