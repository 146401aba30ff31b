"""Double-toggle clamp: what its source prints, digit by digit; lengths in mm, angles in degrees, changes in percent.

Source: zhycasting.com, Multi-Objective Optimization of Clamping Unit for 4000 kN Die Casting Machine.
"""

from collections.abc import Mapping

LENGTHS, ANGLES = ("L1", "L2", "L3", "L4", "L5", "Hb"), ("theta", "gamma", "alpha_max")
TABLE_2: Mapping[str, Mapping[str, str]] = {
    name: dict(zip((*LENGTHS, *ANGLES), values, strict=True))
    for name, values in {
        "initial": ("352", "457", "120", "120", "305", "235.5", "4.5", "19.4", "110"),
        "scheme 4": ("368", "430", "134", "135", "280", "239", "4.0", "18.0", "105"),
    }.items()
}
SCENES: Mapping[str, str] = {"initial": "double_toggle_clamp", "scheme 4": "double_toggle_clamp_scheme4"}
TABLE_1: Mapping[str, Mapping[str, str]] = {
    "M_P": {"initial": "20.20", "scheme 4": "23.10", "change": "14.4"},
    "R_S": {"initial": "1.02", "scheme 4": "1.09", "change": "6.9"},
    "L_sum": {"initial": "1354", "scheme 4": "1346", "change": "-0.6"},
    "R_V max": {"initial": "1.63", "scheme 4": "1.80", "change": "10.4"},
    "R_V peak-valley": {"initial": "0.65", "scheme 4": "0.65", "change": "0"},
    "R_V startup": {"initial": "1.16", "scheme 4": "1.17", "change": "0.9"},
    "a_m peak-valley": {"initial": "128.5", "scheme 4": "135.6", "change": "5.5"},
}
LARGEST_FORCE_RATIO = "26.55"  # the largest M_P of all designs
MEASURED: Mapping[str, str] = {"R_S": "1.085", "R_V max": "1.77"}  # on scheme 4

BOUNDS: Mapping[str, tuple[float, float]] = {
    "L1": (320, 410),
    "L2": (415, 505),
    "L4": (100, 150),
    "L5": (280, 330),
    "theta": (4, 6),
    "gamma": (18, 25),
    "alpha_max": (90, 110),
    "Hb": (210, 250),
}
LENGTH_RATIO = (0.7, 0.85)  # of L1 to L2
PLATEN_STROKE = (500.0, 600.0)  # S_m
MAX_STROKE_RATIO = 1.12  # R_S
MAX_PHI, MAX_OPENING = 85.0, 160.0
