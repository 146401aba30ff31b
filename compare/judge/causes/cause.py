"""A cause of a disagreement as data: what is wrong, where, and by how much; words are made where they are shown."""

from dataclasses import dataclass, field
from enum import Enum, StrEnum

from .parts import Part


class Kind(StrEnum):
    """Causes of a disagreement."""

    unknown = "unknown"
    sign = "opposite sign"
    unit = "factor"
    offset = "offset"
    frame = "another frame"
    swap = "channels swapped"
    copy = "another's channel"
    pair = "another pair of bodies at the pin"
    moment = "moment about another point"
    term = "a term of the acceleration"
    lag = "late"
    drive = "drive"
    mass = "mass"
    inertia = "moment of inertia"
    com = "centre of mass"
    length = "length"
    place = "place on the ground"
    guide = "guide"
    load = "load"
    spring = "spring"
    gravity = "gravity"
    friction = "friction"
    missing = "missing"
    nonfinite = "not finite"
    held = "rows held"
    constant = "constant"
    spike = "spoilt sample"
    rows = "rows out of order"
    noise = "noise"
    differences = "differences of samples"
    branch = "another branch"
    solver = "discretisation"
    start = "start transient"
    coarse = "interpolation"
    code = "wrong line"


class Way(Enum):
    """In what way something is wrong: a sentence with gaps, see `words`, for where it is and by how much."""

    unknown = "the cause is unknown"
    settings = "its settings are too coarse: of its error {one}"

    missing = "{one} is missing"
    several_missing = "{one} and {count} more are missing"
    no_double = "{one} is of {two}, not float64"
    of_other_size = "{one} has {count} samples of {of}"
    not_finite = "{one} is not finite"
    same_instant = "row {count} has the instant of the row before"
    earlier_instant = "row {count} is of an earlier instant than the row before"
    cycle = "the drive's cycle is {share} of itself too {long}"
    instants = "the samples are off the instants asked for, by up to {number} s"
    row_held = "{place} repeats a row, first at {where}"
    sample_held = "{place} repeats a sample"
    row_order = "{place} has rows of other instants, first at {where}"
    spoilt = "{place} is spoilt at {where}, its neighbours are not"

    zero = "{part} {is} zero"
    constant = "{part} {is} constant"
    opposite = "{part} {has} the opposite sign"
    reaction = "{part} {has} the opposite sign, as on the other body"
    mirrored_axis = "{part} points the other way"
    factor = "{part} {is} {times}"
    factor_of_unit = "{part} {is} {times}, {one} in place of {two}"
    offset = "{part} {is} off by a constant, {numbers}"
    frame_of = "{part} {is} in the frame of {one}"
    frame_of_reversed = "{part} {is} in the frame of {one}, turned the wrong way"
    frames_of = "{part} {is} in the frames of the {one} bodies at the joints"
    turned = "{part} {is} turned by {angle}"
    components = "{part} {has} {its} components swapped"
    that_of = "{part} {is} that of {one}"
    opposite_of = "{part} {is} the opposite of that of {one}"
    added = "{part} {has} added to it that of {one}"
    relative = "{part} {is} relative to that of {one}"
    copy = "{part} is a copy of {one}"
    swapped = "{place} and {one} are swapped"
    no_term = "{part} {is} without {its} {one} term"
    term_sign = "{part} {has} the opposite sign of {its} {one} term"
    moment = "{place}'s guide moment is about another point, {length} away"

    frame = "all is in another frame, {frame}"
    lengths_unit = "all lengths are in {one} in place of {two}"
    lengths_factor = "all lengths are {times}"
    by_angle = "all rates are by the crank's angle, per {one}, in place of the time"
    axis_unit = "the crank's angle, by which the rows are, is in {one} in place of {two}"

    late = "{part} {is} {late}"
    late_rows = "{part} {is} {late_rows}"
    differences = "{part} {is} {one} differences of samples"
    smoothed = "{part} {is} smoothed over {its} samples"
    drift = "{part} {is} drifting away steadily"
    growth = "{part} {is} growing steadily, by {growth} at the end"
    between = "{part} {is} {one} between every {count}th sample"
    transient = "{part} {has} a start transient"
    noisy = "{part} {is} noisy"

    drive = "the drive is off by {displacement}"
    drive_up_to = "the drive is off by up to {displacement}"
    speed = "the drive runs at another speed, {faster}"
    rates = "the drive has rates of another speed, {faster}"
    clock = "all instants are too far apart, {faster}"
    entry = "entry {count} of the drive's law is off by {displacement}"

    mass = "{place}'s mass is {percent}"
    masses = "each body's mass is {percent}"
    masses_swapped = "the masses of {place} and {one} are swapped"
    inertia = "{place}'s moment of inertia is {inertia}"
    inertias = "each body's moment of inertia is {percent}"
    width = "each uniform bar's moment of inertia is that of one {length} wide"
    com = "{place}'s centre of mass is {com}"
    inertia_share = "inertia's share of all forces is {percent}"
    centripetal_share = "the share m s w^2 of all forces is {percent}"
    length = "{place}'s length {one} is {length} too {long}"
    point = "{place}'s point {one} is {length} off"
    ground = "{place} is {length} off"
    beside = "{place}'s guide is {length} beside its place"
    tilted = "{place}'s guide is turned by {angle}"
    scale = "each length is {times}"
    varying = "{place}'s length {one} varies by {length} over the turn"

    load = "the load at {place} is {percent}"
    load_vector = "the load at {place} is {force} at {way}"
    load_turning = "the load at {place} turns with {one}"
    load_elsewhere = "the load at {place} acts at {one} of {two}"
    load_at_com = "the load at {place} acts at {one}'s centre of mass"
    load_late = "the load at {place} is {late}"
    table_shifted = "the table of the load at {place} is shifted by {signed_length}"
    table_backwards = "the table of the load at {place} is backwards"
    press_always = "the press force at {place} acts always"
    press_closing = "the press force at {place} acts all of the closing stroke"
    press_both_ways = "the press force at {place} acts on the way back too"
    press_back = "the press force at {place} acts on the way back"
    press_opening = "the press force at {place} acts at the end of the opening stroke"
    press_opening_too = "the press force at {place} acts at the end of the opening stroke too"
    press_last = "the press force at {place} acts in the last {length}"
    stiffness = "the spring {place}{stiffness}"
    spring_length = "the spring {place}'s length is {percent}"
    gravity = "gravity is {percent}"
    gravity_size = "gravity is {number} m/s^2"
    gravity_vector = "gravity is ({numbers}) m/s^2"
    gravity_on = "gravity on {place} is {percent}"
    guide_friction = "{place}'s guide has friction ({one}, {number})"
    pin_friction = "the pin {place} has friction ({one}, {number})"
    effort_friction = "{two} has {one} friction of {place} that no reaction has"


@dataclass(frozen=True)
class Cause:
    """What is likely wrong, where, and by how much."""

    kind: Kind = Kind.unknown
    place: str = ""  # a body, joint, channel, "drive" or "all"; empty where unknown
    way: Way = Way.unknown
    amounts: tuple[float, ...] = ()  # SI, or shares
    names: tuple[str, ...] = ()  # of what else is in it, as the other of two that are swapped
    part: Part | None = None  # the channels
    rows: tuple[float, ...] = ()  # positions of the drive: the first and the last where it acts, or the first alone
    left: float = 0.0  # of the error, that it does not explain
    besides: tuple["Cause", ...] = ()  # what is wrong too: they explain the error together
    others: tuple["Cause", ...] = field(default=(), compare=False)  # each of which explains it as well

    @property
    def known(self) -> bool:
        """Whether there is one."""
        return self.kind is not Kind.unknown

    def widens(self, other: "Cause") -> bool:
        """Whether it is the other one, of more channels."""
        both = self.part is not None and other.part is not None and self.way is other.way
        return both and {*other.part.channels} < {*self.part.channels}  # type: ignore[union-attr]

    @property
    def all(self) -> tuple["Cause", ...]:
        """It and what is wrong besides."""
        return (self, *self.besides)


UNKNOWN = Cause()
