"""An engine that keeps to the contract, and copies of it with one fault each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import count
from math import pi
from types import SimpleNamespace
from typing import Any, NoReturn

import analytic.engine as core
from scenes import Failure, Motion, Positions, Request, Scene, Settings, Status
from scenes.channels import named
from scenes.model.engine import completed
from scenes.model.motion import Samples

DEFAULT = Settings("plain", promise=1e-6)
FAST = Settings("fast", promise=1e-6)
RUNS = count(1)


@dataclass(frozen=True)
class Asked:
    """What a run is asked for, and that run: the core's answer, spoilt."""

    fault: "Fault"
    scene: Scene
    settings: Settings
    request: Request

    def solve(self) -> None:
        """Do nothing yet."""

    def read(self) -> Motion:
        real = core.build(self.scene, core.DEFAULT, self.request)
        real.solve()
        motion = real.read()
        return self.fault.spoil({c: motion[c] for c in self.request.wanted(self.scene)}, self)


@dataclass(frozen=True)
class Fault:
    """Which clause it breaks, and what is wrong: names of the module, what happens first, or what is returned."""

    clause: str
    names: Mapping[str, Any] = field(default_factory=dict)
    first: Callable[[Asked], object] = lambda _: None
    spoil: Callable[[dict[str, Samples], Asked], Motion] = lambda samples, _: Motion(samples)
    words: str = ""  # of the report

    def engine(self) -> Any:
        def build(*of: Any) -> Asked:
            self.first(asked := Asked(self, *of))
            return asked

        return completed(SimpleNamespace(**{"DEFAULT": DEFAULT, "build": build, **self.names}), "wrong 1.0")


# --- what can be wrong ------------------------------------------------------------------------------------------------


def changed(change: Callable[[Samples], Samples], *quantities: str) -> Callable[[dict[str, Samples], Asked], Motion]:
    def spoil(samples: dict[str, Samples], _: Asked) -> Motion:
        return Motion(
            {c: change(v) if not quantities or named(c).name in quantities else v for c, v in samples.items()}
        )

    return spoil


def raised(error: Exception) -> NoReturn:
    raise error


def without(samples: dict[str, Samples], reason: str | None) -> Motion:
    channel = next(c for c in samples if named(c).name == "omega")
    kept = {c: v for c, v in samples.items() if c != channel}
    return Motion(kept, {} if reason is None else {channel: reason})


REFUSED = Failure(Status.unsupported, "")
UNSENDABLE: dict[str, Any] = {"label": "a", "note": lambda: 0}

FAULTS = {
    # protocol
    "no version": Fault("it_gives_its_version", {"version": lambda: ""}),
    "settings with a function": Fault("settings_are_data", {"WORK_PRECISION": (replace(DEFAULT, **UNSENDABLE),)}),
    "two of one label": Fault(
        "settings_can_be_told_apart", {"WORK_PRECISION": (DEFAULT, replace(DEFAULT, drive_promise=1e-3))}
    ),
    "exact promises less": Fault(
        "settings_promise_more_the_more_accurate_they_are", {"EXACT": Settings("exact", promise=1e-3)}
    ),
    "other steps": Fault("settings_by_steps", {"at_steps": lambda _: core.WORK_PRECISION[-1]}),
    # motion
    "an error of its own": Fault("a_shipped_scene_is_solved_or_refused", first=lambda _: 1 / 0),
    "no reason": Fault("a_shipped_scene_is_solved_or_refused", first=lambda _: raised(REFUSED)),
    "a channel less": Fault("every_channel_is_there_or_has_a_reason", spoil=lambda of, _: without(of, None)),
    "an empty reason": Fault("every_channel_is_there_or_has_a_reason", spoil=lambda of, _: without(of, "")),
    "single precision": Fault("samples_are_one_number_an_instant", spoil=changed(lambda v: v.astype("f4"))),
    "a row less": Fault("samples_are_one_number_an_instant", spoil=changed(lambda v: v[:-1])),
    "late": Fault("samples_are_one_number_an_instant", spoil=changed(lambda v: v + 1e-6, "time")),
    "reactions of the other side": Fault("the_promise_is_kept", spoil=changed(lambda v: -v, "fx", "fy"), words="sign"),
    "degrees": Fault("the_promise_is_kept", spoil=changed(lambda v: v * 180 / pi, "angle"), words="deg"),
    "a bold promise": Fault(
        "the_promise_is_kept",
        {"DEFAULT": replace(DEFAULT, promise=1e-9)},
        spoil=changed(lambda v: v * (1 + 1e-8), "fx"),
    ),
    "FAST is not good": Fault(
        "each_tier_keeps_its_promise",
        {"FAST": FAST},
        spoil=lambda v, of: changed(lambda v: v * 1.001 if of.settings == FAST else v, "ax")(v, of),
    ),
    "an angle modulo a turn": Fault("several_cycles", spoil=changed(lambda v: -(-v % (2 * pi)), "crank_angle")),
    "all channels": Fault(
        "only_what_is_asked_for", spoil=lambda v, of: Motion(dict.fromkeys(of.scene.channels.names(), v["time"]) | v)
    ),
    "masses are needed": Fault(
        "a_scene_without_masses_has_no_forces", first=lambda of: sum(b.mass or 1 / 0 for b in of.scene.bodies.values())
    ),
    "a memory": Fault("a_run_leaves_no_trace_in_the_next", spoil=changed(lambda v: v * (1 + 1e-13 * next(RUNS)), "ax")),
    # refusals
    "an error where nothing closes": Fault(
        "what_cannot_be_assembled_is_not_ok", first=lambda of: 1 / (of.scene.name == "four_bar")
    ),
    "positions out of order": Fault(
        "positions_are_solved_or_refused",
        spoil=lambda v, of: changed(lambda v: v[::-1] if isinstance(of.request, Positions) else v)(v, of),
    ),
    "positions are no instants": Fault("positions_are_solved_or_refused", first=lambda of: vars(of.request)["turns"]),
}
