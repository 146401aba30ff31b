"""What the functions of `compare` return: results that a notebook shows as table and picture, and plots of them."""

from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING

import pandas as pd

from scenes.channels import TIME
from scenes.errors import nearest
from scenes.model.motion import sparkline
from scenes.units import SI

from ..judge.errors import ChannelError
from ..measure.many.family import Family
from ..mechanics.axis import prefixed
from ..study import Study
from .linkage.drawing import Drawing
from .linkage.svg import MAX_FRAMES, by_itself
from .numbers import units
from .tables import family as family_tables
from .tables import study as tables

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

COLUMNS = ("what a designer asks", "value", "where", "engines differ by")


class CheckResult(Study):
    """One scene judged."""

    @property
    def errors(self) -> pd.DataFrame:
        """One row per engine and channel: its errors against the reference."""
        return pd.DataFrame(tables.errors(self), columns=ChannelError._fields)

    @property
    def gates(self) -> pd.DataFrame:
        """One row per tolerance of the scene: the error measured, and whether it was met."""
        return pd.DataFrame(tables.gates(self), columns=tables.GATE)

    @property
    def masses(self) -> pd.DataFrame:
        """One row per body, SI: the mass, centre of mass and inertia that it was taken to have, and by which rule."""
        return pd.DataFrame(tables.masses(self, SI))

    def svg(self, *, moving: bool = True) -> str:
        """The linkage as one SVG for a slide, without a script: moving by itself, or at the first sample."""
        return by_itself(Drawing(self.scene, self.motion, named=units(self.reference)), MAX_FRAMES if moving else 0)

    def plot(self, channel: str) -> "Figure":
        """A figure of a channel, as `P5.ay`, by the reference and every engine that has it, with their errors below.

        Raises:
            KeyError: it is none that is compared; the message names the nearest one.
        """
        from .figures.curves import Panel, PlottedCurve, over_angle
        from .figures.offline import offline  # late: the library of figures takes longest to import

        known = [name for name in self.sampling.wanted(self.scene) if name != TIME]
        if channel not in known:
            raise KeyError(f"{channel}: no such channel{nearest(channel, known)}")
        si = self.scene.channels[channel].unit
        factor, unit = units(self.reference).get(si) or prefixed(self.reference.scale[channel], si)
        curve = PlottedCurve(channel, unit, {channel: factor})
        return offline(over_angle(self, Panel(channel, f"{channel} [{unit}]", (curve,), (channel,))))

    def __repr__(self) -> str:
        return f"{self.scene.name}: {self._verdicts}"

    @property
    def _verdicts(self) -> str:
        """The verdict on the models, and beside it that on the limits, where there are any."""
        return " ".join(map(str, filter(None, (self.agreement, self.limits_verdict))))

    def _repr_html_(self) -> str:
        from .tables.first_screen import answers

        untimed = pd.DataFrame(tables.overview(self, timed=False))
        whole, _ = answers(self.scene, self.peaks, units(self.reference))
        designer = pd.DataFrame([answer.cells for answer in whole], columns=COLUMNS)
        more = [*self.missed, *self.reasons]
        return _html(self.scene.title, self._verdicts, [designer, untimed], more, self.svg())


class Varied(Family):
    """A family of linkages, each judged."""

    def plot(self) -> "Figure":
        """A figure of the curves of output and drive over one cycle, a line a member."""
        from .figures.many import curves
        from .figures.offline import offline

        return offline(curves(self))

    def __repr__(self) -> str:
        return f"{self.scene.name}: {family_tables.agreement(self)}"

    def _repr_html_(self) -> str:
        shown = pd.DataFrame(family_tables.overview(self))
        name = "displacement" if self.scene.guided(self.scene.output) else "x"
        cycles = (member.cycle for member in self.members)
        shown[f"{self.scene.output}: {name}"] = [sparkline(cycle.curves[name]) if cycle else "" for cycle in cycles]
        return _html(self.scene.title, str(family_tables.agreement(self)), [shown], family_tables.failures(self))


def _html(title: str, sentence: str, shown: Iterable[pd.DataFrame], more: Iterable[str], picture: str = "") -> str:
    """A heading, a sentence, a picture, tables whose texts come from names and numbers alone, and sentences."""
    rows = (t.to_html(index=False, na_rep="", float_format="{:.1e}".format, escape=False, border=0) for t in shown)
    listed = "".join(f"<li>{escape(line)}</li>" for line in more)
    return f"<h4>{escape(title)}</h4><p>{escape(sentence)}</p>{picture}{''.join(rows)}<ul>{listed}</ul>"
