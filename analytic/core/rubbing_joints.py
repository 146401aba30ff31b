"""Kinetostatics with friction: each group's joints take what they rub by as loads, found from unit loads."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from typing import Any

import numpy as np

from scenes import Failure, Status
from scenes.bodies import GROUND
from scenes.channels import POWER
from scenes.drive import ConstantSpeed
from scenes.elements.friction import AT_REST, Friction
from scenes.model.motion import Samples

from .contacts import CONTACTS
from .decomposition import Dyad, Leg, members
from .elements import ActingForce, Given
from .friction import Loads, Rubbing
from .groups.group_equations import Group
from .kinetostatics import Balance, Reactions
from .numbers import samples
from .placing import Kinematics

PARTS = 50  # of what is left of a range of shares, whose ends are tried at once
SHARE_TOL = 1e-8  # of a coefficient, how closely its share is found


@dataclass(frozen=True)
class FrictionBalance(Balance):
    """One pass from the last group to the driver, each with the friction of its joints."""

    shares: Mapping[str, Samples] = field(default_factory=dict)  # of coefficients, by channel; all of them by default
    stuck: dict[Status, Any] = field(default_factory=dict)  # where it is jammed or undetermined, shape (n,)

    def solve(self) -> Reactions:
        """Return what `Balance.solve` does, and the friction's power."""
        on = super().solve()
        if on.friction:
            power = (
                on.friction[friction.channel(self.scene)] * self.motion(friction)[0] for friction in self.scene.friction
            )
            on.friction[POWER] = reduce(np.add, power)
        return on

    def balance(self, group: Dyad | Group | Leg) -> None:
        """Balance a group with the friction of the joints that it is the first to know the force of."""
        number = -1 if not isinstance(group, Dyad | Group) else self.linkage.groups.index(group)
        frictions = [friction for friction, first in self.due if first == number]
        if frictions:
            # X0 and S of (1) in `friction` by superposition: the group is balanced once under all loads without its own
            # friction, and once under each unit of friction alone; statics is linear in them. Only then is it balanced
            # for good, with the frictions found.
            rubbing = [self.rubbing(friction) for friction in frictions]
            on = self.reactions
            kept = Reactions({**on.pin}, {**on.guide}, on.effort)
            slid_on = {body: [*acting] for body, acting in self.slid_on.items()}
            X0 = self.loads(frictions, group, reactions=kept, slid_on=slid_on)
            units = [CONTACTS[type(friction)].unit(friction, self) for friction in frictions]
            columns = [self.loads(frictions, group, reactions=Reactions(), slid_on={}, alone=unit) for unit in units]
            w = self.settled(Loads(rubbing, X0, [*zip(*columns, strict=True)]))
            for friction, unit, size in zip(frictions, units, w, strict=True):
                on.friction[friction.channel(self.scene)] = size
                for body, acting in unit.items():
                    scaled = ActingForce(acting.force * size, acting.at, acting.moment * size)
                    self.slid_on.setdefault(body, []).append(scaled)
        super().balance(group)

    @cached_property
    def due(self) -> Sequence[tuple[Friction, int]]:
        """Each friction with the number of the group that is the first to know the force of its joint."""
        return [(friction, self.first_known(friction)) for friction in self.scene.friction]

    def first_known(self, friction: Friction) -> int:
        """The number of the group that knows a joint's force, -1 for the driver; Failure where that is too late."""
        scene, linkage = self.scene, self.linkage
        group_of = {GROUND: -2} | dict.fromkeys(scene.bodies, -1)
        group_of |= {body: number for number, group in enumerate(linkage.groups) for body in members(group)}
        known, joined = CONTACTS[type(friction)].first_known(friction, self, group_of), friction.joined(scene)
        if max(group_of[body] for body in joined) > known:
            several = f"the force at {friction.joint(scene)} follows from that of a group which its friction loads"
            raise Failure(Status.unsupported, f"{several}; expected {joined[0]} later in the file")
        return known

    def motion(self, friction: Friction) -> tuple[Samples, Samples]:
        """How fast the parts of a joint move on each other, and the largest such rate in the linkage."""
        return CONTACTS[type(friction)].motion(friction, self)

    @cached_property
    def fastest(self) -> tuple[Samples, Samples]:
        """The largest rate of the bodies, rad/s, and the largest speed of the points, m/s."""
        turning = (np.abs(self.k.omega[body]) for body in self.scene.bodies)
        moving = (np.abs(self.k.v[point]) for point in self.scene.moving_points)
        fastest = reduce(np.maximum, turning), reduce(np.maximum, moving)
        law = self.linkage.drive.law
        if isinstance(law, ConstantSpeed) and not np.ndim(self.k.drive):
            return fastest  # a constant rate never rests
        rests = np.abs(self.k.drive) <= AT_REST * law.peak_rate  # and all rates are round-off
        return np.where(rests, np.inf, fastest[0]), np.where(rests, np.inf, fastest[1])

    def rubbing(self, friction: Friction) -> Rubbing:
        """A friction as it acts at the samples."""
        rate, largest = self.motion(friction)
        share = self.shares.get(friction.channel(self.scene), 1.0)
        return Rubbing(
            friction, samples(friction.sense(rate, largest)), samples((friction.viscous or 0.0) * rate), share
        )

    def loads(self, frictions: Sequence[Friction], group: Dyad | Group | Leg, **others: Any) -> list[Any]:
        """The loads X of (1) of `friction` while the group is balanced under other loads."""
        trial = replace(self, **others)
        Balance.balance(trial, group)
        return [CONTACTS[type(friction)].load(friction, trial) for friction in frictions]

    def settled(self, loads: Loads) -> Sequence[Any]:
        """The frictions, NaN where friction holds the linkage; that, and where several fit, is noted in `stuck`."""
        w, bound = loads.solved()
        position = self.given["position"]
        hard = np.broadcast_to(~(bound < 1), position.shape) & np.isfinite(reduce(np.add, loads.X0))
        if not hard.any():
            return w
        rows = loads.picked(hard)
        with np.errstate(all="ignore"):
            found, held = rows.continued()
            several = held if held.any() else rows.several(found)
        found[held] = np.nan
        if several.any():
            status = Status.jammed if held.any() else Status.undetermined
            self.stuck.setdefault(status, np.zeros(position.shape, np.bool_))[np.flatnonzero(hard)[several]] = True
        sizes = [np.array(np.broadcast_to(size, position.shape)) for size in w]
        for size, column in zip(sizes, found.T, strict=True):
            size[hard] = column
        return sizes

    def check(self, first: int, evaluated: Callable[[Any], tuple[Given, Kinematics]]) -> None:
        """Raise Failure, `jammed` or else `undetermined`, at the first position where no friction, or several, fit.

        These positions begin with number `first` of those of `evaluated`, which takes several.
        """
        if not self.stuck:
            return
        status = Status.jammed if Status.jammed in self.stuck else Status.undetermined
        row = int(self.stuck[status].argmax())
        position = float(self.given["position"][row])
        where = self.scene.where(position)
        if status is Status.undetermined:
            raise Failure(status, f"friction leaves several sets of forces at {where}", at=(position, ""))

        def jam() -> str:
            passing = self.passing(lambda count: evaluated(np.full(count, first + row)))
            return f"friction jams it at {where}: it passes with {passing}"

        raise Failure(status, jam, at=(position, ""))

    @np.errstate(all="ignore")
    def passing(self, evaluated: Callable[[int], tuple[Given, Kinematics]]) -> str:
        """With how much of all coefficients it passes at a position, and which joint's coefficient alone frees it.

        `evaluated` has the position so many times: each with a share of its own of some coefficients.
        """
        scene = self.scene
        channels, K = [friction.channel(scene) for friction in scene.friction], len(scene.friction)
        # One row for all coefficients together, one for each alone. PARTS shares of each row are tried at once and the
        # part with the first jam is kept, which gives more digits a round than bisection.
        cut = np.concatenate([np.ones((1, K)), np.eye(K)])  # all of them, or one
        low, high, parts = np.zeros(K + 1), np.ones(K + 1), np.linspace(0, 1, PARTS + 1)
        while (high - low).max() > SHARE_TOL:
            trial = low[:, np.newaxis] + np.outer(high - low, parts)
            shares = 1 - (1 - trial[..., np.newaxis]) * cut[:, np.newaxis]
            by_channel = dict(zip(channels, shares.reshape(-1, K).T, strict=True))
            balance = FrictionBalance(scene, self.linkage, *evaluated(trial.size), shares=by_channel)
            balance.solve()
            jams = balance.stuck.get(Status.jammed, np.zeros(trial.size, np.bool_)).reshape(trial.shape)
            beyond = np.maximum(jams.argmax(axis=1), 1)
            low, high = (trial[range(K + 1), number] for number in (beyond - 1, beyond))
        all_of_them = f"{low[0]:.6g} of all coefficients"
        if not low[1:].any():
            return all_of_them
        friction = scene.friction[(number := int(low[1:].argmax()))]
        joint, least = friction.joint(scene), f"{low[1 + number] * friction.coefficient:.4g}"
        return f"{all_of_them}, or with {least} instead of {friction.coefficient:.4g} at {joint} alone"
