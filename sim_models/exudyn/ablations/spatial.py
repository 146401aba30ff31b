"""The same scene with bodies in space: the cost of a planar linkage in a general multibody model."""

from typing import Any

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import Body, Slide

from ..drive import ExudynDrive
from ..system import Array, ExudynSystem, items


class SpatialSystem(ExudynSystem):
    """Rigid bodies with six coordinates, each held in the plane by itself, so that no joint of a loop is redundant."""

    node_size = 6
    in_plane = (0, 1, 5)

    def __init__(self, scene: Scene, drive: ExudynDrive, *, si: bool = False) -> None:
        super().__init__(scene, drive, si=si)
        joints, bodies = (*self.pins.values(), *self.slides.values()), range(len(self.bodies))
        self.coordinates = np.array([6 * number + one for number in bodies for one in self.in_plane])
        planar = [column for joint in joints for column in self.columns(joint)[:2]]
        self.multipliers = np.array(planar + self.columns(self.drive))

    def narrowed(self, q: Array) -> Array:
        """All coordinates from x, y and angle of every body, or their rates."""
        all_coordinates = np.zeros(self.node_size * len(self.bodies))
        all_coordinates[self.coordinates] = q
        return all_coordinates

    def _add_body(self, name: str) -> Any:
        body = self.bodies[name]
        node = self.nodes[name] = self.mbs.AddNode(items.NodeRigidBodyRxyz())
        inertia = [body.inertia, body.inertia, body.inertia, 0, 0, 0]  # but for the last axis without effect
        return self.mbs.AddObject(items.ObjectRigidBody(mass=body.mass, inertia=inertia, nodeNumber=node))

    def _add_pin(self, point: str, first: str, second: str) -> Any:
        """Hold P2 - P1 at zero in x and y."""
        markers = [self.at(first, point), self.at(second, point)]
        return self.mbs.AddObject(items.SphericalJoint(markerNumbers=markers, constrainedAxes=[1, 1, 0]))

    def _add_slot(self, body: Body, slide: Slide) -> Any:
        raise Failure(
            Status.unsupported, f"{body.name} slides on {slide.on}, for which there is no joint in space here"
        )

    def _add_drive(self, drive: ExudynDrive) -> tuple[Any, float]:
        for name in self.bodies:
            self._hold(name, np.eye(6)[2:5], [0.0, 0.0, 0.0])
        return super()._add_drive(drive)
