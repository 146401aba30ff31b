"""One cycle of one linkage by the reference: the output's curves, and the numbers by which linkages are compared."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from scenes.motion import Samples, quantity

from ..engines.axis import axis
from ..judge.judgement import Judgement
from ..judge.peaks.curves import curves
from ..judge.peaks.peaks import Peak

DRAWN = ("displacement", "velocity", "acceleration", "effort")  # kinds of curves


@dataclass(frozen=True)
class Cycle:
    """One linkage over one cycle of its drive."""

    position: Samples  # on the axis of the curves, SI: of the drive, or the time under a law
    curves: Mapping[str, Samples]  # of the output and the drive, by name, SI, each of shape (n,)
    peaks: Sequence[Peak]

    @property
    def numbers(self) -> dict[str, Peak]:
        """The numbers by name; of the forces of joints the largest of each kind, as `largest force`."""
        found: dict[str, Peak] = {}
        for peak in sorted(self.peaks, key=lambda peak: -peak.value):
            found.setdefault(peak.name.removesuffix(f" at {peak.of}"), peak)
        order = dict.fromkeys(peak.name.removesuffix(f" at {peak.of}") for peak in self.peaks)
        return {name: found[name] for name in order}


def cycle(judged: Judgement) -> Cycle:
    """Return the curves and numbers of a judged linkage."""
    motion = judged.reference.cycle
    drawn: dict[str, Samples] = {}
    for curve in curves(judged.scene, judged.reference.scale, motion):
        values = curve.values(motion)
        if curve.kind == "path":
            drawn |= {"x": values.real, "y": values.imag}
        elif curve.kind in DRAWN:
            name = quantity(curve.channels[0]) if curve.kind == "effort" else curve.kind
            drawn[name] = np.abs(values) if np.iscomplexobj(values) else values
    return Cycle(motion[axis(judged.scene).channel], drawn, judged.peaks)
