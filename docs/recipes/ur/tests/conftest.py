"""urx needs math3d below 4, which looks for names that Python moved to collections.abc."""

import collections
import collections.abc

collections.Iterable = collections.abc.Iterable
collections.Sequence = collections.abc.Sequence
