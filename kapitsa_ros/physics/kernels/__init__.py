"""Compiled inner loops: power series, roots of polynomials, and the rod's motion over one interval."""
