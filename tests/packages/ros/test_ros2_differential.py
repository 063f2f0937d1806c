"""Behaviours of rclpy over a real middleware are what its documents promise, and the same every time.

The records that are kept were made over Fast DDS. What stands in the place of the middleware has to make
the same ones.
"""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec

import pytest

from .differential.runner import KEPT, ROOT, Outcome, names, read, run

pytestmark = pytest.mark.skipif(
    find_spec("rclpy") is None, reason="no ROS 2: pip install -r requirements-ros2.lock"
)

#: one of each area, for every change; all of them take minutes
SHORT = (
    "messages_arrive_in_order",
    "an_int_field_takes_a_float",
    "reliability_matches",
    "reliability_that_does_not_match_is_told",
    "several_requests_are_under_way",
    "a_goal_is_cancelled",
    "setting_a_parameter_can_be_refused",
    "a_whole_life",
    "a_timer_is_cancelled_and_reset",
    "a_topic_tells_the_time",
    "a_coroutine_gives_way",
    "nodes_are_renamed",
)
_EXPECTED = """
import json
from tests.packages.ros.differential.worker import behaviours
expected = {name: one.expected for name, one in behaviours().items() if one.source}
print(json.dumps(expected))
"""


def differences(found: list[Outcome], over: str = "dds") -> list[str]:
    """The behaviours whose records are not those that are kept, with both.

    On a busy machine a behaviour can miss its times, so each that differs is recorded once more, alone.
    """
    kept = read(KEPT)
    again = [behaviour.name for behaviour in found if not behaviour.equals(kept[behaviour.name])]
    return [
        f"{behaviour.name}: {behaviour.told()} not {kept[behaviour.name].told()}"
        for behaviour in (run(again, over, jobs=1) if again else ())
        if not behaviour.equals(kept[behaviour.name])
    ]


def test_the_records_that_are_kept_are_those_that_documents_promise() -> None:
    done = subprocess.run(
        [sys.executable, "-c", _EXPECTED],
        cwd=ROOT,
        env=None,
        capture_output=True,
        text=True,
        check=True,
    )
    expected = json.loads(done.stdout)
    kept = {name: outcome.record for name, outcome in read(KEPT).items() if name in expected}
    assert kept == expected
    assert len(expected) >= 60


def test_every_behaviour_has_a_record() -> None:
    assert names() == list(read(KEPT))


def test_some_behaviours_over_dds_are_as_they_were_recorded() -> None:
    assert differences(list(run(SHORT, jobs=1))) == []


@pytest.mark.whole
def test_all_behaviours_over_dds_are_as_they_were_recorded() -> None:
    assert differences(list(run(jobs=2))) == []


@pytest.mark.whole
@pytest.mark.skipif(
    any(find_spec(name) is None for name in ("greenlet", "ros_in_process")), reason="no simulation"
)
def test_all_behaviours_over_the_simulation_are_as_over_dds() -> None:
    assert differences(list(run(over="simulation")), "simulation") == []
