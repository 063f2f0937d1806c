def park(car):
    car.forward(3.0)
    car.steer(30)
    car.forward(-2.0)
    car.steer(0)


def leave(car):
    car.forward(2.0)
