import os


def select_tool(changer, number):
    changer.rotate(number * 60)
    changer.lock(True)
    os.environ["CURRENT_TOOL"] = str(number)


def return_tool(changer):
    changer.lock(False)
    changer.rotate(-int(os.environ.pop("CURRENT_TOOL")) * 60)
