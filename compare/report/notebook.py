"""What the functions of `compare` return: results that a notebook shows as table and picture, and plots of them."""

from collections.abc import Iterable
from dataclasses import fields
from html import escape
from typing import TYPE_CHECKING

import pandas as pd

from scenes.errors import nearest
from scenes.motion import UNITS, quantity
from scenes.scene import SI
from scenes.sparkline import sparkline

from ..engines.axis import prefixed
from ..family.family import Family
from ..judge.errors import ChannelError
from ..judge.judgement import Judgement
from ..study import Study
from . import tables
from .family import tables as family_tables
from .linkage.svg import linkage_svg
from .units import units

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

COLUMNS = ("what a designer asks", "value", "where", "engines differ by")


class Result(Study):
    """One scene judged."""

    @classmethod
    def of(cls, judged: Judgement) -> "Result":
        """Return a judgement with the reference's motion, and no times."""
        scene, sampling = judged.scene, judged.sampling
        motion = judged.reference.at(sampling.commanded(scene), sampling.times(scene))
        known = {field.name: getattr(judged, field.name) for field in fields(judged)}
        return cls(**known, motion=motion, speed=())

    @property
    def errors(self) -> pd.DataFrame:
        """One row per engine and channel: its errors against the reference."""
        return pd.DataFrame(tables.errors(self), columns=ChannelError._fields)

    @property
    def gates(self) -> pd.DataFrame:
        """One row per tolerance of the scene: the error measured, and whether it was met."""
        return pd.DataFrame(tables.gates(self), columns=["engine", "group", "tolerance", "error", "met", "worst"])

    @property
    def masses(self) -> pd.DataFrame:
        """One row per body, SI: the mass, centre of mass and inertia that it was taken to have, and by which rule."""
        return pd.DataFrame(tables.masses(self, SI))

    def svg(self, *, moving: bool = True) -> str:
        """Return the linkage as one SVG for a slide, without a script.

        Args:
            moving: whether it moves by itself over the run, again and again, rather than stands at the first sample.
        """
        return linkage_svg(self.scene, self.motion, moving=moving)

    def plot(self, channel: str) -> "Figure":
        """Return a figure of a channel, by the reference and every engine that has it, with their errors below.

        Args:
            channel: its name, as `P5.ay`.

        Raises:
            KeyError: it is none that is compared; the message names the nearest one.
        """
        from .curves import Curve, Panel, over_angle  # late: the library of figures takes longest to import

        known = self.sampling.wanted(self.scene)[1:]
        if channel not in known:
            raise KeyError(f"{channel}: no such channel{nearest(channel, known)}")
        factor, unit = prefixed(self.reference.scale[channel], UNITS[quantity(channel)])
        curve = Curve(channel, unit, {channel: factor})
        return over_angle(self, Panel(channel, f"{channel} [{unit}]", (curve,), (channel,))).checked()

    def __repr__(self) -> str:
        """Return the result in a sentence or two."""
        return f"{self.scene.name}: {tables.verdict(self)}"

    def _repr_html_(self) -> str:
        from .first_screen import peaks

        shown = pd.DataFrame(tables.overview(self))
        untimed = shown.loc[:, ~shown.columns.str.contains("[ms]", regex=False)]
        numbers = [peak.cells for peak in peaks(self.scene, self.peaks, units(self.reference))]
        designer = pd.DataFrame(numbers, columns=COLUMNS)
        return _html(self.scene.title, tables.verdict(self), [designer, untimed], self.missed, self.svg())


class Varied(Family):
    """A family of linkages, each judged."""

    def plot(self) -> "Figure":
        """Return a figure of the curves of output and drive over one cycle, a line a member."""
        from .family.figure import curves

        return curves(self).checked()

    def __repr__(self) -> str:
        """Return the family in a sentence or two."""
        return f"{self.scene.name}: {family_tables.verdict(self)}"

    def _repr_html_(self) -> str:
        shown, name = family_tables.overview(self), "displacement" if self.scene.guided(self.scene.output) else "x"
        cycles = (member.cycle for member in self.members)
        shown[f"{self.scene.output}: {name}"] = [sparkline(cycle.curves[name]) if cycle else "" for cycle in cycles]
        failed = (f"{family_tables.label(self, m)}: {m.status}: {m.reason}" for m in self.members if m.cycle is None)
        return _html(self.scene.title, family_tables.verdict(self), [shown], failed)


def _html(title: str, sentence: str, shown: Iterable[pd.DataFrame], more: Iterable[str], picture: str = "") -> str:
    """Return a heading, a sentence, a picture, tables whose texts come from names and numbers alone, and sentences."""
    rows = (t.to_html(index=False, na_rep="", float_format="{:.1e}".format, escape=False, border=0) for t in shown)
    listed = "".join(f"<li>{escape(line)}</li>" for line in more)
    return f"<h4>{escape(title)}</h4><p>{escape(sentence)}</p>{picture}{''.join(rows)}<ul>{listed}</ul>"
