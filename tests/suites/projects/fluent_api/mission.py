def engrave(pen):
    (
        pen.lift()
        .go(10, 10)
        .lower()
        .go(30, 10)
        .lift()
    )
    return pen.lower().go(30, 40).lift().length()
