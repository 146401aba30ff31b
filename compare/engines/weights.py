"""What each body weighs: mass, centre of mass and inertia as the judge takes them, and by which rule of the scene."""

from typing import NamedTuple

from scenes import Scene
from scenes.scene import Body

from .motion_vectors import arms, first_point, inertia


class Weights(NamedTuple):
    """What a body's inertia is."""

    mass: float  # kg
    com: complex  # m, from the body's first point, along the axes of its frame
    inertia: float  # kg m^2, about the centre of mass


def weights(scene: Scene, body: Body) -> Weights:
    """Return a body's own; without a mass it has none."""
    placed = arms(scene, body)
    uniform = sum(placed[point] for point in body.corners) / len(body.corners)
    com = uniform if body.com is None else complex(*body.com) - first_point(body)
    return Weights(body.mass or 0.0, com, inertia(body))


def rule(body: Body) -> str:
    """Return what a body was taken for: `uniform bar from A to C`."""
    if body.com is not None:
        return "as given"
    match body.corners:
        case [point]:
            return f"point mass at {point}"
        case [end, other]:
            return f"uniform bar from {end} to {other}"
        case corners:
            return f"uniform triangular plate {', '.join(corners)}"
