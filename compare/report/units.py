"""Units of a page: one for each kind of quantity, in which its peak reads between 1 and 10,000."""

from collections.abc import Mapping
from math import pi
from typing import TypeAlias

from scenes.motion import UNITS, quantity

from ..engines.axis import prefixed
from ..engines.reference import Reference

Units: TypeAlias = Mapping[str, tuple[float, str]]

MOST = 1e4  # what a peak reads less than


def units(*references: Reference) -> Units:
    """Return by SI unit the factor from it to the unit shown, and the name of that; of all scenes of a page.

    Lengths and their rates are in the unit of the scene's file where it suits them. What a page has one of, work and
    power, is not among them.
    """
    name, size = references[0].scene.length_unit
    of_the_file = {"m": name, "m/s": f"{name}/s", "m/s^2": f"{name}/s²"}
    found = {"": (1.0, ""), "rad": (180 / pi, "°")}
    for si in (*of_the_file, "N", "N*m"):
        sizes = [s for of in references for channel, s in of.scale.items() if UNITS[quantity(channel)] == si]
        peak = max(sizes, default=0.0)
        own = si in of_the_file and (not peak or 1 <= peak / size < MOST)
        suits = prefixed(peak or 1.0, si.replace("*", " ").replace("^2", "²"))
        found[si] = (1 / size, of_the_file[si]) if own else suits
    return found
