"""The station behind the tags, with the two methods of a driver that the program calls: read and write."""

from collections import namedtuple

Tag = namedtuple("Tag", "tag value type error")


class Plant:
    def __init__(self, strengths):
        self._waiting = list(strengths)  # N, what each part withstands
        self.good, self.rejected, self.loose = [], [], []
        self.tags = {
            "Press.Force": 0,
            "Press.Down": False,
            "Press.Reached": 0.0,
            "Clamp.Closed": False,
            "Reject.Open": False,
            "Belt.Step": False,
        }

    def read(self, tag):
        return Tag(tag, self.tags[tag], type(self.tags[tag]).__name__, None)

    def write(self, pair):
        tag, value = pair
        self.tags[tag] = value
        if tag == "Press.Down" and value:
            self._press()
        elif tag == "Belt.Step" and value:
            part = self._waiting.pop(0)
            (self.rejected if self.tags["Reject.Open"] else self.good).append(part)
        return Tag(tag, value, type(value).__name__, None)

    def _press(self):
        if not self.tags["Clamp.Closed"]:
            self.loose.append(self._waiting[0])
        self.tags["Press.Reached"] = float(min(self.tags["Press.Force"], self._waiting[0]))
