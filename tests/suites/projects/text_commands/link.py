import re


class UnknownCommand(Exception):
    pass


STATE = {}


def reset(colour):
    STATE.update(height=0.0, angle=0, held=False, colour=colour, log=[])


def send(text):
    STATE["log"].append(text)
    if text == "colour?":
        return STATE["colour"]
    if text in ("pick", "release"):
        if STATE["height"] == 0:
            STATE["held"] = text == "pick"
        return "ok"
    found = re.fullmatch(r"(lift|drop|turn)/(-?[\d.]+)", text)
    if not found:
        raise UnknownCommand(text)
    amount = float(found[2])
    if found[1] == "turn":
        STATE["angle"] += amount
    else:
        STATE["height"] += amount if found[1] == "lift" else -amount
    return "ok"
