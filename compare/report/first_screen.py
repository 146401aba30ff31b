"""What the first screen shows: the verdict in a word, the designer's numbers, one row an engine."""

from collections.abc import Iterator
from dataclasses import dataclass

from ..engines.axis import Axis, axis
from ..engines.registry import REFERENCE
from ..judge.measure import Measurement
from ..study import Study
from .numbers import engineering
from .style import colour

MARKS = {"agrees": "✓", "agrees in part": "≈", "disagrees": "✗", "not solved": "✗"}


@dataclass(frozen=True)
class Verdict:
    """How far the engines agree."""

    word: str
    sentence: str

    @property
    def mark(self) -> str:
        """A sign beside the word."""
        return MARKS[self.word]


@dataclass(frozen=True)
class Row:
    """One engine: how its run ended, its largest error and where that is, its time."""

    engine: str  # with its version
    colour: str
    status: str
    worst: float
    channel: str  # with the largest error; empty where there is none
    at: float  # on the axis, SI
    where: str
    time: str


def verdict(study: Study) -> Verdict:
    """Return whether the engines agree, in a word and a sentence."""
    return Verdict(study.agreement.word, study.agreement.sentence)


def engines(study: Study) -> Iterator[Row]:
    """Yield a row per engine, in the order asked for."""
    over = axis(study.scene)
    for number, m in enumerate(study.measurements):
        worst, channel, at = _worst(m)
        named = (_named(m), colour(number), m.run.status.name)
        yield Row(*named, worst, channel, at / over.factor, place(over, at), _time(study, m))


def place(over: Axis, at: float) -> str:
    """Return a place on the axis, given in its unit: `171°`, `3.2 mm`."""
    return f"{at:.4g}°" if over.unit == "deg" else f"{at:.4g} {over.unit}"


def _named(measured: Measurement) -> str:
    """Return an engine's name with its version; for the reference, whose version is a package's, what it is."""
    run = measured.run
    version = run.version.partition(",")[0]
    return f"{run.engine} (reference)" if run.engine == REFERENCE else version or run.engine


def _worst(measured: Measurement) -> tuple[float, str, float]:
    """Return the largest error, its channel, and where it is, in the axis' unit; a NaN counts as the largest."""
    if measured.errors.empty:
        return float("nan"), "", float("nan")
    row = measured.errors.iloc[int(measured.errors["max"].to_numpy().argmax())]
    return float(row["max"]), str(row["channel"]), float(row["max_at"])


def _time(study: Study, measured: Measurement) -> str:
    """Return the time of a solve per cycle at the settings of the run, as the table of speed has it."""
    settings, speed = measured.run.settings, study.speed
    if settings is None or speed.empty:
        return "–"
    timed = speed[(speed["engine"] == measured.run.engine) & (speed["setting"] == settings.label)]["solve_min_s"]
    return engineering(float(timed.iloc[0]), "s") if len(timed) else "–"
