def write(*words):
    raise OSError("no port")


ask = write
