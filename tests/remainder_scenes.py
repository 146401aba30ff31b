"""Scenes whose results are small remainders of large terms, drawn at random, the same ones every time.

Springs that are level at some position or always, strokes of a thousandth to a ten-millionth of a drawing's about an
offset, and drives that have nearly nothing to do: a mass on a spring, a disc on a torsion spring and a pendulum moved
nearly as they would move by themselves, and a lever in the balance of a spring. Sketches are off by up to a fiftieth.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import cos, hypot, pi, sin, sqrt
from typing import Any, TypeAlias

import numpy as np

from scenes import Scene
from scenes.drive import ConstantSpeed, DriveLaw
from scenes.laws import HarmonicLaw, SegmentedLaw

Tables: TypeAlias = dict[str, Any]
Chance: TypeAlias = np.random.Generator

PREFIX = "remainder"  # of the names of these scenes
ROUGH = 0.02  # m, of a drawing whose crank is of 1 m: how far a sketched point is off, along x and along y


def tables_of(number: int) -> Tables:
    """The tables of the file of a scene, in SI; small strokes are of drawn linkages, see `with_a_small_stroke`."""
    chance, draw = np.random.default_rng(number), KINDS[number % len(KINDS)]
    written = {"format": 1, "name": f"{PREFIX}_{number:03d}", **draw(chance)}
    sketch = written["sketch"]
    written["sketch"] = {
        key: of if key in ("angle", "displacement") else [x + _off(chance) for x in of] for key, of in sketch.items()
    }
    return {key: _plain(value) for key, value in written.items()}


def _plain(value: Any) -> Any:
    """A table's value with Python's own numbers, as a file has them."""
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value.item() if isinstance(value, np.generic) else value


def with_a_small_stroke(scene: Scene, chance: Chance) -> Scene:
    """A drawn scene whose drive goes through a small part of its range only, by any law."""
    low, high = scene.drive.law.extent
    middle, size = float((low + high) / 2), float((high - low) / 2 * 10 ** chance.uniform(-7, -3))
    frequency = float(chance.uniform(0.5, 20))
    match chance.integers(3):
        case 0:
            law: DriveLaw = HarmonicLaw(middle, (size,), (frequency,), (0.0,))
        case 1:
            ends, durations = (middle + size, None, middle), (1 / frequency, 0.5 / frequency, 2 / frequency)
            law = SegmentedLaw(middle, ends, durations, ("cycloidal", None, "polynomial_345"), periodic=True)
        case _:
            law = ConstantSpeed(size * frequency, middle, middle + size)
    return with_a_rough_sketch(replace(scene.with_law(law), loads=()), chance)


def with_a_rough_sketch(scene: Scene, chance: Chance) -> Scene:
    """A drawn scene whose sketched points are each a little off."""
    points = {point: (x + _off(chance), y + _off(chance)) for point, (x, y) in scene.sketch.points.items()}
    return replace(scene, sketch=replace(scene.sketch, points=points))


def _off(chance: Chance) -> float:
    return float(ROUGH * chance.uniform(-1, 1))


def _beside(chance: Chance, least: float = -14.0) -> float:
    """A factor that is nearly one, or exactly."""
    return 1.0 if chance.random() < 0.2 else float(1 + chance.choice((-1, 1)) * 10 ** chance.uniform(least, -1))


def _swung(chance: Chance, body: str, size: float, natural: float, start: float = 0.0) -> Tables:
    """A drive near a natural angular frequency, rad/s."""
    return {
        "body": body,
        "start": start,
        "harmonics": [[size, natural / (2 * pi) * _beside(chance), chance.uniform(-3, 3)]],
    }


def _mass_on_spring(chance: Chance) -> Tables:
    mass, stiffness, length = chance.uniform(0.1, 5), 10 ** chance.uniform(1, 5), chance.uniform(0.5, 2)
    way = chance.uniform(-3, 3)
    along, through, gravity = np.array([cos(way), sin(way)]), chance.uniform(-3, 3, 2), chance.choice((0.0, 9.81))
    stretched = -gravity * sin(way) * mass / stiffness  # where the weight is balanced
    foot = (through - (length + stretched) * along).tolist()
    return {
        "gravity": [0, -gravity],
        "ground": {"points": {"S": foot}},
        "bodies": {
            "mass": {
                "points": {"P": [0, 0]},
                "mass": mass,
                "slides": {"through": through.tolist(), "along": along.tolist()},
            }
        },
        "springs": [{"between": ["ground.S", "mass.P"], "stiffness": stiffness, "length": length}],
        "drive": _swung(chance, "mass", 0.2 * length * chance.uniform(0.01, 1), sqrt(stiffness / mass)),
        "sketch": {"displacement": 0, "P": through.tolist()},
        "output": {"slider": "P"},
    }


def _turning(place: list[float], arm: float, angle: float, body: Tables) -> Tables:
    return {
        "ground": {"points": {"O": place}},
        "bodies": {"arm": {"points": {"O": [0, 0], "A": [arm, 0]}, **body}},
        "sketch": {"angle": angle, "A": [place[0] + arm * cos(angle), place[1] + arm * sin(angle)]},
        "output": {"point": "A"},
    }


def _pendulum(chance: Chance) -> Tables:
    arm, mass, size = chance.uniform(0.3, 3), chance.uniform(0.1, 5), 10 ** chance.uniform(-4, -0.3)
    com, inertia = arm * chance.uniform(0.3, 1), mass * arm**2 * chance.uniform(0, 0.2)
    natural = sqrt(9.81 * mass * com / (mass * com**2 + inertia))
    body = {"mass": mass, "com": [com, 0], "inertia": inertia}
    turning = _turning(chance.uniform(-2, 2, 2).tolist(), arm, -pi / 2, body)
    return {"gravity": [0, -9.81], **turning, "drive": _swung(chance, "arm", size, natural, -pi / 2)}


def _disc(chance: Chance) -> Tables:
    inertia, stiffness, start = chance.uniform(0.01, 1), 10 ** chance.uniform(0, 4), chance.uniform(-2, 2)
    turning = _turning([0.5, -1], chance.uniform(0.1, 1), start, {"mass": 2, "com": [0, 0], "inertia": inertia})
    spring = {"at": "O", "between": ["ground", "arm"], "stiffness": stiffness, "angle": start}
    drive = _swung(chance, "arm", chance.uniform(0.01, 1), sqrt(stiffness / inertia), start)
    return {**turning, "torsion_springs": [spring], "drive": drive}


def _balanced_lever(chance: Chance) -> Tables:
    mass, com, above, on = (chance.uniform(0.2, most) for most in (5, 1, 0.8, 0.6))
    stiffness = mass * 9.81 * com / (above * on) * _beside(chance)
    body = {"mass": mass, "com": [com, 0], "inertia": 0.1}
    turning = _turning([0, 0], 1.0, 0.3, body)
    turning["ground"]["points"]["Q"] = [0, above]
    turning["bodies"]["arm"]["points"]["S"] = [on, 0]
    turning["sketch"]["S"] = [on * cos(0.3), on * sin(0.3)]
    return {
        "gravity": [0, -9.81],
        **turning,
        "springs": [{"between": ["ground.Q", "arm.S"], "stiffness": stiffness, "length": 0}],
        "drive": {"body": "arm", "start": -1.2, "end": 1.2, "speed": chance.uniform(1e-3, 1)},
    }


def _level_spring(chance: Chance) -> Tables:
    """A slider-crank with a guide at a height; its spring is level always, or at some positions."""
    crank, height = chance.uniform(0.2, 1), chance.choice((0.0, 0.25, -0.1))
    rod, angle = crank * chance.uniform(2, 4) + abs(height), 0.5
    A = crank * cos(angle), crank * sin(angle)
    B = A[0] + sqrt(rod**2 - (height - A[1]) ** 2)
    first = chance.choice(("ground.S", "ground.O", "crank.A"))
    return {
        "gravity": [0, -9.81],
        "ground": {"points": {"O": [0, 0], "S": [-2 * rod, height]}},
        "bodies": {
            "crank": {"points": {"O": [0, 0], "A": [crank, 0]}, "mass": 1},
            "rod": {"lengths": {"A-B": rod}, "mass": chance.uniform(0.5, 2)},
            "slider": {"points": {"B": [0, 0]}, "mass": 3, "slides": {"through": [0, height], "along": [1, 0]}},
        },
        "springs": [
            {
                "between": [str(first), "slider.B"],
                "stiffness": 10 ** chance.uniform(1, 5),
                "length": chance.uniform(0.1, 1),
                **({"damping": 5.0} if chance.random() < 0.5 else {}),
            }
        ],
        "drive": {"body": "crank", "speed": chance.uniform(1, 20), "start": float(chance.choice((0.0, angle)))},
        "sketch": {"angle": angle, "A": list(A), "B": [B, height]},
        "output": {"slider": "B"},
    }


KINDS: tuple[Callable[[Chance], Tables], ...] = (_mass_on_spring, _level_spring, _pendulum, _balanced_lever, _disc)


def strongest(scene: Scene, motion: Mapping[str, Any]) -> float:
    """The largest inertia, weight or spring of a motion, N: what a remainder is one of."""
    heaviest = max(body.mass or 0.0 for body in scene.bodies.values())
    fast = max(float(np.hypot(motion[f"{p}.ax"], motion[f"{p}.ay"]).max()) for p in scene.moving_points)
    found = [heaviest * fast, heaviest * hypot(*(scene.gravity or (0.0, 0.0)))]
    for spring in scene.springs:
        ends = []
        for _, point in (spring.first, spring.second):
            fixed = scene.ground.get(point)
            ends.append(complex(*fixed) if fixed else motion[f"{point}.x"] + 1j * motion[f"{point}.y"])
        found.append(float((spring.stiffness * np.abs(np.abs(ends[1] - ends[0]) - spring.length)).max()))
    return max(found)
