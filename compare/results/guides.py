"""A guide's force by the ground's axes, `BODY.guide_fx` and `BODY.guide_fy`, as this project's `BODY.guide_force`.

With n the unit vector along the guide turned by +90 degrees, which turns with what has the guide, the force (X, Y) is
X n_x + Y n_y across the guide. What it has along the guide is friction's; where there is none, it has to vanish.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from scenes import InputError, Scene
from scenes.model.motion import Samples, friction_channels

GUIDE = ("guide_fx", "guide_fy")
LEVEL = 1e-12  # of a unit vector: a component that is less is none


def guide_components(scene: Scene) -> Iterator[str]:
    """Yield the names of the components of guides' forces; none in a kinematic scene."""
    for body in scene.slides if scene.has_masses else ():
        yield from (f"{body}.{name}" for name in GUIDE)


def to_guides(scene: Scene, columns: dict[str, Samples], halves: dict[str, Samples], promise: float) -> None:
    """Replace components of guides' forces, N, in the scene's frame, by those across the guides; and their decimals."""
    for body in dict.fromkeys(name.rpartition(".")[0] for name in guide_components(scene) if name in columns):
        names = [f"{body}.{name}" for name in GUIDE]
        given = next(name for name in names if name in columns)
        if (across := f"{body}.guide_force") in columns:
            raise InputError(f"columns.{given}: expected it, or {across}, found both")
        along, off = _along(scene, body, columns, halves)
        zero = np.zeros_like(columns[given])
        for name, part in zip(names, (along.imag, along.real), strict=True):  # of the normal
            if name not in columns and np.abs(part).max() > LEVEL:
                raise InputError(f"columns.{given}: expected {name} too, as the guide is along no axis")
        force = columns.pop(names[0], zero) + 1j * columns.pop(names[1], zero)
        half = halves.pop(names[0], zero) + 1j * halves.pop(names[1], zero)
        own = force * along.conj()
        columns[across] = own.imag
        halves[across] = half.real * np.abs(along.imag) + half.imag * np.abs(along.real)
        peak = np.abs(force).max()
        beside = np.abs(own.real) - half.real - half.imag - (off + promise) * peak
        if f"{body}.friction_force" not in friction_channels(scene) and beside.max() > 0:
            share = np.abs(own.real).max() / peak
            raise InputError(
                f"columns.{given}: expected a force across the guide, found up to {share:.2g} of its largest along it"
            )


def _along(
    scene: Scene, body: str, columns: Mapping[str, Samples], halves: Mapping[str, Samples]
) -> tuple[Samples, Samples | float]:
    """Return the unit vector along a guide, x + iy, and by how much its angle may be off as written, rad."""
    slide = scene.slides[body]
    along = np.array(complex(*slide.along))
    if body not in scene.turning:
        return along, 0.0
    angles = [f"{name}.angle" for name in (body, slide.on)]
    for angle in angles:
        if angle in columns:
            return np.asarray(np.exp(1j * columns[angle]) * along), halves[angle]
    raise InputError(f"columns.{body}.{GUIDE[0]}: expected {' or '.join(angles)} too, with which the guide turns")
