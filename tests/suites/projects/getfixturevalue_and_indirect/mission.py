def fill(doser, amount):
    doser.valve(True)
    doser.plunger(amount)
    doser.valve(False)
    doser.plunger(-amount)
