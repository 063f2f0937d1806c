"""A press station behind a PLC: clamp a part, press it, and sort it by the force that was reached."""

LEAST_FORCE = 1800  # N, below which a joint is loose


def press(plc, parts):
    """Press some parts; how many of them were good."""
    good = 0
    plc.write(("Press.Force", 2000))
    for _ in range(parts):
        plc.write(("Clamp.Closed", True))
        plc.write(("Press.Down", True))
        is_good = plc.read("Press.Reached").value >= LEAST_FORCE
        plc.write(("Press.Down", False))
        plc.write(("Clamp.Closed", False))
        plc.write(("Reject.Open", not is_good))
        plc.write(("Belt.Step", True))
        good += is_good
    plc.write(("Reject.Open", False))
    return good
