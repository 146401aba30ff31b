"""What holds the tree's coordinates: the joints that close loops, and the drive; their values, Jacobian and bend.

Rows are, in this order, x and y of each pin that is no joint of the tree, second - first; of each such slide the offset
of its first point along the guide's normal, and its angle from the guide; the position of the drive. Each is over its
unit, the linkage's size or 1 rad.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from scenes.motion import Samples

from ..coordinates.bodies import FramedBody, linkage_size
from ..coordinates.system import Frame
from .tree import Bodies, Plane, Tree


class Held(NamedTuple):
    """A point of a body: its row among the bodies, and where it is from the origin of the joint frame, m."""

    row: int
    arm: complex


class Guide(NamedTuple):
    """A guide: the slider's first point, a point of the line in what carries it, and the line's direction there."""

    first: Held
    through: Held
    along: complex


class Closures:
    """The constraints of one tree: as many as coordinates, or there is no one motion."""

    def __init__(self, tree: Tree) -> None:
        scene = self.scene = tree.scene
        self.tree = tree
        self.bodies: Mapping[str, FramedBody] = tree.bodies
        self.guides = {name: self._guide(name) for name, body in scene.bodies.items() if body.slide is not None}
        in_tree = {joint.name for joint in tree.joints}
        self.pins = {
            pin.channel: (self.held(pin.first, pin.point), self.held(pin.second, pin.point))
            for pin in scene.pins
            if pin.channel not in in_tree
        }
        self.sliders = {name: guide for name, guide in self.guides.items() if name not in in_tree}
        self.driven = tree.index[scene.drive.body]
        self.driven_guide = self.guides.get(scene.drive.body)
        self.size = linkage_size(scene, tree.bodies)
        self.drive_unit = 1.0 if self.driven_guide is None else self.size
        units = [self.size] * 2 * len(self.pins) + [self.size, 1.0] * len(self.sliders) + [self.drive_unit]
        self.row_units = np.array(units)
        self.rows = len(units)
        # What makes coordinates comparable: rad, and the linkage's size.
        self.units = np.array([1.0 if joint.turns else self.size for joint in tree.joints])
        first = 2 * len(self.pins)
        guides = {f"the guide of {name}": [first + 2 * row] for row, name in enumerate(self.sliders)}
        pins = {name: [2 * row, 2 * row + 1] for row, name in enumerate(self.pins)}
        self.joints: Mapping[str, Sequence[int]] = guides | pins

    def gaps(self, x: Samples) -> Samples:
        """Return the rows' values, shape (rows,); the last is the drive's position."""
        q = self.units * x
        bodies, angles = self.tree.moved(q), self.tree.turns @ q
        pins = (bodies.place(*second) - bodies.place(*first) for first, second in self.pins.values())
        slides = (
            ((np.conj(axis) * way).imag, angles[guide.first.row] - angles[guide.through.row])
            for guide in self.sliders.values()
            for axis, way in (self.on_guide(bodies, guide),)
        )
        drive = angles[self.driven] if self.driven_guide is None else self.along_guide(bodies, self.driven_guide)
        return self._rows(pins, slides, drive)

    def jacobian(self, x: Samples) -> Samples:
        """Return their derivatives, shape (rows, n)."""
        q = self.units * x
        bodies, turns = self.tree.moved(q), self.tree.turns
        J = self.tree.jacobians(q)

        def moves(point: Held) -> Plane:
            """Return the derivatives of a point by the coordinates, shape (n,)."""
            return np.asarray(J[point.row] + 1j * bodies.turn[point.row] * point.arm * turns[point.row])

        slides = []
        for first, through, along in self.sliders.values():
            axis, way = self.on_guide(bodies, Guide(first, through, along))
            across = moves(first) - moves(through) - 1j * way * turns[through.row]
            slides.append(((np.conj(axis) * across).imag, turns[first.row] - turns[through.row]))
        drive = turns[self.driven]
        if self.driven_guide is not None:
            drive = (np.conj(self.driven_guide.along) * moves(self.driven_guide.first)).real
        pins = (moves(second) - moves(first) for first, second in self.pins.values())
        return np.asarray(self._rows(pins, slides, drive) * self.units)

    def bend(self, x: Samples, v: Samples) -> Samples:
        """Return their second derivatives by the time where the coordinates move at v and do not accelerate."""
        bodies = self.tree.moved(self.units * x, self.units * v)
        pins = (bodies.acceleration(*second) - bodies.acceleration(*first) for first, second in self.pins.values())
        slides = []
        for first, through, along in self.sliders.values():
            axis, way = self.on_guide(bodies, Guide(first, through, along))
            omega = bodies.spin[through.row]
            rate = bodies.velocity(*first) - bodies.velocity(*through)
            change = bodies.acceleration(*first) - bodies.acceleration(*through)
            slides.append(((np.conj(axis) * (change - 2j * omega * rate - omega**2 * way)).imag, 0.0))
        drive = 0.0
        if self.driven_guide is not None:
            drive = (np.conj(self.driven_guide.along) * bodies.acceleration(*self.driven_guide.first)).real
        return self._rows(pins, slides, drive)

    def held(self, body: str, point: str) -> Held:
        """Return a point of a body or of the ground."""
        return Held(self.tree.index[body], self.tree.local(body, point) - self.tree.anchors[body])

    def on_guide(self, bodies: Bodies, guide: Guide) -> tuple[complex, complex]:
        """Return the direction of a guide, and the way from its `through` to the slider's first point, m."""
        axis = complex(bodies.turn[guide.through.row] * guide.along)
        return axis, bodies.place(*guide.first) - bodies.place(*guide.through)

    def along_guide(self, bodies: Bodies, guide: Guide) -> float:
        """Return how far a slider is along its guide, m."""
        axis, way = self.on_guide(bodies, guide)
        return (axis.conjugate() * way).real

    def displacement(self, x: Samples, slider: str) -> float:
        """Return how far a body that slides on the ground is along its guide, m."""
        return self.along_guide(self.tree.moved(self.units * x), self.guides[slider])

    def placed(self, frames: Mapping[str, Frame]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,); joints that close loops stay open."""
        q = np.zeros(len(self.units))
        for column, joint in enumerate(self.tree.joints):
            parent, child = frames[joint.parent], frames[joint.child]
            if joint.turns:
                q[column] = child.angle - parent.angle
            else:
                turn = np.exp(1j * parent.angle)
                way = child.origin + turn * joint.anchor - parent.origin - turn * joint.at
                q[column] = (np.conj(turn * joint.along) * way).real
        return np.asarray(q / self.units)

    def _rows(
        self, pins: Iterable[complex | Plane], slides: Iterable[Sequence[float | Samples]], drive: float | Samples
    ) -> Samples:
        parts = [part for gap in pins for part in (gap.real, gap.imag)]
        rows = np.array([*parts, *(part for slide in slides for part in slide), drive])
        return np.asarray((rows.T / self.row_units).T)

    def _guide(self, name: str) -> Guide:
        body = self.tree.scene.bodies[name]
        assert body.slide is not None
        carrier = body.slide.on
        through = Held(self.tree.index[carrier], complex(*body.slide.through) - self.tree.anchors[carrier])
        return Guide(self.held(name, body.points[0]), through, complex(*body.slide.along))
