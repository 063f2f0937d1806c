"""What a node does through rospy is seen and mutated by its name.

rospy's node cannot be taken down again within its process, and leaves threads. So the tests themselves are in
``ros1_cases.py``, which runs in a process of its own.
"""

from __future__ import annotations

from .both import needs_ros1, run_cases


@needs_ros1
def test_every_case_holds_with_a_real_master() -> None:
    run_cases("ros1_cases.py", {"ROS_NAMESPACE": "/cell"})
