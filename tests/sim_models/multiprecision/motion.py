"""A motion of absolute channels as vectors: what bodies carry, what acts on them, and what holds them."""

import numpy as np

from scenes import Motion, Scene
from scenes.loads import Force, PressForce
from scenes.scene import GROUND

from .runs import Array, Complex, named


def inertia(scene: Scene, motion: Motion, name: str) -> float:
    body = scene.bodies[name]
    if body.inertia is not None:
        return body.inertia
    assert body.mass is not None
    p = [point_motion(scene, motion, point)[0][0] for point in body.points]
    squares = sum(abs(p[i] - p[j]) ** 2 for i in range(len(p)) for j in range(i))
    return body.mass * float(squares) / {1: 1, 2: 12, 3: 36}[len(p)]


def point_motion(scene: Scene, motion: Motion, point: str) -> list[Complex]:
    """Return position, velocity and acceleration as complex numbers."""
    if point in scene.ground:
        still = np.zeros(len(motion["time"]), complex)
        return [still + complex(*scene.ground[point]), still, still]
    return [motion[f"{point}.{q}x"] + 1j * motion[f"{point}.{q}y"] for q in ("", "v", "a")]


def turning(motion: Motion, name: str) -> tuple[Array, Array, Array]:
    if f"{name}.angle" in motion:
        return motion[f"{name}.angle"], motion[f"{name}.omega"], motion[f"{name}.alpha"]
    still = np.zeros(len(motion["time"]))
    return still, still, still


def carried(scene: Scene, motion: Motion, name: str, at: complex) -> list[Complex]:
    """Return the motion of what a body carries at a place of its own frame; the ground's frame stands still."""
    if name == GROUND:
        still = np.zeros(len(motion["time"]), complex)
        return [still + at, still, still]
    body = scene.bodies[name]
    angle, omega, alpha = turning(motion, name)
    arm = (at - (complex(*body.local[body.points[0]]) if body.local is not None else 0)) * np.exp(1j * angle)
    p, v, a = point_motion(scene, motion, body.points[0])
    return [p + arm, v + 1j * omega * arm, a + (1j * alpha - omega**2) * arm]


def mass_centre(scene: Scene, motion: Motion, name: str) -> list[Complex]:
    body = scene.bodies[name]
    if body.com is not None:
        return carried(scene, motion, name, complex(*body.com))
    every = [point_motion(scene, motion, point) for point in body.points]
    return [sum(derivatives) / len(every) for derivatives in zip(*every, strict=True)]


def slid(scene: Scene, motion: Motion, name: str) -> list[Complex]:
    """Return a slider's first point less `through`, over `along`, and its derivatives, as the guide's frame has them.

    The real part is the displacement, the imaginary one the offset; by the rule of Coriolis.
    """
    slide = scene.bodies[name].slide
    assert slide is not None
    angle, omega, alpha = turning(motion, slide.on)
    p, v, a = (
        point - guide
        for point, guide in zip(
            point_motion(scene, motion, scene.bodies[name].points[0]),
            carried(scene, motion, slide.on, complex(*slide.through)),
            strict=True,
        )
    )
    guide = complex(*slide.along) * np.exp(1j * angle)
    seen = v - 1j * omega * p
    return [p / guide, seen / guide, (a - (1j * alpha - omega**2) * p - 2j * omega * seen) / guide]


def size_of(scene: Scene, motion: Motion, q: str) -> float:
    """Return the largest coordinate of any point, or its derivative."""
    return max(float(np.abs(motion[f"{point}.{q}{axis}"]).max()) for point in scene.moving_points for axis in "xy")


def acting(scene: Scene, motion: Motion) -> list[tuple[str, str, Complex, Array]]:
    """Return body, point, force and the size of its terms for every load and spring."""
    none = np.zeros(len(motion["time"]))
    found: list[tuple[str, str, Complex, Array]] = []
    for load in scene.loads:
        if isinstance(load, Force):
            force = complex(*load.force) + none
        elif isinstance(load, PressForce):
            x, v, _ = (values.real for values in slid(scene, motion, load.body))
            fine = slid(scene, named(scene.name, 144), load.body)[0].real * load.closing
            acts = load.acts(x, v, load.closing * float(fine.max()))  # no sample is so near to where it begins
            assert 0 < acts.sum() < len(acts)
            force = complex(*load.force) * acts
        else:
            slide = scene.bodies[load.body].slide
            assert slide is not None
            force = complex(*slide.along) * load.along(np.asarray(slid(scene, motion, load.body)[0].real, float))
        found.append((load.body, load.at, force, none + np.abs(force).max()))
    for spring in scene.springs:
        ends = [point_motion(scene, motion, point)[0] for _, point in (spring.first, spring.second)]
        length = np.abs(ends[1] - ends[0])
        pull = spring.stiffness * (length - spring.length) * (ends[1] - ends[0]) / length
        size = spring.stiffness * (length + spring.length)
        found += [(*spring.first, pull, size), (*spring.second, -pull, size)]
    return found


def reactions(scene: Scene, motion: Motion, name: str) -> list[tuple[str, Complex, Array]]:
    """Return point, force and couple of every joint and the drive on a body."""
    none = np.zeros(len(motion["time"]))
    found: list[tuple[str, Complex, Array]] = []
    for pin in scene.pins:
        if name in (pin.first, pin.second):
            of_first = motion[f"{pin.channel}.fx"] + 1j * motion[f"{pin.channel}.fy"]
            found.append((pin.point, of_first if name == pin.second else -of_first, none))
    for slider in scene.bodies.values():
        if slider.slide is not None and name in (slider.name, slider.slide.on):
            guide = complex(*slider.slide.along) * np.exp(1j * turning(motion, slider.slide.on)[0])
            sign = 1 if name == slider.name else -1
            force = sign * 1j * guide * motion[f"{slider.name}.guide_force"]
            found.append((slider.points[0], force, sign * motion[f"{slider.name}.guide_moment"]))
    if name == scene.drive.body:
        if scene.driven_slide is None:
            found.append((scene.bodies[name].points[0], none + 0j, motion["drive.torque"]))
        else:
            along = complex(*scene.driven_slide.along)
            found.append((scene.bodies[name].points[0], along * motion["drive.force"], none))
    return found
