"""Faults in gravity, in the friction of joints, and friction where the scene has none."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import permutations

import numpy as np

from compare.judge.canaries import spoilt_motion as spoilt
from compare.judge.causes.cause import Kind
from scenes.fields import put
from scenes.model.motion import Samples
from scenes.scene import PinFriction, PressForce

from .fault import Clean, Fault
from .spoilt_scene import SIZES

G = 9.81  # m/s^2


def gravity(clean: Clean) -> Iterator[Fault]:
    """Yield other gravity than the scene's; where it has none, some."""
    scene = clean.scene
    if not any(body.mass for body in scene.bodies.values()):
        return
    if scene.gravity is None:
        for kind, vector in {"added": (0.0, -G), "added upwards": (0.0, G), "added sideways": (G, 0.0)}.items():
            yield Fault("gravity", f"gravity {kind}", G, Kind.gravity, "all", scene=replace(scene, gravity=vector))
        return
    own = complex(*scene.gravity)
    others = {
        "missing": 0,
        "of the opposite sign": -own,
        "doubled": 2 * own,
        "turned": 1j * own,
        "in mm/s^2": 1e3 * own,
    }
    others |= {"10 for 9.81": own * 10 / G, "9.8 for 9.81": own * 9.8 / G, "tilted by a degree": own * np.exp(0.0175j)}
    others |= {"of the moon": own / 6, "with x and y swapped": own.imag + 1j * own.real}
    for kind, other in others.items():
        wrong = replace(scene, gravity=None if other == 0 else (float(other.real), float(other.imag)))
        yield Fault("gravity", f"gravity {kind}", float(abs(other - own) / abs(own)), Kind.gravity, "all", scene=wrong)


def friction(clean: Clean) -> Iterator[Fault]:
    """Yield dry and viscous friction at guides and in the drive."""
    scene, motion = clean.scene, clean.motion
    if not scene.has_masses:
        return
    effort = next(name for name in motion.samples if name in ("drive.torque", "drive.force"))
    peak = clean.reference.scale[effort]
    grounded = [name for name, body in scene.bodies.items() if body.slide is not None and body.slide.on == "ground"]
    rate = scene.drive.law.at(motion["time"]).rate
    turns_on = scene.drive.slide is None and np.all(rate != 0)

    def of_drive(kind: str, by: float, place: str, more: Samples) -> Fault:
        spoil = partial(spoilt.replaced, motion, {effort: motion[effort] + more})
        return Fault("friction", kind, by, Kind.friction, place, spoil)

    for by in (0.3, 0.03, 5 * clean.promise):
        for name in clean.some([one for one in grounded if one != scene.drive.body], f"guide {by}"):
            body = scene.bodies[name]
            assert body.slide is not None
            size = by * float(np.abs(motion[f"{name}.guide_force"]).max())
            if not size > 0:
                continue
            x, y = (size * component for component in body.slide.along)
            always = 10 * clean.reference.stroke
            pair = (PressForce(name, body.points[0], (-sign * x, -sign * y), always, sign) for sign in (1, -1))
            spoilt_scene = replace(scene, loads=(*scene.loads, *pair))
            yield Fault("friction", "dry friction at a guide", by, Kind.friction, name, scene=spoilt_scene)
        yield of_drive("viscous friction in the drive", by, "drive", by * peak * rate / scene.drive.law.peak_rate)
        yield of_drive("dry friction in the drive", by, "drive", by * peak * np.sign(rate))
        for name in clean.some(grounded, f"viscous {by}") if turns_on else ():
            _, v = clean.state.displacement(scene.bodies[name])
            size = by * float(np.abs(motion[f"{name}.guide_force"]).max())
            drag = size * np.abs(v) / np.abs(v).max()
            yield of_drive("viscous friction at a guide, by the drive alone", by, name, drag * np.abs(v) / rate)
        for pin in clean.some(scene.pins, f"pin {by}") if turns_on else ():
            force = np.abs(clean.state.vector(*clean.state.scene.channels.pins[pin.channel]))
            turning = np.abs(clean.state.turning(pin.second)[1] - clean.state.turning(pin.first)[1])
            lost = by * 0.05 * clean.reference.stroke * force * turning
            yield of_drive("friction in a pin, by the drive alone", by, pin.channel, lost / rate)


def friction_of_joints(clean: Clean) -> Iterator[Fault]:
    """Yield other friction than the scene's: left out, backwards, of other numbers, and at another pin."""
    scene, rubs = clean.scene, clean.scene.friction

    def fault(kind: str, by: float, place: str, changed: dict[tuple[int, str], float]) -> Fault:
        other = put(scene, {("friction", *at): value for at, value in changed.items()})
        return Fault("friction of joints", kind, by, Kind.friction, place, scene=other)

    def times(factor: float, key: str, *numbers: int) -> dict[tuple[int, str], float]:
        return {(number, key): factor * (getattr(rubs[number], key) or 0.0) for number in numbers}

    every, resisting = range(len(rubs)), ("coefficient", "viscous")
    for what, factor in {"left out": 0.0, "of the wrong sign": -1.0}.items():
        for numbers in [*((number,) for number in clean.some(every, what, 2)), *([every] if len(rubs) > 1 else [])]:
            place = "all" if len(numbers) > 1 else rubs[numbers[0]].joint(scene)
            changed = {at: size for key in resisting for at, size in times(factor, key, *numbers).items()}
            kind = f"{'all ' if place == 'all' else ''}friction {what}"
            yield fault(kind, 1 - factor, place, changed)
    for by in (1.0, *SIZES):
        for key in (*resisting, "radius", "length"):
            for number in clean.some([n for n in every if getattr(rubs[n], key, None)], f"{key} {by}"):
                yield fault(f"friction's {key}", by, rubs[number].joint(scene), times(1 + by, key, number))
    pins = {number: one for number, one in enumerate(rubs) if isinstance(one, PinFriction)}
    for one, other in clean.some(permutations(pins, 2), "another pin", 2):
        changed = {**times(0.0, "radius", one), **times(1 + pins[one].arm / pins[other].arm, "radius", other)}
        yield fault("friction at another pin", 1, pins[one].joint(scene), changed)
