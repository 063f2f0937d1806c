"""What the program does with an input drawn at random."""

from robot import Pipette, Rack


def observe(program, draw):
    transfers = program.Transfers(Pipette(), Rack(draw.randint(1, 9)))
    found = []
    for _ in range(draw.randint(1, 5)):
        volume = draw.choice([0.5, 1.0, 50.0, 200.0, 201.0])
        found.append(transfers.may(volume))
        try:
            transfers.transfer(volume, draw.uniform(0, 90), draw.uniform(0, 90), draw.random() < 0.5)
        except ValueError as error:
            found.append(str(error))
        if draw.random() < 0.3:
            transfers.give_up()
        transfers.rinse(draw.randint(0, 2))
        found.append((transfers.pipette.volume, transfers.pipette.has_tip, transfers.rack.count))
    return found, transfers.done, transfers.pipette.log
