"""A planar linkage in absolute coordinates: its constraints and masses, in arbitrary-precision balls.

The balls' radii include the rounding of the geometry, so a result's radius bounds its error.
"""

from functools import cached_property

import numpy as np
from flint import acb, arb, arb_mat

from scenes import Scene
from scenes.model.constraints import groups
from scenes.scene import GROUND

from .bodies import local_points, weight
from .drive import law_of
from .joints import RULES
from .rows import AXES, EquationRows, dot


class LinkageEquations:
    """The equations of one scene: f(q) = `constraints` is `drive(position)`; observed `points`, masses.

    The constraint rows are those of the scene's joints in their order, the drive's last, and a multiplier is the force
    channel of its row. It raises Failure where the lengths of a body do not close, or the sketch does not decide how.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.prescribed = scene.drive
        self.law = law_of(self.prescribed.law)
        self.index = {name: i for i, name in enumerate(scene.bodies)}
        self.arms: dict[str, dict[str, acb]] = {}  # from the centre of mass to the points, in the body's frame
        self.origins: dict[str, acb] = {}  # and to the frame's origin
        self.mass: list[arb] = []  # of every coordinate, kg or kg m^2
        for name in self.index:
            body = scene.bodies[name]
            local = local_points(scene, body)
            mass, com, inertia = weight(body, local)
            self.arms[name] = {point: place - com for point, place in local.items()}
            self.origins[name] = -com
            self.mass += mass, mass, inertia
        self.constraints = self._constraints()
        pattern = self.constraints.pattern
        self.groups = groups(pattern)
        self.transposed_groups = groups([[i for i, row in enumerate(pattern) if j in row] for j in range(len(pattern))])
        self.points = EquationRows(2 * len(scene.moving_points), len(self.index))  # x and y, as its first body has it
        for k, point in enumerate(scene.moving_points):
            for axis in (0, 1):
                self.add_point(self.points, 2 * k + axis, AXES[axis], scene.owners[point][0], point)
        self.position = EquationRows(1, len(self.index), int(self.prescribed.slide is not None))  # of the drive
        RULES[type(scene.joints[-1])](scene.joints[-1], self, self.position, 0)

    def rows(self, count: int) -> EquationRows:
        """Return so many rows of equations, to which terms are to be added."""
        return EquationRows(count, len(self.index))

    def drive(self, value: float | arb) -> arb_mat:
        """Return the goal of f(q) at a position of the drive, or of f' at its rate, of f'' at its acceleration."""
        goal = arb_mat(self.constraints.k.nrows(), 1)
        goal[goal.nrows() - 1, 0] = arb(value)
        return goal

    def add_point(self, rows: EquationRows, row: int, weight: acb, body: str, point: str) -> None:
        """Add the projection w·p of a point of a body or of the ground to a row."""
        if body == GROUND:
            rows.k[row, 0] += dot(weight, acb(*self.scene.ground[point]))
        else:
            rows.add_point(row, weight, self.index[body], self.arms[body][point])

    def add_way(self, rows: EquationRows, row: int, start: tuple[str, str], end: tuple[str, str]) -> None:
        """Add the way from one point of a body to another of another, x to a row and y to the next."""
        for axis in (0, 1):
            self.add_point(rows, row + axis, AXES[axis], *end)
            self.add_point(rows, row + axis, -AXES[axis], *start)

    def add_angle(self, rows: EquationRows, row: int, name: str, other: str) -> None:
        """Add the angle of a body from another; that of the ground is zero."""
        for body, sign in ((name, 1), (other, -1)):
            if body != GROUND:
                rows.add_angle(row, self.index[body], arb(sign))

    def displacement(self, body: str, point: str | None = None) -> EquationRows:
        """Return one row: the displacement of a slider's first point, or of another, along its guide, m."""
        slide = self.scene.slides[body]
        rows = EquationRows(1, len(self.index), int(slide.on != GROUND))
        self._add_projection(rows, 0, body, point or self.scene.bodies[body].points[0], acb(*slide.along))
        return rows

    @cached_property
    def size(self) -> float:
        """A length of the linkage's order, m: the spread of its points, or the driven slider's travel."""
        known = np.array([*self.scene.drawn.values()] or [0j])
        arms = (abs(complex(arm)) for arms in self.arms.values() for arm in arms.values())
        travel = 0.0 if self.prescribed.slide is None else self.prescribed.span
        return float(max(*np.abs(known - known.mean()), *arms, travel)) or 1.0

    @property
    def units(self) -> list[float]:
        """What every coordinate is measured by: the size, m, or 1 rad."""
        return [self.size, self.size, 1.0] * len(self.index)

    def _constraints(self) -> EquationRows:
        scene = self.scene
        moving = sum(slide.on != GROUND for slide in scene.slides.values())
        rows = EquationRows(sum(joint.equations for joint in scene.joints), len(self.index), moving, self.size)
        row = 0
        for joint in scene.joints:
            RULES[type(joint)](joint, self, rows, row)
            row += joint.equations
        return rows

    def add_slid(self, rows: EquationRows, row: int, body: str, *, across: bool = False) -> None:
        """Add the displacement of a slider's first point along its guide, or its offset."""
        along = acb(*self.scene.slides[body].along)
        self._add_projection(rows, row, body, self.scene.bodies[body].points[0], AXES[1] * along if across else along)

    def _add_projection(self, rows: EquationRows, row: int, name: str, point: str, direction: acb) -> None:
        """Add the way from `through` of a guide to a point P of its slider, projected on a direction e of the guide.

        On a moving body with the frame z + e^{iθ}, it is e·(e^{-iθ} (P - z) - through). Since the frames are
        parallel, e^{-iθ} (P - r_b) is the arm s + i s (θ_b - θ) to within the square of that difference, which the
        slide's other row keeps zero: what is left is linear but for the way from one centre of mass to the other.
        """
        slide, slider, arm = self.scene.slides[name], self.index[name], self.arms[name][point]
        rows.k[row, 0] -= dot(direction, acb(*slide.through))
        if slide.on == GROUND:
            rows.add_point(row, direction, slider, arm)
            return
        carrier = self.index[slide.on]
        rows.k[row, 0] += dot(direction, arm) - dot(direction, self.origins[slide.on])
        rows.add_guide(row, direction, carrier, slider)
        # The slider's point in the carrier's frame, s + i s (theta_b - theta): its constant part is in k, the part with
        # the angle's difference here.
        lever = dot(direction, AXES[1] * arm)
        rows.add_angle(row, slider, lever)
        rows.add_angle(row, carrier, -lever)
