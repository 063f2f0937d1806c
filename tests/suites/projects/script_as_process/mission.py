"""Put parts at equal distances. Usage: mission.py LOG COUNT"""
import sys

from robot import Feeder, OutOfReach

feeder = Feeder(sys.argv[1])
count = int(sys.argv[2])

feeder.move_to(0.1)
for number in range(count):
    feeder.move_by(0.2)
    feeder.release(number)

if __name__ == "__main__":
    try:
        feeder.move_by(-0.1)
    except OutOfReach:
        sys.exit("the rail is too short")
    end = feeder.position()
    print(f"{end:.2f}")
