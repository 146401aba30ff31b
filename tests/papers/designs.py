"""Designs of the clamp that several tests take."""

import numpy as np

from papers.clamp.formulas import UNITS, Design, assembles, closed
from papers.clamp.optimisation.search import in_box

AHEAD_IN_SIX = closed(Design(*(UNITS * [369.2, 415, np.nan, 138.072, 280, 244.769, 4, 18.516, 108.62])))


def some_designs(count: int) -> Design:
    """Designs within the bounds that assemble, values of shape (count,)."""
    designs = in_box(np.random.default_rng(1).random((8, 20 * count)))
    return Design(*(values[assembles(designs)][:count] for values in designs))
