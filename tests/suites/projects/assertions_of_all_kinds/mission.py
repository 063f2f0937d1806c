def weigh_in(scale, belt):
    belt.forward(0.5)
    weight = scale.read()
    belt.forward(0.5)
    belt.light("green" if weight < 20 else "red")
    return weight
