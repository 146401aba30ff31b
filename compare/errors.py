"""How far an engine is from the reference, channel by channel.

The reference is evaluated at the engine's own instants, both at the crank angle that the engine really had and at the
one commanded: the difference between the two errors is the drive's, not the linkage's. The engine is never
interpolated.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from scenes import Motion, Sampling
from scenes.motion import UNITS, Samples, quantity

from .reference import Reference, relative_errors
from .registry import REFERENCE

GROUPS: Mapping[str, str] = (
    dict.fromkeys(("x", "y", "angle"), "position")
    | dict.fromkeys(("vx", "vy", "omega"), "velocity")
    | dict.fromkeys(("ax", "ay", "alpha"), "acceleration")
    | dict.fromkeys(("fx", "fy", "guide_force", "guide_moment"), "reaction")
    | {"torque": "torque", "crank_angle": "drive"}
)  # by quantity; every channel but the time is judged in one

TOGGLE_WINDOW = 0.02  # of the peak of |dx/dtheta|, below which the output nearly stands still


@dataclass(frozen=True)
class Comparison:
    """One engine's errors: relative, by channel, each of shape (n,)."""

    actual: Mapping[str, Samples]  # against the reference at the crank angle that the engine had
    commanded: Mapping[str, Samples]  # against the reference at the crank angle asked for
    crank_angle: Samples  # rad, commanded
    toggle: NDArray[np.bool_]  # where the output nearly stands still
    samples_a_turn: int


def compare(reference: Reference, sampling: Sampling, motion: Motion) -> Comparison:
    """Measure one engine's motion against the reference at the engine's own instants."""
    angle = sampling.commanded(reference.scene)
    commanded, actual = reference.at(angle), reference.at(motion["crank_angle"])
    output = reference.scene.output
    speed = np.hypot(commanded[f"{output}.vx"], commanded[f"{output}.vy"])
    return Comparison(
        relative_errors(motion, actual, reference.scale),
        relative_errors(motion, commanded, reference.scale),
        angle,
        speed < TOGGLE_WINDOW * speed.max(),
        sampling.samples,
    )


def error_table(engine: str, comparison: Comparison, reference: Reference) -> pd.DataFrame:
    """Return one row a channel; no error is shown below the reference's floor, or for the reference without one."""
    rows = []
    last_turn = slice(-comparison.samples_a_turn - 1, None)
    for channel, error in comparison.actual.items():
        worst = int(error.argmax())
        commanded = comparison.commanded[channel]
        floor = reference.floor.by_channel.get(channel, np.nan)
        least = np.nan if engine == REFERENCE else 0.0  # where there is no floor: the reference agrees with itself
        figures = {
            "max": error[worst],
            "rms": np.sqrt(np.mean(error**2)),
            "last_turn_max": error[last_turn].max(),
            "toggle_max": error[comparison.toggle].max() if comparison.toggle.any() else np.nan,
            "commanded_max": commanded.max(),
            "commanded_rms": np.sqrt(np.mean(commanded**2)),
        }
        rows.append(
            {"engine": engine, "channel": channel, "group": GROUPS[quantity(channel)]}
            | {name: float(np.maximum(figure, floor if floor >= 0 else least)) for name, figure in figures.items()}
            | {"max_at_deg": np.degrees(comparison.crank_angle[worst]), "floor": floor}
            | {"scale": reference.scale[channel], "unit": UNITS[quantity(channel)]}
        )
    return pd.DataFrame(rows)
