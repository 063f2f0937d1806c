import sys

from robot import Magnet


def serve(lines, answer):
    magnet = Magnet()
    for line in lines:
        word = line.strip()
        if word == "take":
            magnet.switch(True)
            magnet.lift(0.25)
        elif word == "drop":
            magnet.lift(-0.25)
            magnet.switch(False)
        answer(f"{magnet.sheets} {magnet.measured():.2f}")


if __name__ == "__main__":
    serve(sys.stdin, lambda text: print(text, flush=True))
