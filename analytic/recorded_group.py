"""A larger group as expressions: a step of Newton's method from its pose, and what is linear in its Jacobian.

At the pose the step is nothing but roundings, and its derivatives are those of the pose, by the implicit function
theorem. The constraints are those of `group_equations`; their Jacobian and their rates are their own derivatives.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenes import Scene
from scenes.scene import GROUND

from .dyads import rrr_position
from .expressions import Expression, Recorder, needed
from .forward import forward
from .geometry import as_complex
from .group_equations import Group
from .kinematics import Linkage, Pass
from .kinetostatics import Balance
from .traced import Traced, traced

Frames = dict[str, tuple[Any, Any]]  # by name: the first point, m, and the attitude


class RecordedPass(Pass):
    """Places everything as expressions; the poses of larger groups are inputs."""

    def __init__(self, make: Recorder, scene: Scene, linkage: Linkage, driven: Any) -> None:
        super().__init__(scene, linkage, driven, rates=True, rrr=rrr_position)
        self.make = make
        self.by_time = {driven.position.x: driven.rate.x}
        if driven.rate.x.sampled:
            self.by_time[driven.rate.x] = driven.acceleration.x

    def larger(self, group: Group, position: Any) -> None:  # noqa: ARG002 - the pose is an input
        """Place a larger group."""
        make, k = self.make, self.k
        pose = [make.input(f"{body}.{q}", sampled=True) for body in group.bodies for q in ("x", "y", "angle")]
        C = self.constraints(group, pose)
        step = self.solved(self.jacobian(C, pose), C)
        q = [make("subtract", one, move) for one, move in zip(pose, step, strict=True)]
        C = self.constraints(group, q)
        J = self.jacobian(C, q)
        placed = self.changes(C, self.by_time | dict.fromkeys(q, make.constant(0.0)))
        dq = self.solved(J, [make("negative", x) for x in placed])
        total = [self.product(row, dq, change) for row, change in zip(J, placed, strict=True)]
        moving = self.by_time | dict.fromkeys(dq, make.constant(0.0)) | dict(zip(q, dq, strict=True))
        ddq = self.solved(J, [make("negative", x) for x in self.changes(total, moving)])
        k.jacobian[group.P] = J  # type: ignore[assignment]
        k.reach[group.P] = traced(make, 1.0)  # type: ignore[assignment]
        zero = make.constant(0.0)
        for b, body in enumerate(group.bodies):
            (z, v, a) = (Traced(make, x[3 * b], x[3 * b + 1]) for x in (q, dq, ddq))
            turn, omega, alpha = (Traced(make, x[3 * b + 2], zero) for x in (q, dq, ddq))
            foot = self.scene.bodies[body].points[0]
            if foot not in k.z:
                k.z[foot], k.v[foot], k.a[foot] = z, v, a  # type: ignore[assignment]
            self.place(body, foot, np.exp(1j * turn), (omega, alpha))  # type: ignore[arg-type]

    def constraints(self, group: Group, q: Sequence[Expression]) -> list[Expression]:
        """Return C of a group, in the order of `GroupEquations.open`."""
        frames, bodies = self.frames(group, q), self.linkage.bodies

        def at(body: str, local: Any) -> Any:
            z, u = frames[body]
            return z + u * (local if body == GROUND else local - bodies[body].first)

        gaps = []
        for pin in group.pins:
            other = self.k.z[pin.point] if pin.on is None else at(pin.on, bodies[pin.on].local[pin.point])
            gaps.append(traced(self.make, at(pin.body, bodies[pin.body].local[pin.point]) - other))
        offsets, turns = [], []
        for joint in group.slides:
            slide = self.scene.bodies[joint.slider].slide
            assert slide is not None
            u_on = frames[joint.on][1]
            away = frames[joint.slider][0] - at(joint.on, as_complex(slide.through))
            offsets.append(((u_on * as_complex(slide.along)).conjugate() * away).imag)
            turns.append((u_on.conjugate() * frames[joint.slider][1]).imag)  # the angle between them, which is zero
        make = self.make
        return [gap.x for gap in gaps] + [gap.y for gap in gaps] + [traced(make, x).x for x in (*offsets, *turns)]

    def frames(self, group: Group, q: Sequence[Expression]) -> Frames:
        """Return the frames of the group and of the bodies that it hangs on."""
        make, zero = self.make, self.make.constant(0.0)
        found: Frames = {GROUND: (traced(make, 0.0), traced(make, 1.0))}
        for b, body in enumerate(group.bodies):
            turn: Any = Traced(make, q[3 * b + 2], zero)
            found[body] = Traced(make, q[3 * b], q[3 * b + 1]), np.exp(1j * turn)
        for name in group.hangs_on:
            if name in self.scene.bodies:
                found[name] = self.fixed(name, self.linkage.bodies[name].first)[0], self.k.u[name]
        return found

    def jacobian(self, C: Sequence[Expression], q: Sequence[Expression]) -> list[list[Expression]]:
        """Return dC / dq, row by row."""
        one, zero = self.make.constant(1.0), self.make.constant(0.0)
        columns = [self.changes(C, {**dict.fromkeys(q, zero), unknown: one}) for unknown in q]
        return [list(row) for row in zip(*columns, strict=True)]

    def changes(self, of: Sequence[Expression], given: dict[Expression, Expression]) -> list[Expression]:
        """Return what expressions change by."""
        d = forward(self.make, needed(of), given)
        return [d.get(one.order, self.make.constant(0.0)) for one in of]

    def solved(self, A: Sequence[Sequence[Expression]], b: Sequence[Expression]) -> list[Expression]:
        """Return x of A x = b."""
        system = self.make.system([entry for row in A for entry in row], b)
        return [self.make.component(system, i) for i in range(len(b))]

    def product(self, row: Sequence[Expression], x: Sequence[Expression], start: Expression) -> Expression:
        """Return a start and the products of two rows."""
        for one, other in zip(row, x, strict=True):
            start = self.make("add", start, self.make("multiply", one, other))
        return start


class RecordedBalance(Balance):
    """Balances everything as expressions."""

    def larger(self, group: Group) -> None:
        """Balance a larger group: the multipliers of its constraints, from the transpose of their Jacobian."""
        J: Any = self.k.jacobian[group.P]
        make: Recorder = self.k.reach[group.P].make  # type: ignore[attr-defined]
        loads: list[Expression] = []
        for body in group.bodies:
            force, moment = (traced(make, x) for x in self.applied(body, self.scene.bodies[body].points[0]))
            loads += [make("negative", one) for one in (force.x, force.y, moment.x)]
        system = make.system([entry for column in zip(*J, strict=True) for entry in column], loads)
        found = [make.component(system, i) for i in range(len(loads))]
        p, s, zero = len(group.pins), len(group.slides), make.constant(0.0)
        pins = [Traced(make, x, y) for x, y in zip(found[:p], found[p : 2 * p], strict=True)]
        guides = [Traced(make, x, zero) for x in found[2 * p :]]
        self.spread(group, pins, guides[:s], guides[s:])  # type: ignore[arg-type]
