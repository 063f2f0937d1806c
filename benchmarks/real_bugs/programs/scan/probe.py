"""What the program does with an input drawn at random."""

import math

from robot import Base, Laser, Pose


def observe(program, draw):
    parts = [draw.gauss(0, 1) for _ in range(4)]
    norm = math.hypot(*parts)
    orientation = draw.choice(
        [tuple(one / norm for one in parts), program.quaternion_of(draw.uniform(-3, 3))]
    )
    laser = Laser(first=draw.uniform(-1, 1), step=draw.uniform(0, 0.5), stamp=draw.uniform(0, 2))
    pose = Pose((draw.uniform(-3, 3), draw.uniform(-3, 3), draw.uniform(0, 1)), orientation)
    scanner = program.Scanner(laser, pose, Base())
    found = []
    for _ in range(draw.randint(1, 6)):
        laser.scan.ranges = [
            draw.choice([0.1, 8.0, 0.09, 8.1, math.inf, draw.uniform(0.1, 3)])
            for _ in range(draw.randint(0, 6))
        ]
        scanner.add()
        found.append((scanner.read(), scanner.ahead(), scanner.guard(draw.uniform(0, 2500)), scanner.slowed))
        scanner.face((draw.uniform(-3, 3), draw.uniform(-3, 3)))
        if draw.random() < 0.3:
            found.append(scanner.clear())
    return found, scanner.points, scanner.base.log, program.yaw_of(orientation)
