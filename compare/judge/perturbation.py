"""How far a scene's motion moves when its numbers are off by a few units in the last place.

No model that computes in doubles can be held to less: each rounds the lengths its own way before the first equation.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from scenes import Failure, Motion, Scene
from scenes.motion import Samples
from scenes.scene import Body, Spring, Vector

from ..engines import registry

ULPS = 4  # of every number, up or down at random
DRAWS = 4  # scenes; their worst is within a factor of three of the worst of many more, see the tests
SEED = 20261121

Jitter: TypeAlias = Callable[[float], float]
Nearly: TypeAlias = Callable[[Motion], Motion]  # from the motion as it is, whose drive it follows


def nearly(scene: Scene) -> list[Nearly]:
    """Return solvers of scenes whose lengths, places and drive are those of this one but for a few last places.

    Raises:
        Failure: the reference cannot take such a scene apart.
    """
    draw = np.random.default_rng(SEED)

    def jitter(value: float) -> float:
        return value * (1 + ULPS * np.finfo(float).eps * float(draw.choice((-1.0, 1.0))))

    def solver(number: int) -> Nearly:
        solve = registry.reference(_jittered(scene, jitter))
        turn = (-1) ** number * ULPS * np.finfo(float).eps
        least = 1e-3 * np.ptp(scene.drive.extent)  # an angle that passes through zero is no better known there

        def moved(motion: Motion) -> Motion:
            position = motion[scene.drive_channel]
            return solve(position + turn * np.maximum(np.abs(position), least), motion["time"])

        return moved

    return [solver(number) for number in range(DRAWS)]


def sensitivity(
    solvers: list[Nearly], true: Motion, errors: Callable[[Motion], Mapping[str, Samples]]
) -> dict[str, Samples]:
    """Return by how much each channel of the true motion moves, relative as `errors` of a motion has it, shape (n,).

    Infinite where one of the scenes cannot be assembled: then nothing can be said of the motion in doubles.
    """
    moved: dict[str, Samples] = {}
    for solve in solvers:
        try:
            with np.errstate(invalid="ignore"):
                found = errors(solve(true))
        except Failure:
            return {channel: np.full(true["time"].shape, np.inf) for channel in true.samples}
        for channel, error in found.items():
            known = np.where(np.isnan(error), np.inf, error)  # where both scenes stand in a singular pose
            moved[channel] = np.maximum(moved.get(channel, 0.0), known)
    return moved


def _jittered(scene: Scene, jitter: Jitter) -> Scene:
    def place(point: Vector) -> Vector:
        return jitter(point[0]), jitter(point[1])

    def spring(of: Spring) -> Spring:
        return replace(of, length=jitter(of.length))

    def body(of: Body) -> Body:
        return replace(
            of,
            local=None if of.local is None else {name: place(point) for name, point in of.local.items()},
            lengths=None if of.lengths is None else {pair: jitter(length) for pair, length in of.lengths.items()},
            com=None if of.com is None else place(of.com),
            slide=None if of.slide is None else replace(of.slide, through=place(of.slide.through)),
        )

    return replace(
        scene,
        asked=None,
        ground={name: place(point) for name, point in scene.ground.items()},
        bodies={name: body(of) for name, of in scene.bodies.items()},
        springs=tuple(map(spring, scene.springs)),
    )
