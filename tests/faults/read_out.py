"""Faults in what an engine reads out: opposite signs, other frames and units, other points, bodies and joints."""

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import pairwise
from math import pi
from typing import TypeAlias

import numpy as np

from compare.judge.canaries import spoilt_motion as spoilt
from compare.judge.causes.cause import Kind
from compare.mechanics.bodies import first_point
from compare.mechanics.motion_vectors import Vectors
from scenes import Motion
from scenes.channels import named
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .fault import OF_BODIES, OF_POINTS, Clean, Fault

Change: TypeAlias = Callable[[Vectors], Vectors]
UNITS = (
    ("x", "mm in place of m", 1e3),
    ("angle", "degrees in place of radians", 180 / pi),
    ("omega", "rpm in place of rad/s", 30 / pi),
    ("alpha", "deg/s^2 in place of rad/s^2", 180 / pi),
    ("fx", "kN in place of N", 1e-3),
    ("torque", "N mm in place of N m", 1e3),
    ("vx", "mm/s in place of m/s", 1e3),
    ("ax", "g in place of m/s^2", 1 / 9.80665),
    ("guide_force", "kgf in place of N", 1 / 9.80665),
)


def signs(clean: Clean) -> Iterator[Fault]:
    """Yield opposite signs of components, vectors and scalars."""

    def fault(kind: str, stem: str, names: list[str]) -> Fault:
        return Fault("sign", kind, 2.0, Kind.sign, stem, partial(spoilt.scaled, clean.motion, names, -1.0))

    for prefix, what in (*OF_POINTS, ("f", "force")):
        for axes in ("x", "y", "xy"):
            kind = f"{what}: {' and '.join(axes)}" if what != "force" or axes != "xy" else "action for reaction"
            for stem in clean.some(clean.stems(*(f"{prefix}{axis}" for axis in axes)), kind, 2):
                yield fault(kind, stem, [f"{stem}.{prefix}{axis}" for axis in axes])
    for what in (*OF_BODIES, "guide_force", "guide_moment", "torque", "force"):
        for stem in clean.some(clean.stems(what), what, 2):
            yield fault(what.replace("_", " "), stem, [f"{stem}.{what}"])
    for what, names in {"all forces": clean.of("fx", "fy"), "all turning": clean.of(*OF_BODIES)}.items():
        if names:
            yield fault(what, "all", names)


def frames(clean: Clean) -> Iterator[Fault]:
    """Yield swapped components, other frames, units, factors, offsets and missing terms."""
    yield from vectors_in_other_frames(clean)
    for what, kind, factor in UNITS:
        for stem in clean.some(clean.stems(what), kind, 2):
            names = [f"{stem}.{what}"] + ([f"{stem}.{what[:-1]}y"] if what.endswith("x") else [])
            yield Fault("frame", kind, factor, Kind.unit, stem, partial(spoilt.scaled, clean.motion, names, factor))
    for what in dict.fromkeys(named(channel).name for channel in clean.channels):
        for by in (0.1, 0.01, 3 * clean.promise):
            for stem in clean.some(clean.stems(what), f"{what} by a factor {by}"):
                change = partial(spoilt.scaled, clean.motion, [f"{stem}.{what}"], 1 + by)
                yield Fault("frame", f"{what} by a factor", by, Kind.unit, stem, change)
    for what in ("x", "angle", "fx", "guide_moment"):
        for by in (0.1, 3 * clean.promise):
            for stem in clean.some([name.rpartition(".")[0] for name in clean.of(what)], f"{what} by an offset {by}"):
                name = f"{stem}.{what}"
                change = partial(spoilt.shifted, clean.motion, {name: by * clean.reference.scale[name]})
                yield Fault("frame", f"{what} by an offset", by, Kind.offset, stem, change)
    yield from _mirrored_and_relative(clean)


def vectors_in_other_frames(clean: Clean) -> Iterator[Fault]:
    """Yield vectors with swapped components, turned, or in a body's frame."""

    def fault(kind: str, stem: str, prefix: str, size: float, cause: Kind, change: Change) -> Fault:
        names = [(f"{stem}.{prefix}x", f"{stem}.{prefix}y")]
        return Fault("frame", kind, size, cause, stem, partial(_mapped, clean.motion, names, change))

    for prefix, what in (*OF_POINTS, ("f", "force")):
        stems = clean.stems(f"{prefix}x", f"{prefix}y")
        for stem in clean.some(stems, f"{what}: components swapped", 2):
            yield fault(f"{what}: components swapped", stem, prefix, 1.0, Kind.swap, _swapped)
        for angle in (pi / 2, 0.1, 5 * clean.promise):
            for stem in clean.some(stems, f"{what}: turned by {angle}"):
                turn = partial(np.multiply, np.exp(1j * angle))
                yield fault(f"{what}: turned", stem, prefix, angle, Kind.frame, turn)
        for stem in clean.some(stems, f"{what}: body frame", 2) if prefix else ():
            for body in [one for one in clean.scene.owners[stem.split("/")[0]] if one in clean.scene.turning][:1]:
                turn = partial(np.multiply, np.exp(-1j * clean.state.angle(body)))
                kind = f"{what}: body frame for ground frame"
                yield fault(kind, stem, prefix, 1.0, Kind.frame, turn)


def _mirrored_and_relative(clean: Clean) -> Iterator[Fault]:
    scene, motion, state = clean.scene, clean.motion, clean.state
    downward = [name for name in clean.channels if name[-1] == "y"]
    yield Fault("frame", "y downwards", 2.0, Kind.frame, "all", partial(spoilt.scaled, motion, downward, -1.0))
    for x, y in [place for place in scene.ground.values() if any(place)][:1]:
        for axis, by in (("x", x), ("y", y)):
            if by:
                change = partial(spoilt.shifted, motion, dict.fromkeys(clean.of(axis), -by))
                yield Fault("frame", f"another origin: {axis}", abs(by), Kind.offset, "all", change)
    turning = [body for body in scene.turning if body != scene.drive.body]
    for one, other in zip(turning, scene.turning, strict=False):
        for what in OF_BODIES:
            names = f"{one}.{what}", f"{other}.{what}"
            change = partial(spoilt.replaced, motion, {names[0]: motion[names[0]] - motion[names[1]]})
            yield Fault("frame", f"{what} relative to the body before", 1.0, Kind.frame, one, change)
        break
    for body in clean.some([one for one in turning if len(scene.bodies[one].points) > 1], "terms", 1):
        first, point = scene.bodies[body].points[:2]
        if point in scene.ground:
            continue
        arm, (_, omega, alpha) = state.place(point) - state.place(first), state.turning(body)
        terms = {"centripetal": -(omega**2) * arm, "tangential": 1j * alpha * arm}
        for term, vector in terms.items():
            for sign, how in ((-1, "missing"), (-2, "of the opposite sign")):
                added = sign * vector
                change = partial(_mapped, motion, [(f"{point}.ax", f"{point}.ay")], partial(np.add, added))
                yield Fault("frame", f"{term} term {how}", 1.0, Kind.term, point, change)
    for name in clean.some(clean.stems("guide_force"), "guide moment"):
        slider = scene.bodies[name]
        assert slider.slide is not None
        com = complex(*slider.com) - first_point(slider) if slider.com is not None else 0.05 * clean.reference.stroke
        lever = (complex(*slider.slide.along).conjugate() * com).real or 0.05 * clean.reference.stroke
        moment = motion[f"{name}.guide_moment"] - lever * motion[f"{name}.guide_force"]
        change = partial(spoilt.replaced, motion, {f"{name}.guide_moment": moment})
        yield Fault("frame", "guide moment about another point", abs(lever), Kind.moment, name, change)


def _swapped(z: Vectors) -> Vectors:
    return z.imag + 1j * z.real


def pairs(clean: Clean) -> Iterator[Fault]:
    """Yield channels of the wrong body, point or joint; at a three-body pin, of the wrong pair."""
    motion, scene = clean.motion, clean.scene

    def copied(kind: str, cause: Kind, one: str, other: str, *quantities: str) -> Iterator[Fault]:
        names = [f"{one}.{what}" for what in quantities], [f"{other}.{what}" for what in quantities]
        taken = {a: motion[b] for a, b in zip(*names, strict=True)}
        yield Fault("wrong body", kind, 1.0, cause, one, partial(spoilt.replaced, motion, taken))
        swapped = partial(spoilt.swapped, motion, *names)
        cause = Kind.swap if cause is Kind.copy else cause
        yield Fault("wrong body", f"{kind}, and the other way round", 1.0, cause, one, swapped)

    points = [*pairwise(scene.moving_points)]
    for prefix, what in OF_POINTS:
        for one, other in clean.some(points, f"{what} of another"):
            yield from copied(f"{what} of another point", Kind.copy, one, other, f"{prefix}x", f"{prefix}y")
    for what in OF_BODIES:
        for one, other in clean.some(pairwise(scene.turning), f"{what} of another"):
            yield from copied(f"{what} of another body", Kind.copy, one, other, what)
    pins = clean.stems("fx")
    for one, other in clean.some(pairwise(pins), "force of another"):
        same = one.split("/")[0] == other.split("/")[0]
        yield from copied("force of another joint", Kind.pair if same else Kind.copy, one, other, "fx", "fy")
    for third in [pin.channel for pin in scene.pins if "/" in pin.channel and f"{pin.channel}.fx" in motion]:
        first = third.split("/")[0]
        yield from copied("force of the other pair at a three-body pin", Kind.pair, first, third, "fx", "fy")
        both = [(f"{one}.fx", f"{one}.fy") for one in (first, third)]
        vectors = [motion[x] + 1j * motion[y] for x, y in both]
        for kind, (x, y), by in (
            ("sum of both forces at a three-body pin", both[0], vectors[1]),
            ("difference of both forces at a three-body pin", both[1], -vectors[0]),
        ):
            change = partial(_mapped, motion, [(x, y)], partial(np.add, by))
            yield Fault("wrong body", kind, 1.0, Kind.pair, x.rpartition(".")[0], change)
    for held in [pin for pin in scene.pins if pin.first == GROUND and f"{pin.channel}.fx" in motion][:1]:
        for next_pin in [one for one in scene.pins if held.second in (one.first, one.second) and one != held][:1]:
            sign = 1 if next_pin.second == held.second else -1
            names = [(f"{held.channel}.{axis}", f"{next_pin.channel}.{axis}") for axis in ("fx", "fy")]
            taken = {a: -sign * motion[b] for a, b in names}
            change = partial(spoilt.replaced, motion, taken)
            yield Fault("wrong body", "inertia of the body left out at its pin", 1.0, Kind.copy, held.channel, change)


def _mapped(motion: Motion, stems: Iterable[tuple[str, str]], change: Change) -> Motion:
    """Return the motion with some vectors changed, each given by the names of its x and its y channel."""
    samples: dict[str, Samples] = {}
    for x, y in stems:
        vector = change(motion[x] + 1j * motion[y])
        samples |= {x: vector.real, y: vector.imag}
    return spoilt.replaced(motion, samples)
