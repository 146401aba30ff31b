"""Small scenes for the tests of the Exudyn model, each with its own difficulty."""

from tests.mechanisms import MECHANISMS

SLIDER_CRANK = """
format = 1
name = "slider_crank"
[ground.points]
A = [0, 0]
[bodies.crank]
points = { A = [0, 0], B = [0.3, 0] }
mass = 0
[bodies.rod]
lengths = { "B-C" = 1 }
mass = 0
[bodies.slider]
points = { C = [0, 0], E = [0.2, 0.1] }
slides = { through = [0, 0], along = [1, 0] }
mass = 0
[drive]
body = "crank"
speed = 2
[[loads]]
body = "slider"
at = "E"
force = [-100, 0]
[sketch]
B = [0.3, 0]
C = [1.3, 0]
[output]
slider = "C"
"""

FOUR_BAR = """
format = 1
name = "four_bar"
gravity = [0.5, -9.81]
[ground.points]
A = [1, 2]
D = [3, 2.5]
[bodies.coupler]
points = { B = [0, 0], C = [2.1, 0.3], T = [1, 1.2] }
mass = 3
com = [0.8, 0.4]
inertia = 0.7
[bodies.crank]
lengths = { "B-A" = 0.6 }
mass = 2
[bodies.rocker]
lengths = { "C-D" = 1.5 }
mass = 4
[drive]
body = "crank"
speed = -7
start = 2.0
[[loads]]
body = "coupler"
at = "T"
force = [30, -20]
[[loads]]
body = "rocker"
at = "C"
force = [0, 50]
[sketch]
angle = 3.5
B = [1.55, 2.2]
C = [3.4, 3.9]
[output]
point = "T"
"""

THREE_AT_A_PIN = """
format = 1
name = "three_at_a_pin"
[ground.points]
A = [0, 0]
D = [0.9, -0.2]
[bodies.crank]
lengths = { "A-B" = 0.2 }
mass = 2
[bodies.coupler]
lengths = { "B-C" = 0.8 }
mass = 1
[bodies.rocker]
lengths = { "D-C" = 0.7 }
mass = 1
[bodies.rod]
lengths = { "C-E" = 1.2 }
mass = 2
[bodies.slider]
points = { E = [0, 0] }
slides = { through = [1.0, 1.5], along = [0, -1] }
mass = 6
[drive]
body = "crank"
speed = 5
[[loads]]
body = "rod"
at = "C"
force = [40, 10]
[sketch]
angle = 0.1
B = [0.2, 0]
C = [0.7, 0.5]
E = [1, 1.6]
[output]
slider = "E"
"""

PARALLELOGRAM = """
format = 1
name = "parallelogram"
[ground.points]
A = [0, 0]
D = [1, 0]
[bodies.crank]
lengths = { "A-B" = 0.3 }
[bodies.coupler]
points = { B = [0, 0], C = [1, 0], G = [0.5, 0] }
[bodies.rocker]
lengths = { "D-C" = 0.3 }
[drive]
body = "crank"
speed = 5
start = 1.0
[sketch]
angle = 1.5708
B = [0, 0.3]
C = [1, 0.3]
[output]
point = "C"
"""

# A third crank makes the parallelogram redundant, and two blocks joined by a link move by themselves: the count is 1.
REDUNDANT = (
    PARALLELOGRAM.replace("D = [1, 0]", "D = [1, 0]\nF = [0.5, 0]")
    .replace("C = [1, 0.3]", "C = [1, 0.3]\nG = [0.5, 0.3]\nS = [0.7, 3]\nU = [0, 2.3]")
    .replace(
        "[drive]",
        """[bodies.extra]
lengths = { "F-G" = 0.3 }
[bodies.block]
points = { S = [0, 0] }
slides = { through = [0, 3], along = [1, 0] }
[bodies.link]
lengths = { "S-U" = 1 }
[bodies.other_block]
points = { U = [0, 0] }
slides = { through = [0, 2], along = [0, 1] }
[drive]""",
    )
)

# A driven slider on an oblique guide, centres of mass off every first point, a law that reverses, a press load, and a
# spring; nothing turns, so that accelerations are linear in what the drive asks for.
WEDGE = """
format = 1
name = "wedge"
gravity = [0, -9.81]
[ground.points]
G = [0, 0]
[bodies.wedge]
points = { W = [0, 0], T = [0.1, 0.05] }
mass = 5
com = [0.06, 0.03]
inertia = 0.02
slides = { through = [0.1, 0.02], along = [-1, 2] }
[bodies.block]
points = { F = [0, 0] }
mass = 1
slides = { on = "wedge", through = [0, 0.05], along = [1, 0.3] }
[bodies.follower]
points = { F = [0, 0], H = [0.1, 0.3] }
mass = 2
slides = { through = [0.4, 0], along = [0.2, -1] }
[drive]
body = "wedge"
law = [[0, 0], [0.1, 0.05], [0.25, 0.15], [0.3, 0.1], [0.4, 0.02], [0.5, 0]]
periodic = true
[[loads]]
body = "follower"
at = "H"
force = [20, 300]
last = 0.03
[[springs]]
between = ["wedge.T", "follower.H"]
stiffness = 500
length = 0.2
[sketch]
displacement = 0.1
F = [0.4, 0.1]
[output]
slider = "F"
"""

# Oldham's coupling: bodies that slide on what slides on the crank; the sketch does not show where the disc is.
OLDHAM = """
format = 1
name = "oldham"
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
C = [0.03, 0.02]
[bodies.crank]
points = { O = [0, 0], A = [0.1, 0] }
mass = 1
[bodies.disc]
points = { D = [0.01, 0.02] }
mass = 2
com = [0.03, -0.01]
inertia = 0.004
slides = { on = "crank", through = [0.02, 0.01], along = [1, 0.3] }
[bodies.output]
points = { C = [0, 0] }
mass = 3
com = [0.02, 0.05]
inertia = 0.01
slides = { on = "disc", through = [0, 0.03], along = [-0.2, 1] }
[drive]
body = "crank"
speed = 12
start = 0.4
[sketch]
A = [0.1, 0]
[output]
point = "D"
"""

# The same wedge and nothing but points, so that only the drive's travel says how large it is.
POINTS = (
    WEDGE.replace("W = [0, 0], T = [0.1, 0.05]", "W = [0, 0]")
    .replace("com = [0.06, 0.03]\ninertia = 0.02\n", "")
    .replace("F = [0, 0], H = [0.1, 0.3]", "F = [0, 0]")
    .replace('at = "H"', 'at = "F"')
    .replace('[[springs]]\nbetween = ["wedge.T", "follower.H"]\nstiffness = 500\nlength = 0.2\n', "")
)

SCENES = MECHANISMS | {"wedge": WEDGE, "points": POINTS, "oldham": OLDHAM}
