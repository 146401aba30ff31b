"""Small scenes that between them have every joint, drive and load; the shipped scenes have the rest."""

HEAD = 'format = 1\nunits = { length = "mm", angle = "deg", speed = "rpm" }\n'
SLIDER_HEAD = 'format = 1\nunits = { length = "mm", angle = "deg", speed = "mm/s" }\n'

# RPR: a block, pinned to the crank, runs in the slotted rocker; then a link and a ram, RRP.
QUICK_RETURN = f"""{HEAD}
name = "quick_return"
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
C = [0, -400]
[bodies.crank]
lengths = {{ "O-A" = 150 }}
mass = 3
[bodies.block]
points = {{ A = [10, 5] }}
mass = 2
com = [12, 9]
inertia = 900
slides = {{ on = "rocker", through = [0, 20], along = [2, 0.1] }}
[bodies.rocker]
points = {{ C = [0, 0], D = [800, 0] }}
mass = 8
[bodies.link]
lengths = {{ "D-E" = 300 }}
mass = 2
[bodies.ram]
points = {{ E = [0, 0] }}
mass = 30
slides = {{ through = [0, 400], along = [1, 0] }}
[drive]
body = "crank"
speed = 60
start = 10
[[loads]]
body = "ram"
at = "E"
force = [-500, 0]
last = 120
[sketch]
angle = 0
A = [150, 0]
D = [280, 350]
E = [577, 400]
[output]
slider = "E"
"""

# RPR the other way round: the rod slides in a block that swings about the ground.
SWINGING_BLOCK = f"""{HEAD}
name = "swinging_block"
[ground.points]
O = [0, 0]
C = [300, 50]
[bodies.crank]
points = {{ O = [0, 0], A = [0, 80] }}
mass = 1
[bodies.rod]
points = {{ A = [0, 0], T = [500, 30] }}
mass = 4
slides = {{ on = "block", through = [0, 15], along = [1, 0] }}
[bodies.block]
points = {{ C = [0, 0] }}
mass = 2
com = [0, 5]
inertia = 2000
[drive]
body = "crank"
speed = -120
[[springs]]
between = ["ground.O", "rod.T"]
stiffness = 2
length = 300
[sketch]
angle = -90
A = [80, 0]
T = [570, 120]
[output]
point = "T"
"""

# RPP: a Scotch yoke.
SCOTCH_YOKE = f"""{HEAD}
name = "scotch_yoke"
[ground.points]
O = [0, 0]
[bodies.crank]
lengths = {{ "O-A" = 100 }}
mass = 2
[bodies.block]
points = {{ A = [0, 0] }}
mass = 1
slides = {{ on = "yoke", through = [0, 0], along = [0.2, 1] }}
[bodies.yoke]
points = {{ Y = [0, 0], T = [200, 10] }}
mass = 6
slides = {{ through = [0, 30], along = [1, 0] }}
[drive]
body = "crank"
speed = 100
[[loads]]
body = "yoke"
at = "T"
table = [[-50, 0], [0, -100], [60, -400]]
[sketch]
angle = 0
A = [100, 0]
[output]
slider = "T"
"""

# PRP: a block in the crank's slot, pinned to a slider on the ground; only part of a turn, and backwards.
TANGENT = f"""{HEAD}
name = "tangent"
[ground.points]
O = [0, 0]
[bodies.crank]
points = {{ O = [0, 0], T = [400, 0] }}
mass = 3
[bodies.block]
points = {{ P = [0, 0] }}
mass = 1
slides = {{ on = "crank", through = [0, 40], along = [1, 0] }}
[bodies.slider]
points = {{ P = [0, 0] }}
mass = 4
slides = {{ through = [0, 300], along = [1, 0.1] }}
[drive]
body = "crank"
speed = -20
start = 130
end = 50
[[loads]]
body = "slider"
at = "P"
force = [30, -10]
[sketch]
angle = 60
P = [120, 312]
T = [200, 350]
[output]
slider = "P"
"""

# RRP on a moving guide: a block on the coupler of a four-bar, held by a bar.
CARRIED_BLOCK = f"""{HEAD}
name = "carried_block"
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
C = [400, 0]
F = [150, 500]
[bodies.crank]
lengths = {{ "O-A" = 80 }}
mass = 1
[bodies.coupler]
points = {{ A = [0, 0], B = [350, 0] }}
mass = 4
[bodies.rocker]
lengths = {{ "C-B" = 250 }}
mass = 2
[bodies.block]
points = {{ P = [0, 0] }}
mass = 1.5
slides = {{ on = "coupler", through = [0, 30], along = [1, 0] }}
[bodies.bar]
lengths = {{ "F-P" = 420 }}
mass = 2
[drive]
body = "crank"
speed = 90
[sketch]
angle = 0
A = [80, 0]
B = [375, 249]
P = [246, 91]
[output]
point = "P"
"""

# A driven slider opens a toggle; the plate has four points, by lengths; a spring pulls its tail to the ground.
DRIVEN_TOGGLE = f"""{SLIDER_HEAD}
name = "driven_toggle"
[ground.points]
A = [0, 0]
S = [0, 300]
[bodies.plate]
lengths = {{ "A-B" = 350, "A-D" = 300, "B-D" = 120, "B-K" = 60, "D-K" = 90 }}
mass = 9
com = [200, 60]
inertia = 1.5e5
[bodies.link]
lengths = {{ "B-C" = 450 }}
mass = 5
[bodies.platen]
points = {{ C = [0, 0] }}
mass = 80
slides = {{ through = [0, 60], along = [1, 0] }}
[bodies.rod]
lengths = {{ "D-E" = 120 }}
mass = 2
[bodies.crosshead]
points = {{ E = [0, 0] }}
mass = 20
slides = {{ through = [0, 235], along = [1, 0] }}
[drive]
body = "crosshead"
speed = -150
start = 100
end = -150
[[loads]]
body = "platen"
at = "C"
table = [[500, 0], [700, 2000]]
[[springs]]
between = ["ground.S", "plate.K"]
stiffness = 1.5
length = 80
[sketch]
displacement = 100
B = [280, 210]
D = [180, 240]
K = [230, 290]
C = [700, 60]
E = [64, 235]
[output]
slider = "C"
"""

# A motion law: the crank swings to and fro, once; and one that turns, slows down and goes on, for ever.
SWINGING_LAW = """[drive]
body = "crank"
law = [[0, 200], [0.2, 215], [0.5, 290], [0.7, 320], [1.0, 250], [1.2, 235]]
"""
TURNING_LAW = """[drive]
body = "crank"
law = [[0, 0], [0.15, 70], [0.5, 150], [0.7, 220], [1.1, 360]]
periodic = true
"""

# Class III with a slot: a plate on two bars, and on a block that the ground holds and that runs in the plate's slot.
SLOTTED_CLASS_III = f"""{HEAD}
name = "slotted_class_iii"
gravity = [1, -9.81]
[ground.points]
O = [0, 0]
C1 = [600, 0]
C2 = [250, 150]
[bodies.crank]
lengths = {{ "O-A" = 60 }}
mass = 1
[bodies.coupler]
lengths = {{ "A-P0" = 250 }}
mass = 2
[bodies.plate]
points = {{ P0 = [0, 0], P1 = [300, 0] }}
mass = 6
[bodies.upper]
lengths = {{ "C1-P1" = 290 }}
mass = 2
[bodies.block]
points = {{ C2 = [0, 0] }}
mass = 1
slides = {{ on = "plate", through = [0, -60], along = [1, 0.1] }}
[drive]
body = "crank"
speed = 60
start = -60
end = 60
[sketch]
angle = 0
A = [60, 0]
P0 = [150, 233]
P1 = [440, 240]
[output]
point = "P1"
"""


def with_drive(text: str, drive: str) -> str:
    """Return the text of a scene with another `[drive]` table."""
    before, _, rest = text.partition("[drive]\n")
    _, _, after = rest.partition("\n[")
    return f"{before}{drive}[{after}"


MECHANISMS = {
    "quick_return": QUICK_RETURN,
    "swinging_block": SWINGING_BLOCK,
    "scotch_yoke": SCOTCH_YOKE,
    "tangent": TANGENT,
    "carried_block": CARRIED_BLOCK,
    "driven_toggle": DRIVEN_TOGGLE,
    "slotted_class_iii": SLOTTED_CLASS_III,
    "swinging_law": with_drive(QUICK_RETURN, SWINGING_LAW),
    "turning_law": with_drive(QUICK_RETURN, TURNING_LAW),
}
