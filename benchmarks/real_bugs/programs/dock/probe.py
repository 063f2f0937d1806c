"""What the program does with an input drawn at random."""

from robot import Base, Charger, Eye


def observe(program, draw):
    base = Base(draw.uniform(-3.2, 0.0), draw.choice([0.0, 0.3, 0.9]))
    eye = Eye(base, draw.uniform(-1, 1), draw.random() < 0.1)
    charger = Charger(base, draw.choice([5.0, 19.0, 20.0, 50.0, 95.0, 99.0]), draw.random() < 0.8)
    dock = program.Dock(base, eye, charger)
    found = []
    for _ in range(draw.randint(1, 3)):
        found.append((dock.needs_charge(), dock.run(), dock.tries, dock.state, base.place, base.time))
        if draw.random() < 0.3:
            found.append(dock.touch())
            dock.leave()
        charger.works = True
        charger.start = draw.choice([10.0, 80.0])
    return found, dock.log, base.log, base.braked, charger.log
