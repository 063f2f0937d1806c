import sys

AT = {"z": 0.0, "angle": 0.0}
for line in sys.stdin:
    axis, by = line.split()
    AT[axis] = round(AT[axis] + float(by), 6)
    print(AT[axis], flush=True)
