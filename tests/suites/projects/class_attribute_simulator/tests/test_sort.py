import unittest

import mission
from robot import Sorter


class SortTest(unittest.TestCase):
    def test_1_sorts(self):
        mission.sort_parts(Sorter())

    def test_2_one_was_rejected(self):
        self.assertEqual(Sorter.rejected, ["bad"])

    def test_3_machine_is_at_the_end(self):
        self.assertEqual(Sorter.index, 3)
