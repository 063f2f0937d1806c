import mission
from hypothesis import given, settings
from hypothesis import strategies as st
from robot import Arm


@settings(max_examples=15, derandomize=True, database=None, deadline=None)
@given(st.floats(0.125, 2.0))
def test_never_backwards(distance):
    arm = Arm()
    mission.approach(arm, distance)
    assert arm.x > 0
