def deliver(cart, way):
    cart.drive(way)
    if cart.odometer() > 1:
        cart.beep()
    cart.drive(distance=-way / 2, speed=0.5)
