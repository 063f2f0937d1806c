import unittest

import mission
from robot import Scale


class GradeTest(unittest.TestCase):
    def setUp(self):
        self.scale = Scale()
        self.addCleanup(self.check)

    def check(self):
        self.assertEqual(self.scale.load, 0.0)

    def test_grades(self):
        found = mission.grade(self.scale, ["nut", "bolt", "plate"])
        for part, grade in {"nut": "light", "bolt": "heavy", "plate": "heavy"}.items():
            with self.subTest(part=part):
                self.assertEqual(found[part], grade)

    def test_all_taken(self):
        mission.grade(self.scale, ["nut"])
        self.assertEqual(self.scale.taken, ["nut"])


class Inherited(GradeTest):
    def setUp(self):
        super().setUp()
        self.scale.part = "bolt"

    @unittest.expectedFailure
    def test_fails_today(self):
        self.assertEqual(mission.grade(self.scale, ["bolt"]), {"bolt": "light"})
