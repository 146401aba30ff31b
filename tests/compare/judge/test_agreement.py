"""The verdict in a word and a sentence, of judgements of every kind."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import compare
from compare.judge.agreement import Agreement, Judgement, Word, worst_error
from compare.judge.measure import Measurement, Standard, assess, measure
from compare.judge.verdict import sized, within
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.reference import Floor, Reference
from compare.mechanics.round_off import explain
from compare.report.tables.first_screen import answers, of_ok
from compare.study import Study
from scenes import Failure, Motion, Status
from scenes.channels import named
from tests.comparisons import SAMPLING, Outcome, Plug, changed, commanded, sampled

Judge = Callable[..., Judgement]


@pytest.fixture(scope="module")
def exudyn(reference: Reference) -> Measurement:
    return measure(reference, "exudyn", SAMPLING)


@pytest.fixture
def judge(reference: Reference, exudyn: Measurement, plug: Plug) -> Judge:
    """Return a function that judges the toggle press by the core, Exudyn and an engine that ends as told."""

    def judged(
        outcome: Outcome, engines: tuple[str, ...] = ("analytic", "exudyn", "stub"), **limits: float
    ) -> Judgement:
        plug(outcome)
        scene = replace(reference.scene, tolerances={"stub": limits})
        of = replace(reference, mechanics=Mechanics(scene))
        measured = [exudyn if engine == "exudyn" else measure(of, engine, SAMPLING) for engine in engines]
        return Judgement(scene, SAMPLING, of, explain(of, SAMPLING), measured, [])

    return judged


def plain(verdict: Agreement) -> Agreement:
    """Return a verdict whose sentence a reader understands: no exponent, nothing that is no number, three figures."""
    assert not re.search(r"\d[eE][-+]?\d|nan|inf\b", verdict.sentence), verdict.sentence
    how_sure = r"a calculation with 50 digits confirms [\w ]+ to \d+ digits at 72 positions of the drive"
    figures = re.findall(r"(?<![\w.])\d[\d.]*", re.sub(how_sure, "", verdict.sentence).partition("All ")[0])
    assert len(figures) <= 3, verdict.sentence
    assert verdict.sentence.endswith(".")
    return verdict


def test_they_agree(judge: Judge, reference: Reference) -> None:
    off = changed(commanded(reference), "P3.fx", 3.3e-5 * reference.scale["P3.fx"])
    judged = judge(off, reaction=1e-3, torque=1e-3)
    sentence = (
        "exudyn and stub agree with the closed form to 0.004 % in every channel;"
        " a calculation with 50 digits confirms the closed form to 14 digits at 72 positions of the drive."
        " All 2 tolerances are met."
    )
    assert judged.ok
    assert plain(judged.agreement) == Agreement(Word.agrees, sentence)


def test_one_that_is_wrong_is_named_with_channel_size_and_cause(judge: Judge, reference: Reference) -> None:
    motion = commanded(reference)
    wrong = {channel: motion[channel] * (1.25 if channel.startswith("P3.f") else 1.0) for channel in motion.samples}
    verdict = plain(judge(Motion(wrong)).agreement)
    assert verdict.word is Word.disagrees
    assert verdict.sentence.startswith("stub disagrees with the closed form by 25 % in P3.fx; likely cause: ")
    assert re.search(r"\. exudyn agrees with the closed form to \d+ digits in every channel\.$", verdict.sentence)


@sampled(1)
@pytest.mark.parametrize("name", ["infeed", "e", "nano"])
def test_a_cause_is_there_whatever_its_body_is_called(judge: Judge, reference: Reference, name: str) -> None:
    judged = judge(changed(commanded(reference), "P3.fx", 0.3 * reference.scale["P3.fx"]))
    vars(judged)["causes"] = {"stub": f"stub: {name}'s mass is 12 % too large"}
    assert f"; likely cause: {name}'s mass is 12 % too large. exudyn agrees " in judged.agreement.sentence


def test_a_missed_tolerance_is_a_disagreement(judge: Judge, reference: Reference) -> None:
    off = changed(commanded(reference), "P3.fx", 2e-3 * reference.scale["P3.fx"])
    judged = judge(off, reaction=1e-3)
    assert judged.verdicts["stub"][0] == "ok"
    verdict = plain(judged.agreement)
    assert verdict.word is Word.disagrees
    assert verdict.sentence.startswith("stub misses its reaction tolerance: off by 0.2 % in P3.fx")


@sampled(2)
@pytest.mark.parametrize(
    ("status", "why"),
    [
        (Status.unsupported, "stub cannot model this scene."),
        (Status.timed_out, "stub ran out of time."),
        (Status.diverged, "stub ran away."),
        (Status.not_converged, "stub did not converge."),
        (Status.jammed, "stub is held by its friction."),
        (Status.undetermined, "stub found more than one set of forces."),
    ],
)
def test_one_that_did_not_solve_it_leaves_a_part(judge: Judge, status: Status, why: str) -> None:
    verdict = plain(judge(Failure(status, "1e-300 too few")).agreement)
    assert verdict.word is Word.in_part
    assert verdict.sentence.startswith("exudyn agrees with the closed form to ")
    assert verdict.sentence.endswith(why)


def test_what_engines_cannot_model_is_no_failure_of_a_certified_scene(judge: Judge, reference: Reference) -> None:
    """One that ran out of time may be one; without 50 digits nothing is solved."""
    refused = judge(Failure(Status.unsupported, "no"), ("analytic", "stub"))
    verdict = plain(refused.agreement)
    assert verdict.word is Word.in_part
    assert verdict.sentence.startswith("stub cannot model this scene; a calculation with 50 digits confirms the closed")
    late = plain(judge(Failure(Status.timed_out, "no"), ("analytic", "stub")).agreement)
    assert late.word is Word.not_solved
    assert late.sentence.startswith("stub ran out of time; nothing else checks it; a calculation with 50 digits")
    unchecked = replace(refused, reference=replace(reference, floor=Floor({}, "not certified")))
    assert plain(unchecked.agreement).word is Word.not_solved
    assert plain(unchecked.agreement).sentence.startswith("stub cannot model this scene; nothing else checks it")


def test_an_engine_that_gives_the_drive_alone_confirms_nothing(judge: Judge, reference: Reference) -> None:
    """Though it has a reason for every channel that it leaves out; where the drive alone is asked for, that is all."""
    whole, own = commanded(reference), {"time", reference.scene.channels.drive.position}
    given = {channel: samples for channel, samples in whole.samples.items() if channel in own}
    motion = Motion(given, dict.fromkeys(whole.samples.keys() - own, "left out"))
    judged = judge(motion, ("analytic", "stub"))
    status, reason = judged.verdicts["stub"]
    assert status == "unsupported"
    assert reason == "it gives nothing but the time and the drive's position, so that there is nothing to compare"
    assert judged.agreement.sentence.startswith("stub gives nothing to compare; a calculation with 50 digits confirms")
    assert judged.missed == [f"stub: unsupported: {reason}"]
    run = replace(judged.measurements[1].run, status=Status.ok, reason="")
    asked = replace(SAMPLING, channels=frozenset(own))
    drive = assess(Standard(reference, asked, judged.explained), run)
    assert drive.run.status is Status.ok


def test_without_another_engine_nothing_agrees(judge: Judge, reference: Reference) -> None:
    refused = Failure(Status.unsupported, "no")
    alone = judge(refused, ("analytic",))
    assert plain(alone.agreement).word is Word.in_part  # by arbitrary precision
    unchecked = replace(alone, reference=replace(reference, floor=Floor({}, "not certified")))
    assert plain(unchecked.agreement).word is Word.not_solved


def test_a_reference_in_doubt_is_a_disagreement(judge: Judge, reference: Reference) -> None:
    judged = judge(commanded(reference))
    doubted = replace(reference, floor=replace(reference.floor, doubt="the core alone differs, suspect the core: 1e-3"))
    verdict = plain(replace(judged, reference=doubted).agreement)
    expected = "The closed form is not to be believed: the core alone differs, suspect the core."
    assert verdict == Agreement(Word.disagrees, expected)


def test_a_fault_let_through_is_no_agreement(judge: Judge, reference: Reference) -> None:
    judged = judge(commanded(reference))
    judged.let_through.append("P3.fx spoilt by 1e-3 is seen by no check")
    assert not judged.ok
    assert plain(judged.agreement).word is Word.in_part


def test_what_is_no_number_is_not_shown_as_one(judge: Judge, reference: Reference) -> None:
    judged = judge(commanded(reference))
    measured = judged.measurements[2]
    bad = replace(measured, run=replace(measured.run, status=Status.inconsistent))
    bad = replace(bad, errors=[row._replace(max=np.nan) for row in bad.errors])
    verdict = plain(replace(judged, measurements=[*judged.measurements[:2], bad]).agreement)
    assert verdict.word is Word.disagrees
    assert verdict.sentence.startswith("stub disagrees with the closed form in ")


def test_the_worst_error_is_that_of_the_tables(judge: Judge, reference: Reference) -> None:
    judged = judge(changed(commanded(reference), "P4.ay", 2e-3 * reference.scale["P4.ay"], row=18))
    core, _, stub = (worst_error(judged.scene, m) for m in judged.measurements)
    assert stub is not None
    assert stub.channel == "P4.ax"  # an error of a component is its vector's
    assert stub.size == pytest.approx(2e-3, rel=1e-6)
    assert stub.position == pytest.approx(np.pi / 2, rel=1e-12)
    assert core is not None
    assert core.size == max(reference.floor.by_channel.values())
    assert np.isnan(core.position)


def test_sizes_read_plainly() -> None:
    bounds = {3.3e-6: "0.0004 %", 9.99e-6: "0.001 %", 1e-6: "0.0001 %", 8.5e-8: "7 digits", 0.0: "15 digits"}
    assert {size: within(size) for size in bounds} == bounds
    sizes = {0.0314: "3.1 %", 0.25: "25 %", 1.0: "100 %", 1e-7: "less than 0.0001 %", 1e30: "more than 1000 %"}
    assert {size: sized(size) for size in sizes} == sizes


def test_one_call_has_verdict_and_numbers() -> None:
    result = compare.check("four_bar", engines=("analytic", "exudyn"), samples=72)
    assert result.agreement.word == "agrees"
    assert {"stroke", "peak driving torque"} <= {peak.name for peak in result.peaks}


def test_what_no_other_engine_gives_is_not_confirmed(judge: Judge, reference: Reference) -> None:
    """By an engine that finds points alone."""
    motion = commanded(reference)
    given = {channel: values for channel, values in motion.samples.items() if named(channel).name not in ("fx", "fy")}
    points = Motion(given, dict.fromkeys(motion.samples.keys() - given.keys(), "it finds no forces"))
    verdict = plain(judge(points, ("analytic", "stub")).agreement)
    assert verdict.word is Word.in_part
    assert verdict.sentence.startswith("stub agrees with the closed form to 14 digits in every channel that it gives; ")
    assert verdict.sentence.endswith(" No other engine that is ok gives O.fx, among others.")
    both = plain(judge(points).agreement)
    assert both.word is Word.agrees
    assert both.sentence.startswith("exudyn and stub agree with the closed form to ")
    assert "in every channel that each gives; " in both.sentence


def test_a_rejected_engine_has_no_part_in_what_the_engines_differ_by(judge: Judge, reference: Reference) -> None:
    """On the page; the tables have by how much it does."""
    judged = judge(changed(commanded(reference), "P3.fx", 0.3 * reference.scale["P3.fx"]))
    study = Study.of(judged)
    assert {engine for peak in study.peaks for engine in peak.differs} == {"exudyn", "stub"}
    assert {engine for peak in of_ok(study) for engine in peak.differs} == {"exudyn"}
    assert "stub" not in "".join(answer.each for some in answers(study.scene, of_ok(study), {}) for answer in some)
