"""The drawer of `tests/scenes`: its link pulls with P, a lever e beside its first point, against a load Q there.

Nothing weighs anything. The guide has no force but the moment e P, which its contact of a length L holds by 2 e |P| / L
at both ends: P = Q + c |P| with c = 2 mu e / L. A contact has no solution from c = 1 on, or two.
"""

from math import inf, tanh

Q, LEVER, MU, LENGTH, SPEED = 20.0, 0.1, 0.3, 0.15, 0.4  # N, m, its coefficient, m, m/s
CRITICAL = LENGTH / (2 * LEVER)  # the coefficient with c = 1


def pull(
    coefficient: float = MU, load: float = Q, *, length: float = LENGTH, viscous: float = 0.0, smooth: float = 0.0
) -> float:
    """P of a load against the motion, N, or of one along it, which is negative; infinite where friction holds it.

    A film adds its part to Q, by the speed. A smooth sense is tanh(speed / smooth) of the coefficient.
    """
    c = 2 * coefficient * LEVER / length * (tanh(SPEED / smooth) if smooth else 1.0)
    against = load + viscous * SPEED
    if against < 0:
        return against / (1 + c)
    return against / (1 - c) if c < 1 else inf
