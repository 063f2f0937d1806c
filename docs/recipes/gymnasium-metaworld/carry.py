"""The Sawyer arm of Meta-World grasps a puck and carries it to its goal."""

import numpy as np

OPEN, CLOSED = -1.0, 0.6


def towards(hand, target, gain=10.0):
    """The motion of one step, as a share of the largest one."""
    return np.clip((target - hand) * gain, -1.0, 1.0)


def carry(env, observation, goal, steps=200):
    """Carry the puck to the goal; whether the environment says that it is there."""
    for _ in range(steps):
        hand, opening, puck = observation[0:3], observation[3], observation[4:7]
        is_above = np.linalg.norm(hand[:2] - puck[:2]) < 0.02
        if not is_above:
            target, grip = puck + [0, 0, 0.1], OPEN
        elif hand[2] - puck[2] > 0.05:
            target, grip = puck + [0, 0, 0.02], OPEN
        elif opening > 0.73:
            target, grip = hand, CLOSED
        else:
            target, grip = goal, CLOSED
        action = np.array([*towards(hand, target), grip], dtype=np.float32)
        observation, _, terminated, truncated, info = env.step(action)
        if info["success"] or terminated or truncated:
            return bool(info["success"])
    return False
