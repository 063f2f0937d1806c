"""What the program does with an input drawn at random."""

from robot import Arm, Panel


def observe(program, draw):
    left = Arm((0.3, 0.2, draw.uniform(0, 0.8)), draw.random() < 0.8)
    right = Arm((0.3, -0.2, draw.uniform(0, 0.8)), draw.random() < 0.8)
    twins = program.Twins(left, right, Panel())
    found = []
    for _ in range(draw.randint(2, 10)):
        kind = draw.randrange(8)
        if kind == 0:
            found.append(twins.start())
        elif kind == 1:
            left.joints = [draw.choice([0.0, 3.0, draw.uniform(-180, 180)]) for _ in range(3)]
        elif kind in (2, 3):
            found.append(twins.follow())
        elif kind == 4:
            found.append(twins.grip(draw.random() < 0.5))
        elif kind == 5:
            found.append(twins.lift(draw.choice([0.1, 0.5, 1.0])))
        elif kind == 6:
            twins.panel = Panel(draw.random() < 0.5, draw.random() < 0.5)
            found.append(twins.buttons())
        else:
            found.append(twins.path())
            twins.stop()
        found.append((twins.holding, list(left.joints), list(right.joints), left.place, right.place))
    return found, twins.path(), left.log, right.log
