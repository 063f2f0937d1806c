def run(arm, log):
    with log.open("a") as file:
        print("start", file=file)
        arm.move(0.25)
        print(f"at {arm.x:.2f}", file=file)
        arm.move(0.25)
        print(f"at {arm.x:.2f}", file=file)
    arm.park()
    with log.open("a") as file:
        print("end", file=file)
