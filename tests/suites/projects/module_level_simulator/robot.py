"""A driver that is its own simulator: its state lives in the module."""

STATE = {"x": 0.0, "gripper": 0, "dropped": []}


def move(dx):
    STATE["x"] = round(STATE["x"] + dx, 6)


def grip(closed):
    if STATE["gripper"] and not closed:
        STATE["dropped"].append(STATE["x"])
    STATE["gripper"] = closed
