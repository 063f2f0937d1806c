"""Fetch a part, press it in, and say what was seen."""

import robot


def run(cell):
    """One part; returns what was seen."""
    cell.set_speed(0.5)
    cell.set_payload(1.2)
    seen = cell.locate("bolt")
    cell.open_to(85)
    cell.move_to(1000 * seen.x, 1000 * seen.y, 300)
    cell.move_by(x=10, z=-150)
    cell.set_grip(100)
    cell.open_to(0)
    cell.wait(0.4)
    cell.move_by(z=150)
    cell.orient([0.8, 0.48, 0.36, 0.0])
    cell.turn_to([170.0, 10.0, 90.0])
    cell.move_joints([10, -20, 30, 0, 90, 170])
    angles = cell.joint_angles()
    cell.press(78)
    gaps = [cell.distance() for _ in range(8)]
    firm = cell.pressed() > 60
    colour = cell.colour()
    refused = False
    try:
        cell.move_to(5000, 0, 0)
    except robot.Refused:
        refused = True
    cell.move_to(200, 300, 120)
    here = cell.pose()
    return {
        "angles": angles, "gaps": gaps, "firm": firm, "colour": colour, "refused": refused,
        "here": (here.x, here.theta_z),
    }
