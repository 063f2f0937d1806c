import json
import subprocess
import sys


def run(log, count):
    done = subprocess.run([sys.executable, "mission.py", str(log), str(count)], capture_output=True, text=True)
    return done, [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []


def test_one_part(tmp_path):
    done, parts = run(tmp_path / "log", 1)
    assert done.returncode == 0, done.stderr
    assert parts == [{"part": 0, "x": 0.3}]


def test_parts_lie_apart(tmp_path):
    done, parts = run(tmp_path / "log", 3)
    assert [one["part"] for one in parts] == [0, 1, 2]
    assert 0.5 < float(done.stdout) < 0.7
