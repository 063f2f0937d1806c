def cut(saw):
    saw.advance(10.0)
    saw.advance(15.0)
    saw.rotate_to(45)
    saw.rotate_to(90)
    saw.advance(-25.0)
