def paint(sprayer):
    sprayer.valve(True)
    sprayer.sweep(0.4)
    sprayer.valve(False)
    sprayer.sweep(-0.4)
