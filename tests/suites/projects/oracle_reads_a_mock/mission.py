def load(lift, layers):
    for _ in range(layers):
        lift.raise_by(0.1)
    return lift.height() if layers else None
