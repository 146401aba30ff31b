"""The same scene with bodies in space: the cost of a planar linkage in a general multibody model."""

from functools import cached_property
from typing import Any

import numpy as np

from scenes import Failure, Status
from scenes.scene import Body, Slide

from .drive import ExudynDrive
from .system import Array, Chosen, ExudynSystem


class SpatialSystem(ExudynSystem):
    """Rigid bodies with six coordinates, each held in the plane by itself, so that no joint of a loop is redundant."""

    node_size = 6
    in_plane = (0, 1, 5)

    @cached_property
    def coordinates(self) -> Chosen:
        """The indices of x, y and angle of every body in turn among all coordinates."""
        return np.array([6 * number + one for number in range(len(self.bodies)) for one in self.in_plane])

    @cached_property
    def multipliers(self) -> Chosen:
        """The indices of two of every pin, two of every slide and the drive's among all multipliers."""
        joints = (*self.pins.values(), *self.slides.values())
        return np.array([column for joint in joints for column in self.columns(joint)[:2]] + self.columns(self.drive))

    def narrowed(self, q: Array) -> Array:
        """Return all coordinates from x, y and angle of every body, or their rates."""
        all_coordinates = np.zeros(self.node_size * len(self.bodies))
        all_coordinates[self.coordinates] = q
        return all_coordinates

    def _add_body(self, name: str) -> Any:
        body = self.bodies[name]
        node = self.nodes[name] = self.mbs.AddNode(self._items.NodeRigidBodyRxyz())
        inertia = [body.inertia, body.inertia, body.inertia, 0, 0, 0]  # but for the last axis without effect
        return self.mbs.AddObject(self._items.ObjectRigidBody(mass=body.mass, inertia=inertia, nodeNumber=node))

    def _add_pin(self, point: str, first: str, second: str) -> Any:
        """Hold P2 - P1 at zero in x and y."""
        markers = [self.at(first, point), self.at(second, point)]
        return self.mbs.AddObject(self._items.SphericalJoint(markerNumbers=markers, constrainedAxes=[1, 1, 0]))

    def _add_slot(self, body: Body, slide: Slide) -> Any:
        raise Failure(
            Status.unsupported, f"{body.name} slides on {slide.on}, for which there is no joint in space here"
        )

    def _add_drive(self, drive: ExudynDrive) -> tuple[Any, float]:
        for name in self.bodies:
            self._hold(name, np.eye(6)[2:5], [0.0, 0.0, 0.0])
        return super()._add_drive(drive)
