"""A larger group as expressions: a pose found by Newton's method, its rates, and the forces of its joints.

The constraints are those of `group_equations`. Their Jacobian is their derivative, and the rates are derivatives of the
pose, by the implicit function theorem.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenes import Scene
from scenes.scene import GROUND

from ..core.decomposition import Linkage
from ..core.geometry import as_complex
from ..core.group_equations import Group, size_of
from ..core.kinematics import Pass
from ..core.kinetostatics import Balance
from ..core.numbers import chosen
from .expressions import Closing, Expression, Recorder, needed, substituted
from .forward import forward
from .traced import Traced, traced

Frames = dict[str, tuple[Any, Any]]  # by name: the first point, m, and the attitude


def inputs_of(group: Group) -> tuple[list[str], str, str]:
    """The inputs of a group: where its method begins, how far off that it may end, its branch's sign of det J."""
    return [f"{body}.{q}" for body in group.bodies for q in ("x", "y", "angle")], f"{group.P}.off", f"{group.P}.branch"


class RecordedPass(Pass):
    """Places everything as expressions."""

    def __init__(self, make: Recorder, scene: Scene, linkage: Linkage, driven: Any) -> None:
        super().__init__(scene, linkage, driven)
        self.make = make
        self.closed: dict[Group, Expression] = {}
        self.by_time = {driven.position.x: driven.rate.x}
        if driven.rate.x.sampled:
            self.by_time[driven.rate.x] = driven.acceleration.x

    def larger(self, group: Group) -> None:
        """Place a larger group."""
        make, k = self.make, self.k
        begin, allowed, branch = inputs_of(group)
        unknowns = [make.input(f"{name} sought", sampled=True) for name in begin]
        C = self.constraints(group, unknowns)
        closing = Closing(unknowns, C, self.jacobian(C, unknowns))
        size = traced(make, size_of(group, self.linkage.bodies)).x
        given = [*(make.input(name, sampled=True) for name in (*begin, allowed)), make.input(branch, sampled=False)]
        closed = self.closed[group] = make.closed(closing, [*given, size, *closing.outer])
        q = [make.component(closed, i) for i in range(len(begin))]
        rows = substituted(make, [*closing.C, *closing.J], dict(zip(unknowns, q, strict=True)))
        C, J = closing.at_zero = rows[: len(q)], rows[len(q) :]
        dq = self.changes(q, self.by_time)
        ddq = self.changes(dq, self.by_time)
        k.jacobian[group.P] = J  # type: ignore[assignment]
        a_number: Any = Traced(make, make("less_equal", q[0], q[0]))
        k.reach[group.P] = chosen(a_number, 1.0, -1.0)
        for b, body in enumerate(group.bodies):
            (z, v, a) = (Traced(make, x[3 * b], x[3 * b + 1]) for x in (q, dq, ddq))
            turn, omega, alpha = (Traced(make, x[3 * b + 2]) for x in (q, dq, ddq))
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
        make = self.make
        frames: Frames = {GROUND: (traced(make, 0.0), traced(make, 1.0))}
        for b, body in enumerate(group.bodies):
            turn: Any = Traced(make, q[3 * b + 2])
            frames[body] = Traced(make, q[3 * b], q[3 * b + 1]), np.exp(1j * turn)
        for name in group.hangs_on:
            if name in self.scene.bodies:
                frames[name] = self.fixed(name, self.linkage.bodies[name].first)[0], self.k.u[name]
        return frames

    def jacobian(self, C: Sequence[Expression], q: Sequence[Expression]) -> list[Expression]:
        """Return dC / dq, row by row."""
        columns = [self.changes(C, {unknown: self.make.constant(1.0)}) for unknown in q]
        return [entry for row in zip(*columns, strict=True) for entry in row]

    def changes(self, of: Sequence[Expression], given: dict[Expression, Expression]) -> list[Expression]:
        """The changes of expressions."""
        d = forward(self.make, needed(of), given)
        return [d.get(one.order, self.make.constant(0.0)) for one in of]


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
        m = len(loads)
        system = make.system([J[m * row + column] for column in range(m) for row in range(m)], loads)
        forces = [make.component(system, i) for i in range(len(loads))]
        p, s = len(group.pins), len(group.slides)
        pins = [Traced(make, x, y) for x, y in zip(forces[:p], forces[p : 2 * p], strict=True)]
        guides = [Traced(make, x) for x in forces[2 * p :]]
        self.spread(group, pins, guides[:s], guides[s:])  # type: ignore[arg-type]
