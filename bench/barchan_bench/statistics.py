"""Errors of means of series whose neighbours follow each other."""

import numpy


def autocorrelation_time(values):
    """Integrated autocorrelation time of a series, in its steps, 1 for independent values: 1 + 2 sum rho(k), up to the first lag k that is five times
    the sum so far (Madras & Sokal 1988, J. Stat. Phys. 50, 109, window with c = 5). A series of fewer than ten such times gives too small a value."""
    x = numpy.asarray(values, float)
    x = x - x.mean()
    variance = (x * x).mean()
    if len(x) < 2 or variance == 0:
        return 1.
    total = 1.
    for lag in range(1, len(x)):
        total += 2 * (x[:-lag] * x[lag:]).sum() / len(x) / variance
        if lag >= 5 * total:
            break
    return max(float(total), 1.)


def error_of_mean(values):
    """Standard error of the mean of a series, and how many independent values it has: s sqrt(tau/n), n/tau."""
    x = numpy.asarray(values, float)
    tau = autocorrelation_time(x)
    independent = max(len(x) / tau, 1.)
    return float(x.std(ddof=1) / numpy.sqrt(independent)) if len(x) > 1 else float("nan"), float(independent)
