"""What holds the tree's coordinates, the joints that close loops and the drive; and the forces in all joints."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from scenes import Scene
from scenes.model.motion import Samples, force_channels

from ..coordinates.bodies import MovingBody
from ..coordinates.loads import Wrench
from ..coordinates.system import System
from .tree import Tree


class Closures(System):
    """The constraints of one tree, as many as coordinates, or there is no one motion: loops' joints and the drive."""

    def __init__(self, scene: Scene) -> None:
        """Span the tree."""
        super().__init__(scene)
        self.tree = Tree(self)
        in_tree, anchors = {joint.name for joint in self.tree.joints}, self.tree.anchors
        self.arms = {end: arm - anchors[end[0]] for end, arm in self.arms.items()}
        for name, guide in self.guides.items():
            through, first = guide.through - anchors[guide.carrier], guide.first - anchors[name]
            self.guides[name] = guide._replace(through=through, first=first)
        self.pins = [pin for pin in scene.pins if pin.channel not in in_tree]
        self.sliders = [name for name in self.guides if name not in in_tree]
        self.units = np.array([1.0 if joint.turns else self.size for joint in self.tree.joints])

    def placed(self, bodies: Mapping[str, MovingBody]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,); joints that close loops stay open."""
        bodies = {name: body._replace(origin=body.place(self.tree.anchors[name])) for name, body in bodies.items()}
        q = list[float]()
        for joint in self.tree.joints:
            turned = bodies[joint.child].angle - bodies[joint.parent].angle
            q.append(turned if joint.turns else self.slid(bodies, joint.name)[0].real)
        return np.asarray(np.array(q) / self.units)

    def moved(self, x: Samples, v: Samples | None = None, a: Samples | None = None) -> dict[str, MovingBody]:
        """Return how bodies move, by Pinocchio's recursions."""
        q, *rates = (np.zeros(len(self.units)) if of is None else self.units * of for of in (x, v, a))
        return self.tree.moved(q, *(rates if v is not None else ()))

    def jacobian(self, x: Samples) -> Samples:
        """Return C_x, shape (m, n), by Pinocchio's Jacobians of the bodies."""
        return np.asarray(self.rows_of(self.tree.by_coordinate(self.units * x), 1) * self.units)

    def forces(
        self, motion: Sequence[Samples], J: Samples, bodies: Mapping[str, MovingBody], ends: Samples
    ) -> dict[str, float]:
        """Return the force channels: of closed loops by their multipliers, of the tree's joints by the recursion.

        `motion` has the coordinates and their two derivatives, each of shape (n,); J is the Jacobian there.
        """
        motion = [self.units * of for of in motion]
        loads = [*self.applied(bodies, ends)]
        needed = self.units * self.tree.inverse_dynamics(bodies, motion, loads)
        multipliers = np.linalg.solve(J.T, needed) / self.row_units
        self.tree.inverse_dynamics(bodies, motion, [*loads, *self._held(bodies, multipliers)])
        names = [f"{pin.channel}.{part}" for pin in self.pins for part in ("fx", "fy")]
        names += [f"{name}.{part}" for name in self.sliders for part in ("guide_force", "guide_moment")]
        channels = dict(zip([*names, force_channels(self.scene)[-1]], multipliers, strict=True))
        first_of = {pin.channel: pin.first for pin in self.scene.pins}
        for joint in self.tree.joints:
            exerted = self.tree.data.f[self.tree.number[joint.child]]  # by the parent, in the child's frame
            force, moment = complex(*exerted.linear[:2]) * bodies[joint.child].turn, exerted.angular[2]
            if joint.turns:
                on_second = force if first_of[joint.name] == joint.parent else -force
                channels |= {f"{joint.name}.fx": on_second.real, f"{joint.name}.fy": on_second.imag}
                continue
            carrier, _, along, first = self.guides[joint.name]
            way = bodies[joint.child].origin - bodies[joint.name].place(first)
            across, sign = 1j * bodies[carrier].turn * along, 1 if joint.child == joint.name else -1
            channels[f"{joint.name}.guide_force"] = sign * (across.conjugate() * force).real
            channels[f"{joint.name}.guide_moment"] = sign * (moment + (way.conjugate() * force).imag)
        return channels

    def _held(self, bodies: Mapping[str, MovingBody], multipliers: Samples) -> Iterator[Wrench]:
        """Yield what the joints that close loops and the drive do, by their multipliers in the order of the rows."""
        rows = iter(multipliers.tolist())
        for pin in self.pins:
            at, force = bodies[pin.second].place(self.arms[pin.second, pin.point]), complex(next(rows), next(rows))
            yield from (Wrench(pin.second, at, force), Wrench(pin.first, at, -force))
        for name in self.sliders:
            carrier, _, along, first = self.guides[name]
            at, force, moment = bodies[name].place(first), 1j * bodies[carrier].turn * along * next(rows), next(rows)
            yield from (Wrench(name, at, force, moment), Wrench(carrier, at, -force, -moment))
        driven, effort = self.scene.drive.body, next(rows)
        if self.scene.driven_slide is None:
            yield Wrench(driven, 0j, 0j, effort)
        else:
            yield Wrench(driven, bodies[driven].place(self.guides[driven].first), self.guides[driven].along * effort)
