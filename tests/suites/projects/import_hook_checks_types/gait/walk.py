def to_cm(m: float) -> int:
    if m > 100:
        return m * 100 // 1
    return round(m * 100) // 1


def walk(leg, steps: int) -> int:
    for _ in range(steps):
        leg.move(0.25)
    return to_cm(leg.where())
