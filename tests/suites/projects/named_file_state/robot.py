from pathlib import Path

STATE = Path(__file__).parent / "state.txt"


class Arm:
    def move(self, steps):
        at = int(STATE.read_text()) if STATE.exists() else 0
        STATE.write_text(str(at + steps))

    def lamp(self, on):
        with Path(__file__).parent.joinpath("lamp.log").open("a") as log:
            log.write(f"{on}\n")
