import serial_port


def move_to(x, *, speed=0.1):
    serial_port.write("M", x, speed)


def tool(on):
    serial_port.write("T", on)


def where():
    return serial_port.ask("?")
