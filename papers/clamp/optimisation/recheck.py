"""The outcome checked by full dynamic models that know nothing of the formulas."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compare.engines.processes.stopping import Progress
from compare.engines.runner import HERE
from compare.judge.floor import establish
from compare.judge.measure import Measurement, measure
from compare.mechanics.mechanics import SHOWN_GROUPS
from scenes import Sampling, Scene, load
from scenes.elements.loads import Force

from ..formulas import RATED, Design, at, crosshead, opened, platen
from ..printed import SCENES

ENGINES = ("exudyn", "pymunk")
SAMPLES = 3600  # the steps follow them, and the load comes within 1 mm
HALF_FORCE = 2e6  # N, of one toggle of the two
YIELD = 1.0  # mm, of tie bars and dies under it, as in the shipped scenes


@dataclass(frozen=True)
class Recheck:
    """A design by an engine; NaN where a run failed."""

    design: str
    engine: str
    status: str
    M_P: float  # half the clamping force over the thrust at alpha = 2.5 deg; inertia takes 6e-5 of it
    R_S: float
    R_V_max: float  # of the samples
    errors: Mapping[str, float]  # relative to the reference, the largest by channel group


def rechecks(designs: Mapping[str, Design], engines: Sequence[str], progress: Progress) -> Iterator[Recheck]:
    """Each design by each engine; InputError where the reference cannot solve one of them."""
    for name, d in designs.items():
        reference = establish(locking(d))
        press = replace(locking(d, RATED), loads=(Force("platen", "C", (-HALF_FORCE, 0.0)),))  # all the way
        for engine in engines:
            progress(f"{name} by {engine}")
            yield _recheck(name, measure(reference, engine, Sampling(SAMPLES)), press)


# Lengths alone would do for the scene's mechanism; the sketch is moved too, since the sides on which its points lie
# pick the assembly branch. The dies' table of forces goes with the platen's lock position.
def locking(d: Design, alpha: float = 0.0) -> Scene:
    """The shipped scene with the lengths of a design, from open to some alpha, and dies met where it locks."""
    start, height, lock = opened(d), (d.L1 + d.L2) * np.sin(d.theta), platen(at(d, 0.0))
    B, D = d.L1 * np.exp(1j * start.bar), d.L5 * np.exp(1j * start.ear)
    sketch = {"B": B, "D": D, "C": platen(start) + 1j * height, "E": crosshead(start) + 1j * d.Hb}
    changes = {
        "bodies.rear_link.lengths.A-B": d.L1,
        "bodies.rear_link.lengths.A-D": d.L5,
        "bodies.rear_link.lengths.B-D": d.L3,
        "bodies.front_link.lengths.B-C": d.L2,
        "bodies.crosshead_link.lengths.D-E": d.L4,
        "bodies.platen.slides.through.1": height,
        "bodies.crosshead.slides.through.1": d.Hb,
        "drive.start": crosshead(start),
        "drive.end": crosshead(at(d, alpha)),
        "loads.0.table.0.0": lock - YIELD,
        "loads.0.table.1.0": lock + YIELD,
        "sketch.displacement": crosshead(start),
        **{f"sketch.{point}.0": place.real for point, place in sketch.items()},
        **{f"sketch.{point}.1": place.imag for point, place in sketch.items()},
    }
    return load(SCENES["initial"], {path: float(value) for path, value in changes.items()})


# M_P is measured as a ratio of forces in a run that ends at the rated alpha, under a force so large that inertia is
# 6e-5 of it. R_S and the largest R_V are kinematic and are taken from the run to the lock.
def _recheck(name: str, measured: Measurement, press: Scene) -> Recheck:
    engine, motion = measured.run.engine, measured.run.motion
    pressed = HERE.run(engine, press, Sampling(SAMPLES)).motion
    thrust = np.nan if pressed is None else float(pressed["drive.force"][-1])
    ratio, fastest, errors = np.nan, np.nan, {}
    if motion is not None:
        ratio = float(np.ptp(motion["C.x"]) / np.ptp(motion["drive.displacement"]))
        fastest = float((motion["C.vx"] / motion["E.vx"]).max())
        largest = measured.worst()
        errors = {group: largest[group] for group in SHOWN_GROUPS if group in largest}
    return Recheck(name, engine, measured.run.status.name, HALF_FORCE / thrust, ratio, fastest, errors)
