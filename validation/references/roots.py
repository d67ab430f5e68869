"""The first zero of a polynomial on (0, 1] that starts positive, found by Bernstein subdivision: no crossing is missed."""
from functools import lru_cache
from math import comb
from operator import mul

from mpmath import mp, mpf


@lru_cache(maxsize=None)
def weights(n):
    """Row i: the weights C(i,k)/C(n,k) that make Bernstein coefficient i out of the coefficients k <= i."""
    return [[comb(i, k) / comb(n, k) for k in range(i + 1)] for i in range(n + 1)]


def bernstein(a):
    n = len(a) - 1
    return [sum((a[k] * comb(i, k) / comb(n, k) for k in range(i + 1)), mpf(0)) for i in range(n + 1)]


def surely_positive(a):
    """In double precision with a margin far above its rounding; a holds integers and is scaled by its largest."""
    size = max(abs(x) for x in a)
    f = [x / size for x in a]
    while len(f) > 1 and abs(f[-1]) < 1e-18:
        f.pop()
    margin = 1e-11 * sum(map(abs, f)) + 1e-14
    if f[0] + sum(x for x in f[1:] if x < 0) > margin:
        return True
    return f[-1] + sum(f[:-1]) > margin and all(sum(map(mul, row, f)) > margin for row in weights(len(f) - 1))


def split(b):
    left, right, row = [b[0]], [b[-1]], list(b)
    while len(row) > 1:
        row = [(x + y) / 2 for x, y in zip(row, row[1:])]
        left.append(row[0])
        right.append(row[-1])
    return left, right[::-1]


def evaluate(a, s):
    out = mpf(0)
    for x in reversed(a):
        out = out * s + x
    return out


def bracketed(a, low, high):
    """The one zero between low (positive) and high (negative): Newton steps that fall back to halving."""
    slope = [k * x for k, x in enumerate(a)][1:]
    s = (low + high) / 2
    for _ in range(40 * mp.dps):
        value = evaluate(a, s)
        if value > 0:
            low = s
        else:
            high = s
        steepness = evaluate(slope, s)
        step = s - value / steepness if steepness else low
        if not low <= step <= high:
            step = (low + high) / 2
        if abs(step - s) <= mpf(10) ** (2 - mp.dps) * max(abs(step), mpf(10) ** (-mp.dps)):
            return step
        s = step
    return s


def first_zero(a, noise):
    """None, or the first s in (0, 1] where a (positive right of 0) becomes negative; |a| <= noise counts as zero.

    A minimum within noise of zero is a touch, not a crossing."""
    if surely_positive(a):
        return None
    a = [mpf(x) for x in a]
    stack = [(bernstein(a), mpf(0), mpf(1), 0)]
    while stack:
        b, low, high, depth = stack.pop()
        if min(b) > -noise:
            continue
        signs = [1 if x > 0 else -1 for x in b]
        changes = sum(1 for x, y in zip(signs, signs[1:]) if x != y)
        if changes == 1 and b[0] > noise and b[-1] < -noise:
            return bracketed(a, low, high)
        if depth > 4 * mp.dps:
            return low
        middle = (low + high) / 2
        left, right = split(b)
        stack += [(right, middle, high, depth + 1), (left, low, middle, depth + 1)]
    return None
