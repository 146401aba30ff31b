"""What a run returns: on every shipped scene, and on the first that the engine solves."""

from dataclasses import replace

import pytest

from scenes import Motion, Sampling, Scene, Status
from scenes.channels import Role

from ..engines.registry import TIERS, tiers
from ..engines.runner import complete, run
from .asked import SAMPLING, outcome, plain_run
from .test_process import digest


def motion_of(name: str, scene: Scene) -> Motion:
    """Return an engine's motion; a clause on a scene that it does not solve is skipped."""
    motion = plain_run(name, scene.name).motion
    if motion is None:
        pytest.skip("not solved")
    return motion


def given(motion: Motion, scene: Scene) -> set[str]:
    """Return which of a scene's channels a motion knows of; others, of an engine's own, are not looked at."""
    return {*motion.samples, *motion.unsupported} & {*scene.channels.names()}


def test_a_shipped_scene_is_solved_or_refused(name: str, scene: Scene) -> None:
    """A run is ok, or unsupported for a reason; a shipped scene has no other end."""
    ended = plain_run(name, scene.name)
    assert ended.status in (Status.ok, Status.unsupported), f"{ended.status.name}: {ended.reason}"
    assert ended.motion if ended.status is Status.ok else ended.reason


def test_every_channel_is_there_or_has_a_reason(name: str, scene: Scene) -> None:
    """The channels asked for and no others: each has samples, or is unsupported for a reason."""
    motion = motion_of(name, scene)
    assert given(motion, scene) == {*SAMPLING.wanted(scene)}
    assert {*scene.channels.names(Role.time, Role.input)} <= {*motion.samples}
    assert not motion.samples.keys() & motion.unsupported.keys()
    assert all(motion.unsupported.values())


def test_samples_are_one_number_an_instant(name: str, scene: Scene) -> None:
    """Of shape (n,), float64, finite; a row an instant of the request, the start and the end included."""
    motion_of(name, scene)
    whole = complete(plain_run(name, scene.name), scene, SAMPLING)
    assert whole.status is Status.ok, whole.reason


def test_the_promise_is_kept(name: str, scene: Scene) -> None:
    """In SI units, and by the sign rules of `scenes/model/motion.py`, every channel is within what DEFAULT promises."""
    motion_of(name, scene)
    assert not (wrong := outcome(name, scene)), wrong


@pytest.mark.parametrize("tier", TIERS)
def test_each_tier_keeps_its_promise(name: str, solved: Scene, tier: str) -> None:
    """FAST, DEFAULT and EXACT."""
    assert not (wrong := outcome(name, solved, settings=tiers(name)[tier])), wrong


def test_several_cycles(name: str, solved: Scene) -> None:
    """Over two cycles, at fewer samples in each, or once where the drive does not repeat."""
    assert not (wrong := outcome(name, solved, Sampling(24, 2 if solved.periodic else 1))), wrong


def test_only_what_is_asked_for(name: str, solved: Scene) -> None:
    """Of two channels, those alone come back, besides time and drive, and within the promise."""
    some = frozenset(name for name in SAMPLING.wanted(solved) if solved.channels[name].quantity in ("x", "fx"))
    few = replace(SAMPLING, channels=some)
    motion = run(name, solved, few).motion
    assert motion is not None
    assert given(motion, solved) == {*few.wanted(solved)}
    assert not (wrong := outcome(name, solved, few)), wrong


def test_a_scene_without_masses_has_no_forces(name: str, solved: Scene) -> None:
    """A kinematic scene is solved as any other, or refused for a reason."""
    bodies = {body.name: replace(body.weighed, mass=None) for body in solved.bodies.values()}
    kinematic = replace(solved, bodies=bodies, loads=(), springs=())
    ended = run(name, kinematic, SAMPLING)
    assert ended.status in (Status.ok, Status.unsupported), f"{ended.status.name}: {ended.reason}"
    assert ended.motion is None or given(ended.motion, solved) == {*SAMPLING.wanted(kinematic)}


def test_a_run_leaves_no_trace_in_the_next(name: str, solved: Scene) -> None:
    """The same bits, whatever was run in between."""
    first = digest(motion_of(name, solved))
    run(name, solved, Sampling(24), tiers(name)["fast"])
    assert digest(run(name, solved, SAMPLING).motion) == first
