"""What the program does with an input drawn at random."""

from robot import Clock, Motor


def observe(program, draw):
    drive = program.Drive(Motor(draw.randint(0, 999)), Motor(draw.randint(0, 999)), Clock())
    found = []
    for _ in range(draw.randint(2, 10)):
        kind = draw.randrange(7)
        if kind == 0:
            drive.left.ticks += draw.randint(-9999, 99999)
            drive.right.ticks += draw.randint(-9999, 99999)
        elif kind == 1:
            drive.update()
        elif kind == 2:
            drive.command(draw.uniform(-2, 2), draw.uniform(-3, 3))
        elif kind == 3:
            drive.clock.sleep(draw.choice([0.2, 0.5, 0.6]))
            drive.watch()
        elif kind == 4:
            drive.creep(draw.uniform(-1, 1))
        elif kind == 5:
            drive.reset()
        else:
            drive.stop()
        found.append((drive.pose(), drive.clock.time, drive.commanded))
    return found, drive.left.log, drive.right.log
