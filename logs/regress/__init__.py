"""Regression of runs: simulated time exactly, work by counts, wall time by one number a run.

Statistics on pooled samples of wall time call most changes that are none; so what must hold is
compared in simulated time, where the same program gives the same numbers, and wall time is
compared by a test that keeps its promise (:mod:`logs.regress.wall`).
"""
