import os


def scan(sensor, count=3):
    os.makedirs("scans", exist_ok=True)
    for index in range(count):
        sensor.rotate(15)
        with open(os.path.join("scans", f"{index}.txt"), "w") as file:
            file.write(f"{sensor.measure():.1f}")
    sensor.laser(False)
