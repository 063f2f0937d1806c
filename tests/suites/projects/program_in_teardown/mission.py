def grab(hand):
    hand.move(0.2)
    hand.close(True)


def let_go(hand):
    hand.close(False)
    hand.move(-0.2)
