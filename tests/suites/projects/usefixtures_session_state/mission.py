def warm_up(spindle):
    for rpm in (100, 300, 600):
        spindle.accelerate(rpm - spindle.rpm())
    spindle.coolant(True)
