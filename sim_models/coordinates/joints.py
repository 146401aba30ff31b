"""Joints and drives as constraints on how bodies move: for each type its rows, and what its multipliers do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from scenes.joints import Guide, Joint, Pin, SlidingDrive, TurningDrive

from .bodies import MovingBody
from .loads import Wrench

if TYPE_CHECKING:
    from .system import System

Bodies: TypeAlias = Mapping[str, MovingBody]


class CoordinateJoint(ABC):
    """What one type of joint is by; `joint` is one of that type."""

    @abstractmethod
    def units(self, size: float) -> Sequence[float]:
        """What its rows are over, m or rad, in a linkage of a size, m."""

    @abstractmethod
    def rows(self, joint: Any, system: System, bodies: Bodies, level: int) -> Sequence[Any]:
        """Return its rows' values, m or rad, or their first or second derivatives, of bodies as they move."""

    @abstractmethod
    def holds(self, joint: Any, system: System, bodies: Bodies, multipliers: Sequence[float]) -> Iterator[Wrench]:
        """Yield what it does, by its rows' multipliers, in N or N m."""


class CoordinatePin(CoordinateJoint):
    """A pin: x and y of second - first."""

    def units(self, size: float) -> Sequence[float]:
        """Return the size for both."""
        return size, size

    def rows(self, joint: Pin, system: System, bodies: Bodies, level: int) -> Sequence[Any]:
        """Return x and y."""
        first, second = (bodies[body].at(system.arms[body, joint.point])[level] for body in joint.between)
        return (second - first).real, (second - first).imag

    def holds(self, joint: Pin, system: System, bodies: Bodies, multipliers: Sequence[float]) -> Iterator[Wrench]:
        """Yield the force on both bodies."""
        place, force = bodies[joint.second].place(system.arms[joint.second, joint.point]), complex(*multipliers)
        yield from (Wrench(joint.second, place, force), Wrench(joint.first, place, -force))


class CoordinateGuide(CoordinateJoint):
    """A guide: the offset of the slider's first point along the normal, and its angle from the guide."""

    def units(self, size: float) -> Sequence[float]:
        """Return the size, and 1 rad."""
        return size, 1.0

    def rows(self, joint: Guide, system: System, bodies: Bodies, level: int) -> Sequence[Any]:
        """Return the offset and the angle."""
        carrier_turn, turn = (bodies[body].turning[level] for body in joint.between)
        return system.slid(bodies, joint.slider)[level].imag, turn - carrier_turn

    def holds(self, joint: Guide, system: System, bodies: Bodies, multipliers: Sequence[float]) -> Iterator[Wrench]:
        """Yield the force across the guide and the moment, on both bodies."""
        # Both forces act at the slider's first point, whatever body they are on: the guide's reaction on the carrier
        # acts where the slider touches it, which is not a fixed point of the carrier.
        carrier, _, along, first = system.guides[joint.slider]
        force, moment = multipliers
        foot, across = bodies[joint.slider].place(first), 1j * bodies[carrier].turn * along * force
        yield from (Wrench(joint.slider, foot, across, moment), Wrench(carrier, foot, -across, -moment))


class CoordinateTurn(CoordinateJoint):
    """A drive that turns a body against another."""

    def units(self, _: float) -> Sequence[float]:
        """Return 1 rad."""
        return (1.0,)

    def rows(self, joint: TurningDrive, _: System, bodies: Bodies, level: int) -> Sequence[Any]:
        """Return the angle."""
        on, body = (bodies[body].turning[level] for body in joint.between)
        return (body - on,)

    def holds(self, joint: TurningDrive, _: System, __: Bodies, multipliers: Sequence[float]) -> Iterator[Wrench]:
        """Yield the torque on both bodies."""
        (torque,), (on, body) = multipliers, joint.between
        yield from (Wrench(body, 0j, 0j, torque), Wrench(on, 0j, 0j, -torque))


class CoordinateSlide(CoordinateJoint):
    """A drive along a guide."""

    def units(self, size: float) -> Sequence[float]:
        """Return the size."""
        return (size,)

    def rows(self, joint: SlidingDrive, system: System, bodies: Bodies, level: int) -> Sequence[Any]:
        """Return the displacement."""
        return (system.slid(bodies, joint.drive.body)[level].real,)

    def holds(
        self, joint: SlidingDrive, system: System, bodies: Bodies, multipliers: Sequence[float]
    ) -> Iterator[Wrench]:
        """Yield the force along the guide on both bodies."""
        carrier, _, along, first = system.guides[joint.drive.body]
        (effort,), foot = multipliers, bodies[joint.drive.body].place(first)
        force = bodies[carrier].turn * along * effort
        yield from (Wrench(joint.drive.body, foot, force), Wrench(carrier, foot, -force))


RULES: Mapping[type[Joint], CoordinateJoint] = {
    Pin: CoordinatePin(),
    Guide: CoordinateGuide(),
    TurningDrive: CoordinateTurn(),
    SlidingDrive: CoordinateSlide(),
}
