"""What an engine says of a linkage's coordinates and constraints, so that its poses can be found."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

from scenes import Scene
from scenes.motion import Samples

from .bodies import FramedBody


class Frame(NamedTuple):
    """Where a body's own frame is in that of the ground."""

    origin: complex  # m
    angle: float  # rad


class System(Protocol):
    """The constraints C(x) = e s of n coordinates; s is the drive's position, e the last unit vector.

    Coordinates are over the linkage's size or 1 rad, and so are the rows of C, the last of which is the drive's.
    """

    scene: Scene
    bodies: Mapping[str, FramedBody]
    size: float  # of the linkage, m
    drive_unit: float  # of the drive's position: the size of a driven slider, 1 rad of a crank
    rows: int  # of C: m, as many as coordinates where reactions are determined
    joints: Mapping[str, Sequence[int]]  # by name the rows that are gaps of a joint, for messages

    def gaps(self, x: Samples) -> Samples:
        """Return C(x), shape (m,), at coordinates of shape (n,)."""

    def jacobian(self, x: Samples) -> Samples:
        """Return C_x, shape (m, n)."""

    def bend(self, x: Samples, v: Samples) -> Samples:
        """Return (C_x v)_x v, shape (m,): second derivatives along a straight line in x."""

    def displacement(self, x: Samples, slider: str) -> float:
        """Return how far a body that slides on the ground is along its guide, m."""

    def placed(self, frames: Mapping[str, Frame]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,); joints that hold them apart stay open."""
