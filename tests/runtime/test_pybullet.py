"""PyBullet, whose functions are native and tell no signature; only where it is installed."""

from __future__ import annotations

from typing import Any

import pytest

from tests.runtime.stage import Make

pytest.importorskip("pybullet")

ROBOT = """
    import pybullet
    from pybullet import setJointMotorControl2, stepSimulation

    def arm():
        pybullet.connect(pybullet.DIRECT)
        link = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.1, 0.1, 0.1])
        return pybullet.createMultiBody(
            0.0, link, linkMasses=[1.0], linkCollisionShapeIndices=[link], linkVisualShapeIndices=[-1],
            linkPositions=[[0, 0, 0.3]], linkOrientations=[[0, 0, 0, 1]], linkParentIndices=[0],
            linkInertialFramePositions=[[0, 0, 0]], linkInertialFrameOrientations=[[0, 0, 0, 1]],
            linkJointTypes=[pybullet.JOINT_REVOLUTE], linkJointAxis=[[0, 0, 1]],
        )

    def angle(body):
        return pybullet.getJointState(body, 0)[0]

    def leave():
        pybullet.disconnect()
"""
PROGRAM = """
    import pybullet
    import robot

    def run():
        body = robot.arm()
        try:
            for _ in range(240):
                robot.setJointMotorControl2({arguments})
                robot.stepSimulation()
            return robot.angle(body)
        finally:
            robot.leave()
"""
VOCABULARY = """
    clock = {{ tick = "robot:stepSimulation", step = 0.0041666 }}
    [[operation]]
    call = "robot:setJointMotorControl2"
    {signature}
    arguments.targetPosition = {{ kind = "rotation", axis = "j1", unit = "rad", mode = "to" }}
"""


@pytest.mark.parametrize(
    ("arguments", "signature"),
    [
        ("body, 0, controlMode=pybullet.POSITION_CONTROL, targetPosition=0.5, force=500", ""),
        ("body, 0, pybullet.POSITION_CONTROL, 0.5", "(body, joint, controlMode, targetPosition, …)"),
        ("body, 0, pybullet.POSITION_CONTROL, 0.5, force=500", "(body, joint, mode, targetPosition, …)"),
        ("body, 0, pybullet.POSITION_CONTROL, targetPosition=0.5", "(body, joint, controlMode, …)"),
    ],
)
def test_a_joint_turns_the_other_way(make_stage: Make, arguments: str, signature: str) -> None:
    line = f'signature = "{signature}"' if signature else ""
    program = PROGRAM.format(arguments=arguments)
    original: Any = make_stage(ROBOT, program, VOCABULARY.format(signature=line))
    session = original.session()
    assert original.run(session) == pytest.approx(0.5, abs=0.05)
    assert session.meter is not None
    assert session.meter.simulated == pytest.approx(1.0, abs=0.01)
    stage = make_stage(ROBOT, program, VOCABULARY.format(signature=line))
    turned, activation = stage.mutated("reverse", "targetPosition")
    assert turned == pytest.approx(-0.5, abs=0.05)
    assert activation.activity.example == (0.5, -0.5)
