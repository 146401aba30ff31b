"""Many linkages: families that differ in some numbers, and machines drawn within their tolerances."""
