"""Measures, compares, reports. Reaches the models by name only, through `engines.registry`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene

    from .judge.judgement import Judgement

__all__ = ["check"]


def check(
    scene_or_name: "Scene | str | Path",
    engines: Sequence[str] = ("analytic", "exudyn", "pymunk"),
    samples: int = 360,
    turns: int = 1,
    accuracy: str | float = "balanced",
) -> "Judgement":
    """Judge a scene as `python -m compare.run --check` does, as one call: no file is written and no clock runs.

    Args:
        scene_or_name: the mechanism, the name of a shipped one, or the path of a scene file.
        engines: names of the engines to run.
        samples: rows a cycle of the drive.
        turns: cycles of the drive.
        accuracy: `fast`, `balanced` or `exact`, each engine's own settings for it; or a relative error between 0 and 1:
            then every engine runs at the cheapest setting that was measured to meet it on this scene.

    Returns:
        The judgement: `ok`, whether every engine is ok and no tolerance of the scene is missed; `verdicts`, by engine
        the name of its status and the reason; `motions`, by engine its `Motion`; `errors` and `gates`, data frames of
        one row a channel and one a tolerance.

    Raises:
        InputError: no such scene or engine, an argument out of range, or a scene that the reference cannot solve.
    """
    from scenes import Scene, load  # late, as all imports here: the commands report what stops those

    from .arguments import parser, sampling
    from .study import judged

    scene = scene_or_name if isinstance(scene_or_name, Scene) else load(scene_or_name)
    asked = {"engines": ",".join(engines), "samples": samples, "turns": turns, "accuracy": accuracy}
    options = parser().parse_args([f"--{name}={value}" for name, value in asked.items()])
    return judged(scene, options.engines, sampling(scene, options.samples, options.turns), options.accuracy)
