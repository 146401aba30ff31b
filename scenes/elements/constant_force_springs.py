"""Constant-force springs: strips of steel that roll up, which pull two points together as hard at any length."""

from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import Field

from ..bodies import Body
from ..fields import Newtons
from .element import ElementTable
from .springs import BETWEEN, Between, PointPair, ends_of


@dataclass(frozen=True)
class ConstantForceSpring(PointPair):
    """It pulls its ends together along their line, with the same force at any length."""

    kind = "constant-force springs"
    noun = "constant-force spring"

    force: Newtons  # N; negative to push them apart

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """Its force."""
        return abs(self.force)


class ConstantForceSpringTable(ElementTable):
    """A spring that pulls two points together with the same force at any length."""

    key = "constant_force_springs"
    about = "Springs between two points that pull with the same force at any length."
    kinds = (ConstantForceSpring,)

    between: Between = Field(description=BETWEEN)
    force: Newtons = Field(description="It pulls the ends together; a negative one pushes them apart.")

    def element(self, place: str, _: Mapping[str, Body]) -> ConstantForceSpring:  # noqa: ARG002
        """The spring, its numbers as they are."""
        return ConstantForceSpring(*ends_of(self.between), self.force)
