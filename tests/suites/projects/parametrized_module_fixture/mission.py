def clamp(vise, width):
    vise.open()
    vise.jaw(width - vise.width())
    vise.lock(True)
