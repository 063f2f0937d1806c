"""What the program does with an input drawn at random."""

from robot import Base


def observe(program, draw):
    base = Base(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-4, 4))
    driver = program.Driver(base)
    found = [program.wrap(draw.uniform(-9, 9)), program.shaped(draw.uniform(-1, 1))]
    for _ in range(draw.randint(1, 5)):
        driver.joystick(
            draw.choice([0.0, 0.04, 0.05, draw.uniform(-1, 1)]), draw.uniform(-1, 1), draw.choice([0.0, 0.3])
        )
        found.append(base.speeds)
        base.step(0.5)
        driver.turn_to(draw.uniform(-4, 4), draw.choice([0, 3, 40]))
        found.append((base.x, base.y, base.heading, base.speeds))
        driver.joystick(draw.uniform(-0.06, 0.06), draw.uniform(-0.06, 0.06))
        found.append((base.speeds, driver.goal_from(draw.uniform(-1, 1), draw.uniform(-1, 1))))
        found.append(driver.heading_of(draw.uniform(-4, 4), draw.uniform(-1, 1)))
    return found, program.limited(draw.uniform(-2, 2))
