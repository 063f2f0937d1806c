from robot import Arm


def main():
    arm = Arm()
    arm.lift(0.5)
    arm.turn(30)
    arm.lift(-0.25)
    print(arm.x, arm.turned, len(arm.done))


if __name__ == "__main__":
    main()
