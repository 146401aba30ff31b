"""Units of a scene file: the name of each dimension's unit, and what that is in SI."""

from collections.abc import Mapping

SI = {"length": ("m", 1.0), "mass": ("kg", 1.0), "force": ("N", 1.0), "angle": ("rad", 1.0), "speed": ("rad/s", 1.0)}


def units_of_all(units: Mapping[str, tuple[str, float]], *, slides: bool) -> Mapping[str, tuple[str, float]]:
    """The unit of each dimension, and what it is in SI, by those that a file names; a direction has none."""
    (length, m), (mass, kg), (force, newton) = (units[name] for name in ("length", "mass", "force"))
    angle, radian = units["angle"]
    moment, newton_metre = units.get("moment", (f"{force}*m", newton))  # as long as the file names none
    return {
        **units,
        "moment": (moment, newton_metre),
        "position": units["length" if slides else "angle"],
        "inertia": (f"{mass}*{length}^2", kg * m**2),
        "stiffness": (f"{force}/{length}", newton / m),
        "density": ("kg/m^3", 1.0),
        "damping": (f"{force}*s/{length}", newton / m),
        "torsion_stiffness": (f"{moment}/{angle}", newton_metre / radian),
        "torsion_damping": (f"{moment}*s/{angle}", newton_metre / radian),
        "turning_damping": (f"{moment}*s/rad", newton_metre),
        "turning_rate": ("rad/s", 1.0),
        "sliding_rate": (f"{length}/s", m),
        "coefficient": ("", 1.0),
        "time": ("s", 1.0),
        "frequency": ("1/s", 1.0),
        "gravity": ("m/s^2", 1.0),
        "direction": ("", 1.0),
    }
