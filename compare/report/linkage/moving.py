"""What the moving picture needs: every engine's pose, forces and plotted channels at some samples, packed."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any
from xml.etree.ElementTree import tostring

import numpy as np
from numpy.typing import NDArray

from scenes import Motion
from scenes.model.motion import UNITS, Samples, quantity

from ...engines.registry import REFERENCE
from ...judge.measure import Measurement
from ...mechanics.axis import axis
from ...study import Study
from ..figures.curves import Panel, error
from ..figures.style import DARK_GREY, colour
from ..numbers import Units, units
from ..pages.html import packed
from .arrows import arrows
from .drawing import Drawing
from .shapes import outlines
from .svg import picture

SAMPLES, LEAST = 721, 73  # packed, at most; where there are many channels fewer, but for these
NUMBERS = 100_000  # packed, at most: all channels of all engines at all samples; in the page three bytes each
WHOLE = 2**28  # what the largest number of a row of the reference is rounded to
STEPS = 10.0 ** np.arange(1, 13)  # by which differences are magnified
SEEN = 0.1  # of the picture: how large the largest difference is then, at most


@dataclass(frozen=True)
class MovingPicture:
    """The picture of a study, and its data."""

    study: Study
    panels: Sequence[Panel]

    @cached_property
    def drawing(self) -> Drawing:
        """The reference's motion as it is drawn."""
        return Drawing(self.study.scene, self.study.motion)

    @property
    def svg(self) -> str:
        """The picture at the first sample."""
        return tostring(picture(self.drawing)[0], encoding="unicode")

    @cached_property
    def engines(self) -> dict[str, tuple[Measurement, Motion]]:
        """By engine with a motion of all samples, but for the reference: its measurement and motion."""
        return {
            m.run.engine: (m, m.run.motion)
            for m in self.study.measurements
            if m.run.engine != REFERENCE and not m.foreign and m.run.motion is not None and m.comparison is not None
        }

    @property
    def names(self) -> list[str]:
        """The reference and the engines, as they are numbered in the data."""
        return [REFERENCE, *self.engines]

    @property
    def data(self) -> str:
        """The text that the page's script unpacks."""
        reference, others = self._tables
        rows = self.rows
        return _packed(self._header(), reference[:, rows], [other[:, rows] for other in others])

    @cached_property
    def rows(self) -> NDArray[np.intp]:
        """Which samples are packed: all, or some, with the extremes of every channel as far as there is room."""
        tables = [table for of in (self._tables[1], [self._tables[0]]) for table in of]
        count, most = tables[0].shape[1], max(NUMBERS // sum(map(len, tables)), LEAST)
        if count <= min(SAMPLES, most):
            return np.arange(count)
        evenly = np.linspace(0, count - 1, min(SAMPLES, most) // 2).round().astype(np.intp)
        peaks = np.concatenate([np.where(np.isfinite(t), np.abs(t), -1.0).argmax(axis=1) for t in tables])
        return np.unique([*evenly, *[*dict.fromkeys(peaks.tolist())][: len(evenly)]])

    @cached_property
    def _tables(self) -> tuple[NDArray[np.float64], list[NDArray[np.float64]]]:
        """The reference's channels, and by engine what those compared are off them, and the errors of the panels."""
        own, compared = self._samples(self.study.motion), [*self._compared]
        reference = np.array([own[channel] for channel in (*compared, *self._only_reference)])
        others = []
        for measurement, motion in self.engines.values():
            samples = self._samples(motion)
            off = [samples[channel] - own[channel] for channel in compared]
            others.append(np.array([*off, *self._errors(measurement)]))
        return reference, others

    @cached_property
    def _only_reference(self) -> tuple[str, ...]:
        scene = self.study.scene
        return tuple(dict.fromkeys(("time", axis(scene).channel, *(f"{body}.angle" for body in scene.turning))))

    @cached_property
    def _compared(self) -> Mapping[str, None]:
        """Names of what is packed of every engine: places, what is plotted, the drive's effort, forces drawn."""
        places = [f"{point}.{q}" for point in self.study.scene.moving_points for q in "xy"]
        plotted = [channel for panel in self.panels for curve in panel.curves for channel in curve.factors]
        effort = [self._effort["channel"]] if self._effort else []
        forces = [component for arrow in self.drawing.arrows for component in arrow.components]
        return dict.fromkeys([*places, *plotted, *effort, *forces])

    def _samples(self, motion: Motion) -> dict[str, Samples]:
        """What is packed of a motion by its name; NaN where it has none."""
        none = np.full(len(motion["time"]), np.nan)
        samples = {c: motion.samples.get(c, none) for c in (*self._compared, *self._only_reference)}
        for arrow in arrows(self.study.scene, self.study.motion, motion):
            samples |= dict(zip(arrow.components, (arrow.force.real, arrow.force.imag), strict=True))
        return samples

    def _errors(self, measurement: Measurement) -> Iterator[Samples]:
        """Yield by panel the error that is drawn below it."""
        comparison = measurement.comparison
        for panel in self.panels:
            if comparison is not None and any(channel in comparison.actual for channel in panel.judged):
                yield error(self.study, panel, comparison)
            else:
                yield np.full(len(self.study.motion["time"]), np.nan)

    def _header(self) -> dict[str, Any]:
        scene, drawing = self.study.scene, self.drawing
        first = {body.name: body.points[0] for body in scene.bodies.values()}
        over = axis(scene)
        return {
            "title": scene.title,
            "axis": asdict(over) | {"title": over.title},
            "count": len(self.rows),
            "channels": [*self._compared, *self._only_reference],
            "compared": len(self._compared),
            "engines": self.names,
            "colours": [*self._colours],
            "panels": [{"title": p.title, "curves": [asdict(curve) for curve in p.curves]} for p in self.panels],
            "perMetre": drawing.per_metre,
            "perNewton": drawing.per_newton,
            "newton": self._units["N"],
            "corner": [drawing.corner.real, drawing.corner.imag],
            "ground": dict(scene.ground),
            "arrows": [
                {"name": a.name, "point": a.point, "load": a.load, "components": a.components} for a in drawing.arrows
            ],
            "effort": self._effort,
            "outlines": [*outlines(drawing)],
            "marks": first | {"drive": first[scene.drive.body], scene.drive_channel: first[scene.drive.body]},
        }

    @cached_property
    def _units(self) -> Units:
        return units(self.study.reference)

    @property
    def _colours(self) -> Iterator[str]:
        """Yield the colours of the reference, which need not be among the engines asked for, and of the others."""
        numbers = {m.run.engine: number for number, m in enumerate(self.study.measurements)}
        yield from (colour(numbers[name]) if name in numbers else DARK_GREY for name in self.names)

    @cached_property
    def _effort(self) -> dict[str, Any] | None:
        """The channel of the drive's torque or force, and its unit; nothing where there is none."""
        for channel in ("drive.torque", "drive.force"):
            if channel in self.study.motion:
                factor, unit = self._units[UNITS[quantity(channel)]]
                return {"channel": channel, "factor": factor, "unit": unit}
        return None

    @property
    def magnified(self) -> Iterator[tuple[float, str]]:
        """Yield by how much differences can be magnified, and the engines whose largest one then shows."""
        by_step: dict[float, list[str]] = {}
        size = abs(self.drawing.box[1] - self.drawing.box[0])
        places = [f"{point}.{q}" for point in self.study.scene.moving_points for q in "xy"]
        for name, (_, motion) in self.engines.items():
            off = [np.abs(motion[place] - self.study.motion[place]).max() for place in places if place in motion]
            fitting = STEPS[np.max(off, initial=0.0) * STEPS <= SEEN * size]
            if np.max(off, initial=0.0) > 0 and len(fitting):
                by_step.setdefault(float(fitting[-1]), []).append(name)
        yield 1.0, ""
        yield from ((times, " and ".join(names)) for times, names in sorted(by_step.items()))


def _packed(header: dict[str, Any], reference: NDArray[np.float64], others: Sequence[NDArray[np.float64]]) -> str:
    """A text that a script unpacks, gzip in base64: a line of JSON, then numbers of four bytes, row by row.

    First bytes come first, then the second ones, and so on, which halves what gzip leaves.

    Args:
        header: what the JSON has, besides `quanta`: by row of the reference what its whole numbers count.
        reference: finite, shape (channels, n); kept as second differences of whole numbers.
        others: of any shape, in single precision.
    """
    quanta = np.maximum(np.abs(reference).max(axis=1), 1e-300) / WHOLE
    whole = np.round(reference / quanta[:, np.newaxis]).astype("<i4")
    second = np.diff(whole, 2, axis=1, prepend=np.zeros((len(whole), 2), "<i4"))
    with np.errstate(over="ignore"):
        tables = [second, *(other.astype("<f4") for other in others)]
    words = np.concatenate([np.ascontiguousarray(table).view(np.uint8).reshape(-1, 4) for table in tables])
    line = json.dumps(header | {"quanta": quanta.tolist()}, separators=(",", ":")).encode()
    return packed(line + b"\n" + words.T.tobytes())
