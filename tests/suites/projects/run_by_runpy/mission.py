from robot import Arm

places = []
arm = Arm(places)
if __name__ == "__main__":
    for _ in range(3):
        arm.rotate(30)
        arm.put()
    arm.rotate(-arm.angle())
