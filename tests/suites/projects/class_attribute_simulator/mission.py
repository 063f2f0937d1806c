def sort_parts(sorter):
    for _ in range(3):
        kind = sorter.look()
        if kind == "bad":
            sorter.flap(True)
        else:
            sorter.flap(False)
        sorter.advance(1)
