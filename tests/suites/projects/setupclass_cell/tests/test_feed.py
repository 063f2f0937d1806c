import unittest

import mission
from robot import Cell


class FeedTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell(3)
        cls.fed = mission.feed(cls.cell)

    def test_count(self):
        self.assertEqual(self.fed, 3)

    def test_tray(self):
        self.assertEqual(self.cell.tray, 3)

    def test_lamp(self):
        self.assertEqual(self.cell.colour, "green")


class EmptyMagazineTest(unittest.TestCase):
    def setUp(self):
        self.cell = Cell(0)

    def test_nothing_is_fed(self):
        self.assertEqual(mission.feed(self.cell), 0)

    def tearDown(self):
        self.assertGreaterEqual(self.cell.stroke, 0.0)
