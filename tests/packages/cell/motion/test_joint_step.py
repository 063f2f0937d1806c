from __future__ import annotations

import mink
import numpy as np
import pytest

from mutabot_cell import BadModel, robots
from mutabot_cell.models.assembly import TOOL_SITE, build_arm
from mutabot_cell.models.robot import RobotModel
from mutabot_cell.motion.joint_step import JointStep


def arm(name: str) -> RobotModel:
    """The robot of the catalogue; skips the test where its package is not installed."""
    try:
        found: RobotModel = getattr(robots, name)()
    except BadModel as error:
        pytest.skip(str(error))
    return found


@pytest.mark.parametrize("limited", [True, False])
@pytest.mark.parametrize(("name", "posture_cost", "damping"), [("gen3", 1e-3, 0.0), ("ur5e", 0.0, 1e-3)])
def test_step_is_bit_by_bit_that_of_mink(
    name: str, posture_cost: float, damping: float, limited: bool
) -> None:
    model = build_arm(arm(name))
    configuration = mink.Configuration(model)
    frame = mink.FrameTask(TOOL_SITE, "site", position_cost=1.0, orientation_cost=0.3, lm_damping=damping)
    tasks: list[mink.BaseTask] = [frame]
    if posture_cost:
        posture = mink.PostureTask(model, cost=posture_cost)
        tasks.append(posture)
    step = JointStep(model, frame, posture_cost)
    generator = np.random.default_rng(3)
    at_limits = 0
    for _ in range(30):
        low, high = np.maximum(model.jnt_range[:, 0], -3.0), np.minimum(model.jnt_range[:, 1], 3.0)
        low, high = np.where(model.jnt_limited, low, -3.0), np.where(model.jnt_limited, high, 3.0)
        near, there = generator.uniform(low, high, (2, model.nv))
        configuration.update(there)
        frame.set_target_from_configuration(configuration)
        configuration.update(near)
        if posture_cost:
            posture.set_target(there)
        limits: list[mink.Limit] = [mink.ConfigurationLimit(model, gain=0.95)] if limited else []
        wanted = mink.solve_ik(configuration, tasks, 1.0, "daqp", limits=limits)
        found = step.solve(configuration, there, limited=limited)
        np.testing.assert_array_equal(found, wanted)
        after = near + found
        at_limits += bool(((after < low) | (after > high))[model.jnt_limited.astype(bool)].any())
    assert limited or at_limits  # else the limits would not have been tried
