"""What the program does with an input drawn at random."""

from robot import Cup, Robot, Scale


def observe(program, draw):
    robot = Robot()
    grams = draw.choice([1000.0, 5000.0, 11900.0, 12000.0, 12100.0, 16000.0, 30000.0])
    palletiser = program.Palletiser(robot, Cup(robot, draw.choice([0, 3, 100])), Scale(grams))
    found = []
    for _ in range(draw.randint(1, 4)):
        found.append(palletiser.run(draw.choice([1, 2, 5, 8, 25])))
        found.append((palletiser.count, list(palletiser.lost), palletiser.is_full()))
        if draw.random() < 0.5:
            found.append(palletiser.new_pallet())
    return found, robot.log, robot.time, palletiser.cup.log, palletiser.cup.boxes
