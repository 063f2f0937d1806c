def sweep(arm):
    """Yields after every stroke; the caller decides when it is enough."""
    for _ in range(3):
        arm.out(0.1)
        yield arm.reach()
        arm.out(-0.1)
        arm.turn(30)


def clean(arm, strokes=2):
    done = []
    for reach in sweep(arm):
        done.append(reach)
        if len(done) == strokes:
            break
    arm.rest()
    return done
