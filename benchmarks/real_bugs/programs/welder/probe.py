"""What the program does with an input drawn at random."""

from robot import Arm, Source


def observe(program, draw):
    welder = program.Welder(Arm(), Source(draw.choice([0.0, 0.4, 0.5, 0.6, 1.0]), draw.random() < 0.8))
    found = []
    for _ in range(draw.randint(1, 3)):
        points = [tuple(draw.uniform(-1, 1) for _ in range(3)) for _ in range(draw.randint(0, 4))]
        done = welder.weld(points, draw.choice([2.0, 3.0, 4.0, 5.5, 6.0, 8.0]), draw.random() < 0.5)
        found.append((done, welder.length, welder.faults))
        if draw.random() < 0.3:
            welder.source.on()
            welder.source.wait(draw.choice([0.1, 0.3]))
        if draw.random() < 0.3:
            welder.park()
    return found, welder.faults, welder.arm.log, welder.source.log, welder.source.since
