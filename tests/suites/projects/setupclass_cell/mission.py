from robot import Cell


def feed(cell: Cell) -> int:
    fed = 0
    while cell.sensor():
        cell.push(40.0)
        cell.push(-40.0)
        fed += 1
    cell.lamp("green")
    return fed
