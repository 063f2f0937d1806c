"""Every operator of the family ``bugs`` on one program: both engines say what plain pytest says."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot_source.extension import BUGS
from mutabot_source.provider import SourceFaults
from suites.agreement import compare
from tests.plugins.test_faults import write

PROJECT = {
    "mutabot.toml": """
        program = ["prog.py"]
        tests = ["test_prog.py"]
        families = ["bugs"]
        """,
    "prog.py": """
        import math
        from copy import deepcopy

        class Matrix:
            def __init__(self, *rows):
                self.rows = [list(row) for row in rows]

            def __matmul__(self, other):
                columns = list(zip(*other.rows))
                return Matrix(
                    *([sum(a * b for a, b in zip(row, column)) for column in columns] for row in self.rows)
                )

            @property
            def T(self):
                return Matrix(*zip(*self.rows))

        def pose(base, tool):
            return base @ tool

        def turned(rotation, pose):
            return rotation * pose

        def limited(value, high):
            return min(value, high)

        def angle(degrees):
            return math.radians(degrees)

        def keep(state):
            before = state.copy()
            state.append(1)
            return before

        def deep(state):
            before = deepcopy(state)
            state[0].append(1)
            return before

        def replace_all(path):
            path[:] = [9, 9]
            kept = path[:]
            path.append(5)
            del path[:]
            return kept

        def inverse(frame):
            return frame.T

        def pick(left_arm, right_arm):
            if left_arm > right_arm:
                return left_arm
            return move(left_arm, right_arm, speed=2)

        def move(x, y, speed=1):
            n = 0
            while n < 3:
                n += 1
            return (x - y) * speed + n

        def waits(seconds):
            return seconds * 1000

        def slow(degrees):
            return degrees * math.pi / 180

        POSES = {"home": 0, "bin": 5}

        def tour():
            return [POSES["home"], POSES["bin"]]

        def quaternion(q):
            return rotated((q.w, q.x, q.y, q.z), from_euler("xyz", 1, degrees=True))

        def rotated(q, other):
            return q[0], other

        def from_euler(axes, angle, degrees=False):
            return axes if degrees else angle

        class Counter:
            def __init__(self):
                self.seen = []
                self.count = 0
                self.handlers = []

            def subscribe(self, handler):
                self.handlers.append(handler)

            def unsubscribe(self, handler):
                self.handlers.remove(handler)

            def note(self, value):
                self.count += value

            def run(self, values):
                self.count = 0
                self.seen.clear()
                self.subscribe(self.note)
                for value in values:
                    self.seen.append(value)
                    for handler in self.handlers:
                        handler(value)
                self.unsubscribe(self.note)
                return self.count, list(self.seen)
        """,
    "test_prog.py": """
        import math

        import prog
        from prog import Matrix

        ONE, OTHER = Matrix([1, 2], [3, 4]), Matrix([0, 1], [1, 0])

        def test_pose():
            assert prog.pose(ONE, OTHER).rows == [[2, 1], [4, 3]]

        def test_turned():
            assert prog.turned(2, 3) == 6

        def test_limited():
            assert prog.limited(5, 3) == 3

        def test_angle():
            assert prog.angle(180) == math.pi

        def test_keep():
            assert prog.keep([0]) == [0]

        def test_deep():
            assert prog.deep([[0]]) == [[0]]

        def test_replace():
            path = [1]
            assert prog.replace_all(path) == [9, 9]
            assert path == []

        def test_inverse():
            assert prog.inverse(ONE).rows == [[1, 3], [2, 4]]

        def test_waits():
            assert prog.waits(2) == 2000

        def test_slow():
            assert prog.slow(180) == math.pi

        def test_tour():
            assert prog.tour() == [0, 5]

        def test_quaternion():
            q = type("Q", (), {"w": 1, "x": 2, "y": 3, "z": 4})
            assert prog.quaternion(q) == (1, "xyz")

        def test_runs():
            counter = prog.Counter()
            assert counter.run([1, 2]) == (3, [1, 2])
            assert counter.run([4]) == (4, [4])

        def test_a_run_leaves_nothing():
            counter = prog.Counter()
            _, first = counter.run([1])
            counter.run([2])
            assert first == [1]
            assert counter.handlers == []

        def test_pick():
            assert prog.pick(1, 2) == 1
        """,
}


@pytest.mark.whole
def test_every_operator_has_the_verdicts_of_plain_pytest(tmp_path: Path) -> None:
    found = compare(write(tmp_path, PROJECT), families=(BUGS,), only={BUGS: 1000})
    assert found.disagreements == []
    judged = {verdict.mutant.rpartition(":")[2].partition("=")[0] for verdict in found.compared}
    assert judged == {rule.name for rule in SourceFaults().rules() if rule.family == BUGS}
