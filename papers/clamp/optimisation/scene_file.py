"""A design as a scene file, for the dynamic models: as the two that are shipped, with everything that follows from X.

The platen's guide is at the height of the locked toggle, L3 closes the triangle A-B-D, the drive runs from the open to
the given position, and the dies are met where the clamp locks. Masses, speed and stiffness are those of the shipped
scenes.
"""

from math import degrees
from string import Template

import numpy as np

from ..formulas import Array, bar, beta, crosshead, ear, platen, third_length

SPEED = 100.0  # mm/s
HALF_FORCE = 2000.0  # kN, of one toggle of the two
YIELD = 1.0  # mm, of tie bars and dies under it

_SCENE = Template("""\
format = 1
name = "$name"
title = "Double-toggle clamp: $name"
source = "L1 = $L1, L2 = $L2, L3 = $L3, L4 = $L4, L5 = $L5, Hb = $Hb mm, theta = $theta, gamma = $gamma, \
alpha_max = $alpha_max deg; masses, speed and stiffness are assumed"
units = { length = "mm", mass = "kg", force = "kN", speed = "mm/s" }
[ground.points]
A = [0, 0]
[bodies.rear_link]
lengths = { "A-B" = $L1, "A-D" = $L5, "B-D" = $L3 }
mass = 80
[bodies.front_link]
lengths = { "B-C" = $L2 }
mass = 110
[bodies.platen]
points = { C = [0, 0] }
slides = { through = [0, $height], along = [1, 0] }
mass = 2000
[bodies.crosshead_link]
lengths = { "D-E" = $L4 }
mass = 15
[bodies.crosshead]
points = { E = [0, 0] }
slides = { through = [0, $Hb], along = [1, 0] }
mass = 60
[drive]
body = "crosshead"
speed = $speed
start = $start
end = $end
[[loads]]
body = "platen"
at = "C"
$load
[sketch]
displacement = $start
B = $B
D = $D
C = $C
E = $E
[output]
slider = "C"
""")


def locking(X: Array, name: str) -> str:
    """Return the scene of a design from open to locked, against dies that yield."""
    lock = float(platen(X, 0.0))
    load = f"table = [[{lock - YIELD!r}, 0], [{lock + YIELD!r}, {-2 * HALF_FORCE!r}]]"
    return _scene(X, name, 0.0, load)


def pressing(X: Array, name: str, alpha: float) -> str:
    """Return the scene of a design that closes to some alpha, all the way against half the clamping force."""
    return _scene(X, name, alpha, f"force = [{-HALF_FORCE!r}, 0]")


def _scene(X: Array, name: str, alpha: float, load: str) -> str:
    L1, L2, L4, L5, theta, gamma, alpha_max, Hb = (float(x) for x in X)
    height = (L1 + L2) * float(np.sin(theta))
    start = float(crosshead(X, alpha_max))
    turned, up = float(bar(X, alpha_max)), float(ear(X, alpha_max))
    B = [L1 * float(np.cos(turned)), L1 * float(np.sin(turned))]
    return _SCENE.substitute(
        {"name": name, "L1": L1, "L2": L2, "L3": float(third_length(X)), "L4": L4, "L5": L5, "Hb": Hb}
        | {"theta": degrees(theta), "gamma": degrees(gamma), "alpha_max": degrees(alpha_max)}
        | {"height": height, "speed": SPEED, "start": start, "end": float(crosshead(X, alpha)), "load": load}
        | {"B": B, "D": [L5 * float(np.cos(up)), L5 * float(np.sin(up))]}
        | {"C": [B[0] + L2 * float(np.cos(beta(X, alpha_max))), height], "E": [start, Hb]}
    )
