from array import array


def record(points):
    way = array("d")
    for point in points:
        way.append(point)
    way.append(0.5)
    last = []
    last.append(way.pop())
    return way, last
