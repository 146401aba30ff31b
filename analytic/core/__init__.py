"""The formulas: dyads in closed form, larger groups by Newton's method, kinematics, kinetostatics."""
