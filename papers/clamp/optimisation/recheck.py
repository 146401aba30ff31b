"""The outcome checked by full dynamic models that know nothing of the formulas."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from compare.engines import runner
from compare.engines.reference import establish
from compare.judge.errors import SHOWN_GROUPS
from compare.judge.measure import Measurement, measure
from scenes import Motion, Sampling, Scene, load

from ..formulas import RATED, Array
from .scene_file import HALF_FORCE, locking, pressing

ENGINES = ("exudyn", "pymunk")
SAMPLES = 3600  # the steps follow them, and the load comes within 1 mm


@dataclass(frozen=True)
class Recheck:
    """What an engine says of a design; NaN where a run failed."""

    design: str
    engine: str
    status: str
    M_P: float  # half the clamping force over the thrust at alpha = 2.5 deg; inertia takes 6e-5 of it
    R_S: float
    R_V_max: float  # of the samples
    errors: Mapping[str, float]  # relative to the reference, the largest by channel group


def rechecks(
    designs: Mapping[str, Array], engines: Sequence[str], progress: Callable[[str], None]
) -> Iterator[Recheck]:
    """Yield what each engine says of each design.

    Raises:
        InputError: the reference cannot solve one of them.
    """
    for name, X in designs.items():
        reference = establish(_loaded(locking(X, name)))
        press = _loaded(pressing(X, name, RATED))
        for engine in engines:
            progress(f"{name} by {engine}")
            yield _recheck(name, measure(reference, engine, Sampling(SAMPLES)), press)


def _loaded(text: str) -> Scene:
    with TemporaryDirectory() as folder:
        file = Path(folder) / "design.toml"
        file.write_text(text, encoding="utf-8")
        return load(file)


def _recheck(name: str, measured: Measurement, press: Scene) -> Recheck:
    engine, motion = measured.run.engine, measured.run.motion
    pressed = runner.run(engine, press, Sampling(SAMPLES)).motion
    ratio, fastest = (np.nan, np.nan) if motion is None else _ratios(motion)
    thrust = np.nan if pressed is None else pressed["drive.force"][-1]
    largest = {} if motion is None else measured.errors.groupby("group")["max"].max().to_dict()
    errors = {group: float(largest[group]) for group in SHOWN_GROUPS if group in largest}
    return Recheck(name, engine, measured.run.status.name, 1e3 * HALF_FORCE / float(thrust), ratio, fastest, errors)


def _ratios(motion: Motion) -> tuple[float, float]:
    """Return R_S and the largest R_V of a motion."""
    R_S = np.ptp(motion["C.x"]) / np.ptp(motion["drive.displacement"])
    return float(R_S), float((motion["C.vx"] / motion["E.vx"]).max())
