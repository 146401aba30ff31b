"""A linkage as an engine sees it: coordinates and constraints, by which its poses are found.

A step goes from a pose to the one where C(x) = g, along the straight line between C and g, predicted by two derivatives
and corrected by Newton's method. The Jacobian of a prediction serves all its corrections, which therefore shrink by a
constant factor: where that is not small, the step was too long.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from scenes import Scene
from scenes.elements.element import End
from scenes.joints import Guide
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .bodies import MovingBody, framed_body, linkage_size
from .joints import RULES
from .loads import MIN_SPRING_LENGTH, LoadedPose, Wrench, applied

MAX_CONTRACTION = 0.25  # of a correction to the one before
MAX_FIRST_CORRECTION = 0.1  # of a step
MAX_ITERATIONS = 20
CONVERGED_TOL = 1e-9  # the last correction, from where only rounding may stop the next ones from shrinking
ROUND_OFF = 1e-15
solved: Any = np.linalg.solve  # A^-1 b; LinAlgError where A is singular


class GuideLine(NamedTuple):
    """A slide, in the frames of its two bodies."""

    carrier: str
    through: complex  # m, in the carrier's frame
    along: complex
    first: complex  # the slider's first point, m, in its own frame


class ClosedPose(NamedTuple):
    """Coordinates where C(x) = g, shape (n,), and the Jacobian there, shape (n, n)."""

    x: Samples
    J: Samples

    @property
    def branch(self) -> float:
        """The sign of det J, which changes only where two branches meet."""
        return float(np.linalg.slogdet(self.J)[0])


class System:
    """The constraints C(x) = e s of n coordinates; s is the drive's position, e the last unit vector.

    The coordinates are the place of every body's origin and its angle; or of a slider, where slides are coordinates and
    no constraints, how far it is along its guide. They are over the linkage's size or 1 rad, and so are the rows of C:
    x and y of each pin, second - first; of each slide the offset of its first point along the guide's normal, and its
    angle from the guide; the position of the drive. Where bodies move, a row has two derivatives by the time: with one
    coordinate at a rate of 1, the first is its column of the Jacobian; without accelerations of coordinates, the second
    is the bend.
    """

    def __init__(self, scene: Scene, *, slides: bool = False) -> None:
        """Set up bodies and units; `slides` are coordinates."""
        self.scene = scene
        self.bodies = {name: framed_body(scene, body) for name, body in scene.bodies.items()}
        self.size = linkage_size(scene, self.bodies)
        self.drive = scene.drive
        self.arms = {
            (GROUND, point): complex(*place) for point, place in scene.ground.items()
        }  # in the bodies' frames, m
        self.arms |= {
            (name, point): place for name, body in self.bodies.items() for point, place in body.points.items()
        }
        self.guides = dict[str, GuideLine]()
        for name, slide in scene.slides.items():
            through, along = complex(*slide.through), complex(*slide.along)
            self.guides[name] = GuideLine(slide.on, through, along, self.arms[name, scene.bodies[name].points[0]])
        # Those that are constraints; the drive is the last.
        self.joints = [joint for joint in scene.joints if not (slides and isinstance(joint, Guide))]
        self.coordinates = [coordinate for name in self.bodies for coordinate in self.coordinates_of(name)]
        self.units = np.array([1.0 if name.endswith(".turn") else self.size for name in self.coordinates])

    def coordinates_of(self, body: str) -> list[str]:
        """Return the names of a body's coordinates; that which may be driven is the last."""
        slides = body in self.guides and not any(isinstance(joint, Guide) for joint in self.joints)
        return [f"{body}.s"] if slides else [f"{body}.x", f"{body}.y", f"{body}.turn"]

    def placed(self, bodies: Mapping[str, MovingBody]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,); joints that hold them apart stay open."""
        q = list[float]()
        for name in self.bodies:
            moving = bodies[name]
            slides = len(self.coordinates_of(name)) == 1
            q += [self.slid(bodies, name)[0].real] if slides else [moving.origin.real, moving.origin.imag, moving.angle]
        return np.asarray(np.array(q) / self.units)

    def moved(self, x: Samples, v: Samples | None = None, a: Samples | None = None) -> dict[str, MovingBody]:
        """Return how bodies move, by coordinates of shape (n,) and their derivatives, or each of shape (k, n)."""
        levels = [np.zeros(len(self.units)) if level is None else level * self.units for level in (x, v, a)]
        columns = [dict(zip(self.coordinates, level.T, strict=True)) for level in levels]
        bodies = {GROUND: MovingBody()}
        for name in self.carriers_first():
            levels_of = ([level[coordinate] for coordinate in self.coordinates_of(name)] for level in columns)
            if len(self.coordinates_of(name)) > 1:
                (x, y, angle), (dx, dy, omega), (ddx, ddy, alpha) = levels_of
                turn = np.exp(1j * angle)
                bodies[name] = MovingBody(x + 1j * y, angle, turn, dx + 1j * dy, omega, ddx + 1j * ddy, alpha)
                continue
            carrier, through, along, first = self.guides[name]
            carrier_motion, ((x,), (dx,), (ddx,)) = bodies[carrier], levels_of
            # A slider by its displacement x alone: the place of the carrier's guide at x, with the relative velocity
            # along the guide and the Coriolis acceleration 2 i omega x'. It turns with its carrier.
            place, velocity, acceleration = carrier_motion.at(through + along * x - first)
            guide = carrier_motion.turn * along
            velocity, acceleration = (
                velocity + guide * dx,
                acceleration + guide * (ddx + 2j * carrier_motion.omega * dx),
            )
            bodies[name] = carrier_motion._replace(origin=place, velocity=velocity, acceleration=acceleration)
        return bodies

    def carriers_first(self) -> list[str]:
        """Return the bodies, each behind that on which it slides."""

        def depth(name: str) -> int:
            return 1 + depth(self.guides[name].carrier) if name in self.guides else 0

        return sorted(self.bodies, key=depth)

    @cached_property
    def row_units(self) -> Samples:
        """What the rows of C are over, m or rad, shape (m,)."""
        return np.array([unit for joint in self.joints for unit in RULES[type(joint)].units(self.size)])

    @property
    def drive_unit(self) -> float:
        """What the drive's position is over, m or rad."""
        return float(self.row_units[-1])

    def gaps(self, x: Samples) -> Samples:
        """Return C(x), shape (m,), at coordinates of shape (n,)."""
        return self.rows_of(self.moved(x), 0)

    def jacobian(self, x: Samples) -> Samples:
        """Return C_x, shape (m, n)."""
        return self.rows_of(self.moved(x, np.eye(len(x))), 1)

    def bend(self, x: Samples, v: Samples) -> Samples:
        """Return (C_x v)_x v, shape (m,): second derivatives along a straight line in x."""
        return self.rows_of(self.moved(x, v), 2)

    def rows_of(self, bodies: Mapping[str, MovingBody], level: int) -> Samples:
        """Return the rows' values, shape (m,), or their first or second derivatives, of bodies as they move."""
        rows = [row for joint in self.joints for row in RULES[type(joint)].rows(joint, self, bodies, level)]
        return np.asarray((np.array(rows).T / self.row_units).T)

    def driven(self, bodies: Mapping[str, MovingBody], level: int = 0) -> Any:
        """Return the position of the drive, or its first or second derivative by the time."""
        (position,) = RULES[type(self.joints[-1])].rows(self.joints[-1], self, bodies, level)
        return position

    def step(self, pose: ClosedPose, goal: Samples) -> tuple[ClosedPose | None, int]:
        """Return the pose where C(x) = goal, None where the step is too long, and the iterations of Newton's method."""
        iterations = 0
        try:
            rate = solved(pose.J, goal - self.gaps(pose.x))
            way = rate - solved(pose.J, self.bend(pose.x, rate)) / 2
            x = pose.x + way
            J, largest = self.jacobian(x), MAX_FIRST_CORRECTION * np.abs(way).max() + CONVERGED_TOL
            for iterations in range(1, MAX_ITERATIONS + 1):
                correction = solved(J, goal - self.gaps(x))
                length = np.abs(correction).max()
                if not (length <= largest or length <= CONVERGED_TOL):
                    return None, iterations
                x = x + correction
                if length <= ROUND_OFF or (length <= CONVERGED_TOL and length > largest):
                    break
                # Corrections have to shrink by a constant factor, as those of simplified Newton do in its region of
                # convergence. At CONVERGED_TOL round-off may stop them; else slow ones mean that the prediction was too
                # far off.
                largest = MAX_CONTRACTION * length
            return ClosedPose(x, self.jacobian(x)) if length <= CONVERGED_TOL else None, iterations
        except np.linalg.LinAlgError:
            return None, iterations

    def slid(self, bodies: Mapping[str, MovingBody], slider: str) -> tuple[Any, Any, Any]:
        """Return a slider's first point less `through`, over `along`, and its derivatives, in the guide's frame.

        The real part is the displacement, m, the imaginary one the offset; the derivatives are by the rule of Coriolis.
        """
        carrier, through, along, first = self.guides[slider]
        carrier_motion = bodies[carrier]
        p, v, a = (
            point - guide for point, guide in zip(bodies[slider].at(first), carrier_motion.at(through), strict=True)
        )
        # Velocity and acceleration relative to the turning guide: transport and Coriolis terms are taken off.
        seen, axis = v - 1j * carrier_motion.omega * p, (carrier_motion.turn * along).conjugate()
        return (
            axis * p,
            axis * seen,
            axis * (a - (1j * carrier_motion.alpha - carrier_motion.omega**2) * p - 2j * carrier_motion.omega * seen),
        )

    def kinematics(self, bodies: Mapping[str, MovingBody]) -> dict[str, Any]:
        """Return the channels that describe the motion of bodies, but the time."""
        channels = self.scene.channels
        samples = {channels.drive.position: self.driven(bodies)}
        for point, names in channels.points.items():
            body = self.scene.owners[point][0]
            for (x, y), vector in zip(names, bodies[body].at(self.arms[body, point]), strict=True):
                samples |= {x: vector.real, y: vector.imag}
        for name, rates in channels.bodies.items():
            samples |= zip(rates, bodies[name].turning, strict=True)
        return samples

    def applied(self, bodies: Mapping[str, MovingBody], ends: Mapping[str, float]) -> Iterator[Wrench]:
        """Yield what loads and springs do, given where the press forces' strokes end, see `loads`."""

        def place(end: End) -> Any:
            return bodies[end[0]].place(self.arms[end])

        def slid(slider: str) -> tuple[Any, Any]:
            displacement, velocity, _ = self.slid(bodies, slider)
            return displacement.real, velocity.real

        return applied(LoadedPose(self.scene, ends, slid, place, MIN_SPRING_LENGTH * self.size))
