"""What adds a joint or a drive to an Exudyn system, and reads its channels: a rule for each type.

A pin is a RevoluteJoint2D, a slide on a moving body a PrismaticJoint2D; a slide on the ground and a drive are
constraints on coordinates. All hold at position level.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.bodies import GROUND
from scenes.joints import DriveJoint, Guide, Joint, Pin, SlidingDrive, TurningDrive

if TYPE_CHECKING:  # which kinds there are rules for is asked without Exudyn too
    from .system import ExudynSystem

Array: TypeAlias = NDArray[np.float64]
TURN = 2  # of x, y and the angle


class ExudynJoint(ABC):
    """What one type of joint is by; `joint` is one of that type."""

    @abstractmethod
    def add(self, joint: Any, system: "ExudynSystem") -> Any:
        """Add it, and return its object."""

    def sensed(self, joint: Any, kinds: Any) -> Any:  # noqa: ARG002
        """The kind of output by which a sensor has its forces."""
        return kinds.Force

    def read(self, joint: Any, system: "ExudynSystem", channels: dict[str, Array]) -> None:  # noqa: B027 - most keep them
        """Change its channels, which are minus its multipliers: the force of the first body on the later one."""


class ExudynPin(ExudynJoint):
    """A pin."""

    def add(self, joint: Pin, system: "ExudynSystem") -> Any:
        """Hold P2 - P1 at zero, for the point of each body."""
        markers = [system.at(body, joint.point) for body in joint.between]
        return system.mbs.AddObject(system.items.RevoluteJoint2D(markerNumbers=markers))


class ExudynGuide(ExudynJoint):
    """A guide."""

    def add(self, joint: Guide, system: "ExudynSystem") -> Any:
        """Hold the slider on the guide, and its angle at that of the guide."""
        return self.on_ground(joint, system) if joint.slide.on == GROUND else self.on_body(joint, system)

    def on_ground(self, joint: Guide, system: "ExudynSystem") -> Any:
        """Hold normal . (x, y) on the line of the ground's guide, and the angle at zero."""
        normal = 1j * system.along(joint.slider)
        com = complex(*joint.slide.through) - system.lever(joint.slider)
        rows = np.zeros((2, system.node_size))
        rows[:, system.in_plane] = (normal.real, normal.imag, 0), (0, 0, 1)
        return system.hold(joint.slider, rows, [(normal.conjugate() * com).real, 0.0])

    def on_body(self, joint: Guide, system: "ExudynSystem") -> Any:
        """Hold normal . (through - P) at zero, and the sine of the slider's angle less the carrier's.

        The joint's normal belongs to its second marker's body, here the carrier, so that the force acts at the slider's
        first point P.
        """
        along = system.along(joint.slider)
        first = system.marker(joint.slider, system.lever(joint.slider), "Rigid")
        second = system.marker(joint.slide.on, system.through(joint.slider), "Rigid")
        axes = {"axisMarker0": [along.real, along.imag, 0], "normalMarker1": [-along.imag, along.real, 0]}
        return system.mbs.AddObject(system.items.PrismaticJoint2D(markerNumbers=[first, second], **axes))

    def sensed(self, joint: Guide, kinds: Any) -> Any:
        """In the frame of a moving guide."""
        return kinds.Force if joint.slide.on == GROUND else kinds.ForceLocal

    def read(self, joint: Guide, system: "ExudynSystem", channels: dict[str, Array]) -> None:
        """Take the moment about the first point, and the force of a moving guide from its other side."""
        force, moment = system.scene.channels.guides[joint.slider]
        if joint.slide.on == GROUND:
            # That moment is about the centre of mass C; about the first point P it is M_C + (C - P) x f.
            lever = system.lever(joint.slider).conjugate() * (1j * system.along(joint.slider))
            channels[moment] = channels[moment] - (lever * channels[force]).imag
        else:
            channels[force] = -channels[force]  # the joint's first marker is the slider's, and at its first point


class ExudynDriveJoint(ExudynJoint):
    """A drive, which holds a position at the one that it asks for."""

    @abstractmethod
    def markers(self, joint: Any, system: "ExudynSystem") -> list[Any]:
        """Return markers on two coordinates, whose difference is the position."""

    @abstractmethod
    def position(self, joint: Any, system: "ExudynSystem", q: Array) -> Any:
        """Return the position, rad or m, from coordinates, shape (..., 3 bodies)."""

    def add(self, joint: DriveJoint, system: "ExudynSystem") -> Any:
        """Hold the position less the drive's at zero."""
        drive = system.driven_by
        # The functions hold no reference to the system: through it, they and it would keep each other alive.
        held = system.items.CoordinateConstraint(
            markerNumbers=self.markers(joint, system),
            offsetUserFunction=lambda _mbs, clock, _item, _offset: drive.position(clock),
            offsetUserFunction_t=lambda _mbs, clock, _item, _offset: drive.rate(clock),
        )
        return system.mbs.AddObject(held)


class ExudynTurningDrive(ExudynDriveJoint):
    """A drive of an angle."""

    def markers(self, joint: TurningDrive, system: "ExudynSystem") -> list[Any]:
        """Return markers on both angles."""
        return [system.coordinate(body, TURN) for body in joint.between]

    def position(self, joint: TurningDrive, system: "ExudynSystem", q: Array) -> Any:
        """Return the angle of the body from the other one."""
        on, body = (system.pose_of(body, q)[1] for body in joint.between)
        return body - on


class ExudynSlidingDrive(ExudynDriveJoint):
    """A drive along a guide."""

    def markers(self, joint: SlidingDrive, system: "ExudynSystem") -> list[Any]:
        """Return a marker on zero, and one on the displacement."""
        return [system.coordinate(GROUND, 0), system.gauge(joint.drive.body)]

    def position(self, joint: SlidingDrive, system: "ExudynSystem", q: Array) -> Any:
        """Return the displacement."""
        return system.displacement(joint.drive.body, q)


RULES: Mapping[type[Joint], ExudynJoint] = {
    Pin: ExudynPin(),
    Guide: ExudynGuide(),
    TurningDrive: ExudynTurningDrive(),
    SlidingDrive: ExudynSlidingDrive(),
}
