from robot import Cell


def change_tool(cell: Cell, slot: int):
    cell.park()
    cell.fetch(slot)
    offset = cell.probe_tool()
    cell.shift(-offset)
    return cell.tool
