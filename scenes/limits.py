"""How much a file may ask for, and why no more. Beyond each of these a file is refused before any work is done."""

FILE_BYTES = 1_000_000  # a table of 10,000 rows in full digits has half of it; reading it takes 2 s
NESTING = 32  # of tables and lists; a scene needs five
KEY_PARTS = 20  # of a key such as `a.b.c`; a scene needs four, and the parser's time goes with their square
INTEGER_BITS = 64  # what TOML asks of every reader

NAME = 64  # characters: names of folders and files are made of them, which file systems limit to 255 bytes
TITLE = 200  # characters: it is the heading of a page
SOURCE = 2000  # characters: a paragraph of a page

BODIES = 100  # the models' time goes with their square or cube: 21 take a minute, 51 two and a half
POINTS = 1000  # of all bodies and the ground, a pin's once for each: a run of 300 takes seven times as long as of 10
CORNERS = 200  # of an outline: each of its sides is held against all others, in 10 ms
LOADS = 200  # and as many springs, each evaluated at every step: a run of two hundred springs takes three times as long
ROWS = 10_000  # of a force table, and of a motion law: a run takes three times as long as with one row
SEGMENTS = 100  # of a motion, and as many harmonics: time steps begin anew at each boundary of two
WAVES = 36  # of the fastest harmonic in a cycle: ten of the 360 samples for each
TURNS = 10  # of a crank in a cycle: scales and ends of strokes are found at 3,600 instants of it, 360 a turn
LARGEST = 1e45  # of a deviation, as of a moment of inertia: its square with whatever gradient is a double
VARIATIONS = 200  # numbers of a scene that vary at once, each a dimension of the draws and a derivative
VALUES = 25_000_000  # samples times channels of a run, or rows times columns of a result: three engines take 4 GB
PATH = 300  # characters of the path of one: three names and what is between them
