from functools import partial


def shift(cell, pool, places):
    cell.light(True)
    first = partial(cell.move, speed=0.5)
    first(0.25)
    for place in places:
        go = cell.move
        go(place)
    handlers = {"off": cell.light}
    handlers["off"](False)
    if getattr(cell, "ready")():
        pool.submit(cell.move, 0.0).result()
    do = cell.light
    do(on=True)
