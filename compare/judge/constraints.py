"""The constraints of a linkage in the coordinates of all its bodies, linearised at a motion's own poses.

A body has the coordinates of its first point and L times its angle, with L the linkage's largest length, so that all
are lengths. The same matrix, transposed, turns what bodies want into reactions: one condition serves both solves.
"""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.motion import Samples
from scenes.scene import GROUND

from ..engines.state import State, Vectors, distances

Matrices = NDArray[np.float64]

BLOCK = 4096  # samples, whose Jacobians are in memory at a time


class Constraints:
    """Rows: two a pin, two a guide (across it, and the turning against it), and the drive's.

    As many as coordinates, m, where the linkage has one degree of freedom and no constraint too many. What is asked of
    a long motion is found block by block.
    """

    def __init__(self, scene: Scene, motion: Motion, size: float | None = None) -> None:
        """Take the poses from the motion, whose kinematic channels must be complete, and L unless it is given."""
        self.state = State(scene, motion)
        self.size = size or _largest_length(self.state)
        self.column = {name: 3 * number for number, name in enumerate(scene.bodies)}
        self._rows: list[Matrices] = []

    def _blocks(self) -> Iterator["Constraints"]:
        motion = self.state.motion
        for start in range(0, len(motion["time"]), BLOCK):
            rows = {channel: samples[start : start + BLOCK] for channel, samples in motion.samples.items()}
            yield Constraints(self.state.scene, Motion(rows), self.size)

    @cached_property
    def jacobian(self) -> Matrices:
        """J, shape (n, rows, m)."""
        state, scene = self.state, self.state.scene
        for pin in scene.pins:
            r, s = (self._arm(name, state.place(pin.point)) for name in (pin.first, pin.second))
            self._row((pin.first, 1, -r.imag), (pin.second, -1, s.imag))
            self._row((pin.first, 1j, r.real), (pin.second, -1j, -s.real))
        for body in scene.bodies.values():
            if body.slide is not None:
                on = body.slide.on
                normal = 1j * np.exp(1j * state.angle(on)) * complex(*body.slide.along)
                r = self._arm(on, state.place(body.points[0]))
                self._row((body.name, normal, 0.0), (on, -normal, -(normal.conjugate() * 1j * r).real))
                self._row((body.name, 0, self.size), (on, 0, -self.size))
        slide = scene.driven_slide
        self._row((scene.drive.body, 0, self.size) if slide is None else (scene.drive.body, complex(*slide.along), 0.0))
        return np.stack(self._rows, axis=1)

    def _row(self, *terms: tuple[str, Vectors | complex, Samples | float]) -> None:
        """Add a constraint: by body, what its first point is projected on and what its turn adds."""
        row = np.zeros((len(self.state.motion["time"]), 3 * len(self.column)))
        for name, along, turn in terms:
            if name != GROUND:
                k, vector = self.column[name], np.asarray(along)
                row[:, k], row[:, k + 1], row[:, k + 2] = vector.real, vector.imag, np.asarray(turn) / self.size
        self._rows.append(row)

    def _arm(self, name: str, place: Vectors) -> Vectors:
        """Return the way to a place from the first point of a body; of the ground any will do."""
        first: Vectors = place if name == GROUND else place - self.state.place(self.state.scene.bodies[name].points[0])
        return first

    @cached_property
    def condition(self) -> Samples:
        """The condition number of the Jacobian in the 2-norm at each sample, shape (n,)."""
        values = np.concatenate([np.linalg.svd(block.jacobian, compute_uv=False) for block in self._blocks()])
        with np.errstate(divide="ignore"):
            return np.asarray(values[:, 0] / values[:, -1])

    @cached_property
    def branch(self) -> Samples:
        """The sign of the Jacobian's determinant at each sample, shape (n,): it changes only in a lock."""
        return np.concatenate([np.linalg.slogdet(block.jacobian)[0] for block in self._blocks()], dtype=np.float64)

    @cached_property
    def implied(self) -> tuple[Matrices, Matrices]:
        """The velocities and accelerations that the poses and the drive leave no choice of, shape (n, m).

        J q' = e rate, J q'' = e acceleration + γ(q, q'), where γ is what pins and guides accelerate by at q'' = 0:
        ω² r at a pin, and across a guide also Coriolis' 2 ω u, u being the speed along it.
        """
        velocities, accelerations = zip(*(block._implied() for block in self._blocks()), strict=True)
        return np.concatenate(velocities), np.concatenate(accelerations)

    def _implied(self) -> tuple[Matrices, Matrices]:
        """Return both of one block."""
        state, scene = self.state, self.state.scene
        _, rate, acceleration = scene.drive.at(state.motion["time"])
        lever = self.size if scene.driven_slide is None else 1.0
        right = np.zeros(self.jacobian.shape[:2])
        right[:, -1] = lever * rate
        velocities = self._solve(right)
        right[:, -1] = lever * acceleration
        right[:, :-1] = self._centripetal(velocities)
        return velocities, self._solve(right)

    def _centripetal(self, velocities: Matrices) -> Matrices:
        """Return γ but for the drive's row, shape (n, rows - 1)."""
        state, scene = self.state, self.state.scene

        def turning(name: str) -> Samples:
            rate: Samples = np.zeros(len(velocities)) if name == GROUND else velocities[:, self.column[name] + 2]
            return rate / self.size

        def first(name: str) -> Vectors:
            k = self.column[name]
            vector: Vectors = velocities[:, k] + 1j * velocities[:, k + 1]
            return vector

        found: list[Samples] = []
        for pin in scene.pins:
            towards = [turning(name) ** 2 * self._arm(name, state.place(pin.point)) for name in (pin.first, pin.second)]
            difference = towards[0] - towards[1]
            found += [difference.real, difference.imag]
        for body in scene.bodies.values():
            if body.slide is not None:
                on = body.slide.on
                normal = 1j * np.exp(1j * state.angle(on)) * complex(*body.slide.along)
                r, omega = self._arm(on, state.place(body.points[0])), turning(on)
                relative = first(body.name) - (0 if on == GROUND else first(on) + 1j * omega * r)
                carried = -(omega**2) * r + 2j * omega * relative
                found += [(normal.conjugate() * carried).real, np.zeros(len(velocities))]
        return np.stack(found, axis=1)

    def _solve(self, right: Matrices) -> Matrices:
        """Return the solutions, NaN in a singular pose."""
        regular = (np.linalg.slogdet(self.jacobian)[0] != 0)[:, np.newaxis]
        J = np.where(regular[..., np.newaxis], self.jacobian, np.eye(self.jacobian.shape[-1]))
        return np.where(regular, np.linalg.solve(J, right[..., np.newaxis])[..., 0], np.nan)


def _largest_length(state: State) -> float:
    """Return the largest known distance of a body's points, or of the ground's, m; without one, of a path."""
    ground = [complex(*place) for place in state.scene.ground.values()]
    known = [length for body in state.scene.bodies.values() for length in distances(body).values()]
    known += [abs(p - q) for p in ground for q in ground]
    paths = [state.place(point) for point in state.scene.moving_points]
    return max(known, default=0.0) or max(float(np.abs(path - path[0]).max()) for path in paths)
