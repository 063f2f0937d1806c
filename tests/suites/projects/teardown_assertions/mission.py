def drill(spindle):
    spindle.speed(100)
    spindle.feed(12.0)
    spindle.feed(-12.0)
    spindle.speed(0)
