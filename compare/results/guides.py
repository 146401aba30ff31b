"""A guide's force by the ground's axes, `BODY.guide_fx` and `BODY.guide_fy`, as this project's `BODY.guide_force`.

With n the unit vector along the guide turned by +90 degrees, which turns with what has the guide, the force (X, Y) is
X n_x + Y n_y across the guide. A component along the guide can only be friction; without friction it has to vanish.
"""

from collections.abc import Mapping

import numpy as np

from scenes import InputError, Scene
from scenes.channels import Role
from scenes.model.motion import Samples

LEVEL_TOL = 1e-12  # of a unit vector: a component that is less is none


def to_guides(scene: Scene, columns: dict[str, Samples], halves: dict[str, Samples], promise: float) -> None:
    """Replace components of guides' forces, N, in the scene's frame, by those across the guides; and their decimals."""
    channels = scene.channels
    rows = (channels[name] for name in channels.names(Role.given) if name in columns)
    for body, names in {row.subject: row.components for row in rows}.items():
        given = next(name for name in names if name in columns)
        if (across := channels.guides[body].force) in columns:
            raise InputError(f"columns.{given}: expected it, or {across}, found both")
        along, error = _along(scene, body, given, columns, halves)
        zero = np.zeros_like(columns[given])
        for name, part in zip(names, (along.imag, along.real), strict=True):  # of the normal
            if name not in columns and np.abs(part).max() > LEVEL_TOL:
                raise InputError(f"columns.{given}: expected {name} too, as the guide is along no axis")
        force = columns.pop(names[0], zero) + 1j * columns.pop(names[1], zero)
        half = halves.pop(names[0], zero) + 1j * halves.pop(names[1], zero)
        # The force in the guide's axes: the real part along it, which only friction can have, the imaginary part across
        # it. Its share along the guide may be as large as decimals and the guide's angle as written allow, and no
        # larger.
        in_guide = force * along.conj()
        columns[across] = in_guide.imag
        halves[across] = half.real * np.abs(along.imag) + half.imag * np.abs(along.real)
        peak = np.abs(force).max()
        excess = np.abs(in_guide.real) - half.real - half.imag - (error + promise) * peak
        if channels.find("guide", body, "friction_force") is None and excess.max() > 0:
            share = np.abs(in_guide.real).max() / peak
            raise InputError(
                f"columns.{given}: expected a force across the guide, found up to {share:.2g} of its largest along it"
            )


def _along(
    scene: Scene, body: str, given: str, columns: Mapping[str, Samples], halves: Mapping[str, Samples]
) -> tuple[Samples, Samples | float]:
    """Return the unit vector along a guide, x + iy, and by how much its angle may be off as written, rad."""
    slide = scene.slides[body]
    along = np.array(complex(*slide.along))
    if body not in scene.turning:
        return along, 0.0
    angles = [scene.channels.bodies[name].angle for name in (body, slide.on)]
    for angle in angles:
        if angle in columns:
            return np.asarray(np.exp(1j * columns[angle]) * along), halves[angle]
    raise InputError(f"columns.{given}: expected {' or '.join(angles)} too, with which the guide turns")
