"""How far two motions of one scene are apart, channel by channel, and how closely two exact ones must agree.

Roundings are 1.1e-16 of coordinates up to some 30 m. A dyad at 20 degrees from lock makes them 1 / sin(20 deg) = 3
times larger in positions and up to 3^3 = 27 times in accelerations and reactions; a second dyad does so once more.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

import analytic
from compare.engines import registry
from compare.mechanics.reference import Reference
from compare.mechanics.scales import relative_errors
from scenes import Motion, Request, Scene
from scenes.channels import named
from scenes.model.motion import Samples

Channels = Mapping[str, Samples]

ALIKE = {
    **{"y": "x", "vy": "vx", "ay": "ax", "fy": "fx"},
    **{"guide_force": "fx", "force": "fx", "guide_moment": "torque"},
}
# On the scale of `errors`. Of 400 drawn linkages a test the worst are 3e-14 and 1e-13: times ten for other draws.
MOTION, FORCES = 3e-13, 1e-12
TOLERANCE = dict.fromkeys(("time", "crank_angle", "displacement", "x", "angle", "vx", "omega"), MOTION) | dict.fromkeys(
    ("ax", "alpha", "fx", "torque"), FORCES
)

# Of the forces, at their arms and speeds: friction that is less is round-off, of joints that carry nothing.
NOTHING = 1e-6


def kind(channel: str) -> str:
    """Return what channels of one unit and one size have in common."""
    return ALIKE.get(named(channel).name, named(channel).name)


def scales(samples: Channels, mass: float = 0.0) -> dict[str, float]:
    """Return by kind what an error is relative to: 1 rad, the range of coordinates, the peak of all others.

    A kind that vanishes has the size of what it is a difference or a product of: where all guides stay parallel and the
    drive is steady, nothing turns or accelerates, so nothing of this mass, kg, needs a force; and a torque may vanish
    where the forces do not.
    """
    found: dict[str, float] = {"angle": 1.0, "crank_angle": 1.0}
    for channel, values in samples.items():
        of = kind(channel)
        if of not in ("angle", "crank_angle"):
            size = np.ptp(values) if of in ("x", "displacement") else np.abs(values).max()
            found[of] = max(found.get(of, 0.0), float(size))
    span, speed = found.get("x", 0.0) or 1.0, found.get("vx", 0.0)
    turning = max(found.get("omega", 0.0), speed / span)
    acceleration = max(found.get("ax", 0.0), speed**2 / span)
    force = max(found.get("fx", 0.0), mass * speed**2 / span)
    least = {"omega": turning, "alpha": turning**2, "ax": acceleration, "fx": force, "torque": force * span}
    of_friction = {"friction_force": force, "friction_moment": force * span, "power": force * speed}
    least |= {of: NOTHING * size for of, size in of_friction.items()}
    return {of: max(size, least.get(of, 0.0)) or 1.0 for of, size in found.items()}


def errors(motion: Motion, expected: Channels, whole: Channels | None = None, mass: float = 0.0) -> dict[str, Samples]:
    """Return the relative error of each channel expected, shape (n,); the scales are those of the whole motion."""
    scale, found = scales(whole or expected, mass), {}
    for channel, values in expected.items():
        difference = motion[channel] - values
        if named(channel).name == "angle":
            difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
        found[channel] = np.abs(difference) / scale[kind(channel)]
    return found


def worst(found: Channels) -> dict[str, float]:
    """Return the largest error of each kind; NaN where there is one."""
    largest: dict[str, float] = {}
    for channel, error in found.items():
        largest[kind(channel)] = float(np.maximum(largest.get(kind(channel), 0.0), error.max()))
    return largest


def instants(scene: Scene) -> Samples:
    return np.linspace(0, scene.cycle, 49)


def solve(scene: Scene, time: Samples | None = None) -> Motion:
    time = instants(scene) if time is None else time
    return analytic.solve(scene, scene.drive.law.at(time).position, time)


def exact(scene: Scene, request: Request) -> Motion:
    """Return the motion by the arbitrary-precision model, in 50 digits."""
    engine = registry.engine(registry.ORACLE)
    run = engine.build(scene, engine.DEFAULT, request)
    run.solve()
    motion: Motion = run.read()
    return motion


def off_50_digits(reference: Reference, request: Request) -> dict[str, Samples]:
    """Return how far the core is from 50 digits, by channel; a force is relative to the peak of its own joint."""
    scene = reference.scene
    true = exact(scene, request)
    motion = reference.at(true.inputs(scene))
    found = relative_errors(scene.channels, motion, true, reference.scale)
    assert set(found) == set(scene.channels.names()) - {"time"}
    return found


def assert_agree(scene: Scene, motion: Motion, expected: Channels, whole: Motion | None = None) -> None:
    """Compare every channel of the scene's motion with the one expected."""
    assert set(expected) == set(scene.channels.names())
    lightest = min((body.mass for body in scene.bodies.values() if body.mass), default=0.0)
    for channel, error in errors(motion, expected, whole.samples if whole else None, lightest).items():
        assert error.max() <= TOLERANCE[kind(channel)], channel


def attitude(scene: Scene, motion: Motion, body: str) -> NDArray[np.complex128]:
    angle = motion[f"{body}.angle"] if body in scene.turning else np.zeros(motion["time"].shape)
    return np.asarray(np.exp(1j * angle))


def where(scene: Scene, motion: Motion, point: str) -> NDArray[np.complex128]:
    if point in scene.ground:
        return np.full(motion["time"].shape, complex(*scene.ground[point]))
    return motion[f"{point}.x"] + 1j * motion[f"{point}.y"]
