"""A Panda takes a cube from one place to another."""

import pybullet as p

ARM = list(range(7))
FINGERS = [9, 10]
HAND = 11
DOWN = p.getQuaternionFromEuler([3.14159, 0.0, 0.0])


def settle(steps):
    for _ in range(steps):
        p.stepSimulation()


def move(robot, position, steps=120):
    joints = p.calculateInverseKinematics(robot, HAND, position, DOWN, maxNumIterations=200)
    p.setJointMotorControlArray(robot, ARM, p.POSITION_CONTROL, targetPositions=joints[:7], forces=[200] * 7)
    settle(steps)


def grip(robot, width, steps=60):
    for finger in FINGERS:
        p.setJointMotorControl2(robot, finger, p.POSITION_CONTROL, targetPosition=width / 2, force=60)
    settle(steps)


def pick_and_place(robot, cube, goal):
    (x, y, z), _ = p.getBasePositionAndOrientation(cube)
    grip(robot, 0.08)
    move(robot, [x, y, z + 0.2])
    move(robot, [x, y, z + 0.01])
    grip(robot, 0.02)
    move(robot, [x, y, z + 0.25])
    move(robot, [goal[0], goal[1], z + 0.25])
    move(robot, [goal[0], goal[1], z + 0.02])
    grip(robot, 0.08)
    move(robot, [goal[0], goal[1], z + 0.25])
