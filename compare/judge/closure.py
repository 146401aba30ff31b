"""Whether a motion's joints are closed, and its velocities and accelerations are those that its poses ask for.

By its own channels alone. Where joints are closed, the drive is where it should be and no branch was changed, there is
no other motion of the linkage.
"""

from collections.abc import Iterator

import numpy as np

from scenes import Scene
from scenes.motion import Samples
from scenes.scene import GROUND, Body

from ..engines.state import State, distances
from .constraints import Constraints

TELLING = 1e-2  # of a rate: a tenth of what a guard lets pass


def closed_by(scene: Scene, body: Body) -> set[str]:
    """Return the channels that say whether a body's joints are closed."""
    points, names = set(body.points), set[str]()
    if body.slide is not None:
        names = {body.name, body.slide.on}
        points |= set(() if body.slide.on == GROUND else scene.bodies[body.slide.on].points[:1])
    angles = {f"{name}.angle" for name in names if name in scene.turning}
    return angles | {f"{point}.{axis}" for point in points - set(scene.ground) for axis in "xy"}


def gaps(state: State, body: Body, stroke: float) -> Samples:
    """Return by how much the body's points miss their distances, and it its guide, relative to the stroke, shape (n,).

    A point belongs to every body that names it, so a pin that is open shows as a wrong distance in one of them. A body
    that is turned against its guide is off by that angle, rad, at an arm of one stroke.
    """
    gap = np.zeros(state.motion["time"].shape)
    for (p, q), length in distances(body).items():
        gap = np.maximum(gap, np.abs(np.abs(state.place(p) - state.place(q)) - length) / stroke)
    if body.slide is not None:
        gap = np.maximum(gap, np.abs(state.on_guide(body).imag) / stroke)
        if body.name in state.scene.turning:
            between = state.angle(body.name) - state.angle(body.slide.on)
            gap = np.maximum(gap, np.abs(np.remainder(between + np.pi, 2 * np.pi) - np.pi))
    return gap


def rates(constraints: Constraints) -> Iterator[tuple[str, str, Samples]]:
    """Yield quantity, body and by how much its rates are off those of its own poses, relative to the peak, shape (n,).

    Turning counts at an arm of the linkage's largest length. Next to a singular pose nothing is said: there κ² ε, the
    part of an acceleration that rounding of the poses may change, is of its own size.
    """
    tell = constraints.condition**2 * np.finfo(float).eps < TELLING
    for derivative, quantity in ((1, "velocity"), (2, "acceleration")):
        peak = float(np.abs(constraints.implied[derivative - 1][tell]).max(initial=0.0)) or 1.0
        for name, body in constraints.state.scene.bodies.items():
            yield quantity, name, np.where(tell, _off(constraints, body, derivative), 0.0) / peak


def _off(constraints: Constraints, body: Body, derivative: int) -> Samples:
    """Return the largest difference of the body's points and turning, m/s or m/s^2, shape (n,)."""
    state = constraints.state
    k = constraints.column[body.name]
    v, a = (rate[:, k] + 1j * rate[:, k + 1] for rate in constraints.implied)
    omega, alpha = (rate[:, k + 2] / constraints.size for rate in constraints.implied)
    turn = (omega, alpha)[derivative - 1]
    off: Samples = constraints.size * np.abs(state.turning(body.name)[derivative] - turn)
    first = state.place(body.points[0])
    for point in body.points:
        r = state.place(point) - first
        rigid = (v + 1j * omega * r, a + (1j * alpha - omega**2) * r)[derivative - 1]
        off = np.maximum(off, np.abs(state.point(point)[derivative] - rigid))
    return off
