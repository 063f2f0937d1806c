"""What the program does with an input drawn at random."""

from robot import Belt, Bus, Flipper


def observe(program, draw):
    belt = Belt()
    sorter = program.Sorter(Bus(), belt, Flipper(belt))
    sorter.start()
    now, found = 0.0, []
    for _ in range(draw.randint(3, 25)):
        kind = draw.randrange(8)
        if kind < 4:
            label = draw.choice(["nut", "bolt", "washer", "spring"])
            for _ in range(draw.randint(1, 3)):
                sorter.bus.arrives("part", label, draw.choice([0.7, 0.8, 0.9]), int(now * 1000))
        elif kind < 6:
            now += draw.choice([0.1, 0.5, 2.0])
            sorter.step(now)
        elif kind == 6 and draw.random() < 0.3:
            sorter.bus.arrives("jam", draw.choice(["nut", "bolt"]))
        elif kind == 7 and draw.random() < 0.3:
            sorter.stop()
            see = sorter.bus.arrives("part", "nut", 0.9, 0)
            found.append(see)
            sorter.start()
        found.append((sorter.report(), list(sorter.queue), belt.speed, belt.time, sorter.flipper.is_out))
    kept = sorter.report()
    sorter.step(now + 2.0)
    return found, kept, sorter.bus.log, sorter.flipper.log, sorter.is_running
