"""Measures, compares, reports. Reaches the models by name only, through `engines.registry`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene

    from .report.notebook import CheckResult, Varied

__all__ = ["check", "vary"]

ENGINES = ("analytic", "exudyn", "pymunk")


def check(
    scene_or_name: "Scene | str | Path",
    engines: Sequence[str] = ENGINES,
    samples: int = 360,
    turns: int = 1,
    accuracy: str | float = "balanced",
) -> "CheckResult":
    """Judge a scene as `python -m compare.run --check` does, as one call: no file is written and no clock runs.

    Args:
        scene_or_name: the mechanism, the name of a shipped one, or the path of a scene file.
        engines: names of the engines to run.
        samples: rows a cycle of the drive.
        turns: cycles of the drive.
        accuracy: `fast`, `balanced` or `exact`, each engine's own settings for it; or a relative error between 0 and 1:
            then every engine runs at the cheapest setting that was measured to meet it on this scene.

    Returns:
        The result: `ok`, whether every engine is ok and no tolerance of the scene is missed; `verdicts`, by engine
        the name of its status and the reason; `motions`, by engine its `Motion`; `errors`, `gates` and `masses`,
        data frames of one row a channel, a tolerance and a body; `plot("P5.ay")`, a figure of one channel. A notebook
        shows it as a table.

    Raises:
        InputError: no such scene or engine, an argument out of range, or a scene that the reference cannot solve.
    """
    from scenes import Scene, load  # late, as all imports here: the commands report what stops those

    from .cli.arguments import from_python, sampling
    from .report.notebook import CheckResult
    from .study import judged

    scene = scene_or_name if isinstance(scene_or_name, Scene) else load(scene_or_name)
    options = from_python(engines, samples=samples, turns=turns, accuracy=accuracy)
    asked_for = sampling(scene, options.samples, options.turns)
    return CheckResult.of(judged(scene, options.engines, asked_for, options.accuracy))


def vary(
    name_or_path: "str | Path", variation: str, *more: str, engines: Sequence[str] = ENGINES, samples: int = 360
) -> "Varied":
    """Solve a family of linkages as `python -m compare.run --vary` does, as one call: no file is written.

    Args:
        name_or_path: the name of a shipped scene, or the path of a scene file.
        variation: PATH=FROM:TO:COUNT, as `bodies.rocker.lengths.O-P3=280:320:5`.
        more: others; all combinations are run.
        engines: names of the engines to run.
        samples: rows a cycle of the drive.

    Returns:
        The family: `members`, each with its `changes`, `status`, `reason`, `cycle` and `judgement`; `plot()`, a figure
        of their curves. A notebook shows it as a table.

    Raises:
        InputError: no such scene or engine, or number in the scene, or an argument out of range.
    """
    from scenes import load, numbers_in
    from scenes.arguments import names

    from .cli.arguments import from_python, sampling
    from .measure.many.family import Asked, members
    from .measure.many.grid import grid
    from .measure.many.grid import variation as read
    from .report.notebook import Varied

    scene = load(name_or_path)
    options = from_python(engines, samples=samples)
    varied = [read(text) for text in names("variation", (variation, *more))]
    numbers_in(scene, [each.path for each in varied])
    request, changes = sampling(scene, options.samples, 1), grid(varied)
    asked = Asked(scene, options.engines, request)
    return Varied(scene, varied, options.engines, [*members(asked, changes, lambda _: None)])
