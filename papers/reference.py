"""Motions by the reference, which the claims are held against."""

from compare.engines import registry
from scenes import Motion, Sampling, Scene


def solved(scene: Scene, samples: int) -> Motion:
    """The motion of a scene over one cycle of its drive, with so many samples and its end."""
    sampling = Sampling(samples)
    return registry.reference(scene)(sampling.commanded(scene), sampling.times(scene))
