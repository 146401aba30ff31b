"""The vector-equation core: dyads in closed form, exact velocities and accelerations, kinetostatics."""

from .solve import solve

__all__ = ["solve"]
