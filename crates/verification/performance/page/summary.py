"""Medians, spreads, ratios, slopes."""

import math
from statistics import median


def of(values):
    """Median and spread (largest less least)."""
    values = list(values)
    return median(values), max(values) - min(values)


def ratios(theirs, ours):
    """Ratios of runs of the same turn: median, least and largest."""
    pairs = [a / b for a, b in zip(theirs, ours)]
    return median(pairs), min(pairs), max(pairs)


def slope(points):
    """Slope of the straight line through log y over log x (least squares)."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    x, y = (sum(values) / len(logs) for values in zip(*logs))
    return sum((a - x) * (b - y) for a, b in logs) / sum((a - x) ** 2 for a, _ in logs)
