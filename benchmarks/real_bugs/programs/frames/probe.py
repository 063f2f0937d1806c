"""What the program does with an input drawn at random."""

from robot import Arm, Sensors


def observe(program, draw):
    turn = draw.uniform(-4, 4)
    arm = Arm((draw.uniform(-1, 1), draw.uniform(-1, 1), turn))
    forces = [draw.choice([0.0, 2.0, 2.1, 5.0]) for _ in range(2)]
    grasper = program.Grasper(arm, Sensors(draw.randint(0, 9000), *forces))
    found = [grasper.has_part(), grasper.leaning()]
    for _ in range(draw.randint(1, 3)):
        grasper.approach(draw.uniform(-2, 2), draw.choice([0.0, 0.1]))
        grasper.nudge(draw.uniform(-1, 1), draw.uniform(-1, 1))
        grasper.halfway(program.Frame(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)))
    frame = program.Frame(1.0, 2.0, draw.uniform(-3, 3)).inverse()
    return found, arm.sent, (frame.x, frame.y, frame.turn), program.Frame() == program.Frame(0.0, 0.0, 0.0)
