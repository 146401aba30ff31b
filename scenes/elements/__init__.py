"""What acts on the bodies besides their weight: a kind of load or spring a file.

An engine declares the kinds that it knows, each a phrase that fits into "it knows no ...".
"""

PLAIN_KINDS = frozenset({"forces", "press forces", "force tables", "springs"})  # that every engine knows
ALL_KINDS = PLAIN_KINDS | {
    "forces that turn with their body",
    "forces along guides",
    "forces by tables",
    "moments",
    "dampers",
    "torsion springs",
    "friction",
    "cylinders that drive",
    "drives between moving bodies",
}
