"""Units of a report: one for each kind of quantity, lengths in that of the scene's file."""

from collections.abc import Mapping
from math import pi
from typing import TypeAlias

from scenes.motion import UNITS, quantity

from ..engines.axis import prefixed
from ..engines.reference import Reference

Units: TypeAlias = Mapping[str, tuple[float, str]]


def units(*references: Reference) -> Units:
    """Return by SI unit the factor from it to the unit shown, and the name of that; of all scenes of a page."""
    name, size = references[0].scene.length_unit
    found = {"": (1.0, ""), "rad": (180 / pi, "°"), "m": (1 / size, name)}
    found |= {"m/s": (1 / size, f"{name}/s"), "m/s^2": (1 / size, f"{name}/s²")}
    for si in ("N", "N*m"):
        sizes = [s for of in references for channel, s in of.scale.items() if UNITS[quantity(channel)] == si]
        found[si] = prefixed(max(sizes, default=0.0) or 1.0, si.replace("*", " "))
    return found
