"""What the moving picture needs: every engine's pose, forces and plotted channels at some samples, packed."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cached_property
from typing import Any
from xml.etree.ElementTree import tostring

import numpy as np
from numpy.typing import NDArray

from scenes import Motion
from scenes.model.motion import Samples

from ...engines.registry import REFERENCE
from ...judge.errors import Comparison
from ...mechanics.axis import axis
from ...study import Study
from ..figures.curves import Panel, PlottedCurve, error
from ..figures.style import BEFORE, DARK_GREY, GREY, colour
from ..numbers import units
from ..output.earlier import Before
from ..pages.html import packed
from .drawing import Drawing, arrows
from .svg import outlines, picture

MAX_SAMPLES, MIN_SAMPLES = 721, 73  # packed, at most; where there are many channels fewer, but for these
MAX_NUMBERS = 100_000  # packed: all channels of all engines at all samples; in the page three bytes each
WHOLE = 2**28  # what the largest number of a row of the reference is rounded to
STEPS = 10.0 ** np.arange(1, 13)  # by which differences are magnified
ROUND_OFF_TOL = 1e-9  # of a channel's scale: what is less is none of its values
MAX_MAGNIFIED = 0.1  # of the picture: how large the largest difference is then


class MovingPicture:
    """The picture of a study, and its data: the reference's motion, and those of the engines that have all samples."""

    def __init__(self, study: Study, panels: Sequence[Panel], before: Before | None = None) -> None:
        scene = study.scene
        self.study, self.panels, self.drawing = (
            study,
            panels,
            Drawing(scene, study.motion, named=units(study.reference)),
        )
        self.svg = tostring(picture(self.drawing)[0], encoding="unicode")
        self.engines: dict[str, tuple[Comparison | None, Motion]] = {
            m.run.engine: (m.comparison, m.run.motion)
            for m in study.measurements
            if m.run.engine != REFERENCE and not m.foreign and m.run.motion is not None and m.comparison is not None
        }
        self._ground = before.ground if before else {}
        if before and before.motion.samples:
            self.engines[BEFORE] = None, before.motion
        self.names = [REFERENCE, *self.engines]  # as they are numbered in the data
        self._effort = [c for c in (scene.channels.drive.effort,) if c in study.motion]  # one, or none
        self._places = [name for names in scene.channels.points.values() for name in names.place]
        plotted = [channel for panel in panels for curve in panel.curves for channel in curve.factors]
        forces = [component for arrow in self.drawing.arrows for component in arrow.components]
        forces += [arrow.moment for arrow in self.drawing.arrows if arrow.moment]
        self._compared = [*dict.fromkeys([*self._places, *plotted, *self._effort, *forces])]  # of every engine
        alone = dict.fromkeys(("time", axis(scene).channel, *(rates.angle for rates in scene.channels.bodies.values())))
        self._channels = [*self._compared, *alone]

    @property
    def data(self) -> str:
        """The text that the page's script unpacks: a line of JSON, then the bytes of 4-byte numbers, row by row.

        The reference, finite, is kept as second differences of whole numbers, `quanta` being what they count by row.
        """
        reference, *others = (table[:, self.rows] for table in self._tables)
        # Fixed point with 28 bits of the row's largest value, 4e-9 of it. The second difference of a smooth row is
        # small, so that its upper bytes are nearly all 0 or 255, which gzip takes to little. Two zeros in front make
        # the first two values second differences as well; the page adds up twice. The sums stay below 2^31, as |d| <= 4
        # * 2^28.
        quanta = np.maximum(np.abs(reference).max(axis=1), 1e-300) / WHOLE
        whole = np.round(reference / quanta[:, np.newaxis]).astype("<i4")
        second = np.diff(whole, 2, axis=1, prepend=np.zeros((len(whole), 2), "<i4"))
        with np.errstate(over="ignore"):
            tables = [second, *(other.astype("<f4") for other in others)]
        words = np.concatenate([np.ascontiguousarray(table).view(np.uint8).reshape(-1, 4) for table in tables])
        line = json.dumps(self._header() | {"quanta": quanta.tolist()}, separators=(",", ":")).encode()
        return packed(line + b"\n" + words.T.tobytes())  # first bytes first: gzip leaves half of it

    @cached_property
    def rows(self) -> NDArray[np.intp]:
        """Which samples are packed: all, or some, with the extremes of every channel as far as there is room."""
        reference, *others = self._tables
        count, most = reference.shape[1], max(MAX_NUMBERS // sum(map(len, self._tables)), MIN_SAMPLES)
        if count <= min(MAX_SAMPLES, most):
            return np.arange(count)
        # Half of the samples are evenly spaced. The other half is where a channel is largest, engines' differences
        # first: a single sample with a large error must not fall between two samples of the picture.
        evenly = np.linspace(0, count - 1, min(MAX_SAMPLES, most) // 2).round().astype(np.intp)
        tables = [np.where(np.isfinite(t), np.abs(t), -1.0).argmax(axis=1) for t in (*others, reference)]
        return np.unique([*evenly, *[*dict.fromkeys(np.concatenate(tables).tolist())][: len(evenly)]])

    @cached_property
    def _tables(self) -> list[NDArray[np.float64]]:
        """The reference's channels; then by engine what those compared are off them, and the errors of the panels."""
        reference = self._samples(self.study.motion)
        tables = [np.array([reference[channel] for channel in self._channels])]
        for comparison, motion in self.engines.values():
            samples, none = self._samples(motion), np.full(len(reference["time"]), np.nan)
            deviations = [samples[channel] - reference[channel] for channel in self._compared]
            errors = [error(self.study, panel, comparison) if comparison else none for panel in self.panels]
            tables.append(np.array([*deviations, *errors]))
        return tables

    def _samples(self, motion: Motion) -> dict[str, Samples]:
        """What is packed of a motion by its name; NaN where it has none."""
        none = np.full(len(motion["time"]), np.nan)
        samples = {channel: motion.samples.get(channel, none) for channel in self._channels}
        for load in (arrow for arrow in arrows(self.study.scene, self.study.motion, motion) if arrow.load):
            samples |= dict(zip(load.components, (load.force.real, load.force.imag), strict=True))
        return samples

    def _header(self) -> dict[str, Any]:
        scene, drawing = self.study.scene, self.drawing
        along, named = axis(scene), units(self.study.reference)
        colours = {BEFORE: GREY} | {m.run.engine: colour(number) for number, m in enumerate(self.study.measurements)}
        kept = ("name", "point", "load", "components", "on", "way", "moment")
        zero = {channel: ROUND_OFF_TOL * size for channel, size in self.study.reference.scale.items()}
        efforts = ((channel, *named[scene.channels[channel].unit]) for channel in self._effort)
        effort = ({"channel": c, "factor": k, "unit": unit, "zero": k * zero[c]} for c, k, unit in efforts)
        return {
            "title": scene.title,
            "axis": asdict(along) | {"title": along.title},
            "count": len(self.rows),
            "channels": self._channels,
            "compared": len(self._compared),
            "engines": self.names,
            "colours": [colours.get(name, DARK_GREY) for name in self.names],
            "before": {"number": self.names.index(BEFORE), "ground": self._ground} if BEFORE in self.names else None,
            "panels": [{"title": p.title, "curves": [_curve(curve, zero) for curve in p.curves]} for p in self.panels],
            "perMetre": drawing.per_metre,
            "perNewton": drawing.per_newton,
            "larger": drawing.larger,
            "newton": named["N"],
            "corner": [drawing.corner.real, drawing.corner.imag],
            "ground": dict(scene.ground),
            "arrows": [{name: getattr(arrow, name) for name in kept} for arrow in drawing.arrows],
            "effort": next(effort, None),
            "outlines": outlines(drawing),
            "vectors": self.vectors,
        }

    @cached_property
    def vectors(self) -> list[dict[str, Any]]:
        """What a polar diagram can be drawn of: the forces of pins, and the output's velocity, its hodograph."""
        scene, named, vectors = self.study.scene, units(self.study.reference), list[dict[str, Any]]()
        known = scene.channels
        pins = [(pin, known.pins[pin.channel]) for pin in scene.pins if pin.channel in known.pins]
        drawn = [(f"force at pin {p.channel}", both, p.point, [p.first, p.second]) for p, both in pins]
        velocity = known.points[scene.output].velocity
        for name, channels, pin, bodies in (*drawn, (f"velocity of {scene.output}", velocity, "", [])):
            factor, unit = named[known[channels[0]].unit]
            if {*channels} <= {*self._channels}:
                vector = {"name": name, "at": pin, "bodies": bodies, "components": channels}
                vectors.append(vector | {"factor": factor, "unit": unit})
        return vectors

    @property
    def magnified(self) -> Iterator[tuple[float, str]]:
        """Yield by how much differences can be magnified, and the engines whose largest one then shows."""
        by_step: dict[float, list[str]] = {}
        size = abs(self.drawing.box[1] - self.drawing.box[0])
        for name, (comparison, motion) in self.engines.items():
            if comparison is None:
                continue
            deviations = [
                np.abs(motion[place] - self.study.motion[place]).max() for place in self._places if place in motion
            ]
            fitting = STEPS[np.max(deviations, initial=0.0) * STEPS <= MAX_MAGNIFIED * size]
            if np.max(deviations, initial=0.0) > 0 and len(fitting):
                by_step.setdefault(float(fitting[-1]), []).append(name)
        yield 1.0, ""
        yield from ((times, " and ".join(names)) for times, names in sorted(by_step.items()))


def _curve(curve: PlottedCurve, zero: Mapping[str, float]) -> dict[str, Any]:
    """A curve as the page plots it, with what of it is round-off."""
    return asdict(curve) | {
        "zero": sum(abs(factor) * zero.get(channel, 0.0) for channel, factor in curve.factors.items())
    }
