"""What the program does with an input drawn at random."""

from robot import Motors


def observe(program, draw):
    motors = Motors(draw.uniform(-180, 180), draw.uniform(-40, 70), draw.choice([0.0, 2.0]))
    gimbal = program.Gimbal(motors)
    found = []
    for _ in range(draw.randint(1, 8)):
        kind = draw.randrange(5)
        if kind == 0:
            gimbal.point_at(*(draw.uniform(-2, 2) for _ in range(3)))
        elif kind == 1:
            gimbal.track(*draw.choice([(None, None), (draw.randint(0, 640), draw.randint(0, 480))]))
        elif kind == 2:
            gimbal.joystick(draw.choice([-1.0, -0.05, 0.0, 0.03, 0.05, 0.6]), draw.uniform(-1, 1))
        elif kind == 3:
            gimbal.set(draw.uniform(-7, 7), draw.uniform(-2, 2))
        else:
            motors.moving = draw.random() < 0.5
        found.append((gimbal.error(), gimbal.settled(), gimbal.target, gimbal.missed))
    return found, motors.log
