"""Subspaces of R^n in high precision: a subspace is a list of column vectors (lists of mpf).

Ranks are decided by Gaussian elimination with full pivoting and an absolute threshold on rows scaled to 1; with a
hundred digits carried and decks of at most fifteen decades of values, true zeros and true numbers lie tens of
decades apart.
"""
from mpmath import mp, mpf


def threshold():
    return mpf(10) ** (-mp.dps // 2)


def zeros(n):
    return [mpf(0)] * n


def apply(matrix, vector):
    """matrix: list of sparse rows {column: value}."""
    return [sum((a * vector[j] for j, a in row.items()), mpf(0)) for row in matrix]


def dot(a, b):
    return sum((x * y for x, y in zip(a, b) if x and y), mpf(0))


def reduce_rows(rows, columns):
    """Reduced row echelon form by full pivoting. Returns (pivots {column: row}) with unit pivots, zeros elsewhere."""
    tol, pivots = threshold(), {}
    rows = [{j: mpf(v) for j, v in row.items() if abs(v) > tol} for row in rows]  # else scaling would lift pure rounding to 1
    for row in rows:
        scale = max((abs(v) for j, v in row.items() if j < columns), default=mpf(0))
        if scale > 0:
            for j in row:
                row[j] /= scale
    active = list(range(len(rows)))
    while active:
        best, where = tol, None
        for r in active:
            for j, v in rows[r].items():
                if j < columns and abs(v) > best:
                    best, where = abs(v), (r, j)
        if where is None:
            break
        r, j = where
        active.remove(r)
        inverse = 1 / rows[r][j]
        pivot = {k: v * inverse for k, v in rows[r].items()}
        pivot[j] = mpf(1)
        for s in range(len(rows)):
            factor = rows[s].pop(j, None) if s != r else None
            if factor:
                target = rows[s]
                for k, v in pivot.items():
                    if k != j:
                        target[k] = target.get(k, mpf(0)) - factor * v
                        if abs(target[k]) < tol:
                            del target[k]
        rows[r] = pivot
        pivots[j] = r
    return {j: rows[r] for j, r in pivots.items()}, [rows[r] for r in active]


def rows_of(vectors, n):
    """The matrix whose columns are `vectors`, as sparse rows."""
    return [{j: v[i] for j, v in enumerate(vectors) if v[i]} for i in range(n)]


def null_space(rows, columns):
    pivots, _ = reduce_rows(rows, columns)
    basis = []
    for free in (j for j in range(columns) if j not in pivots):
        vector = zeros(columns)
        vector[free] = mpf(1)
        for j, row in pivots.items():
            vector[j] = -row.get(free, mpf(0))
        basis.append(vector)
    return basis


def orthonormal(vectors, against=()):
    """Orthonormal basis of the span of `vectors`, orthogonal to the orthonormal `against` (twice for safety)."""
    basis, tol = [], threshold()
    for vector in vectors:
        size = mp.sqrt(dot(vector, vector))
        if size == 0:
            continue
        w = [x / size for x in vector]
        for _ in range(2):
            for q in list(against) + basis:
                c = dot(q, w)
                if c:
                    w = [x - c * y for x, y in zip(w, q)]
        size = mp.sqrt(dot(w, w))
        if size > tol:
            basis.append([x / size for x in w])
    return basis


def combine(vectors, coefficients, n):
    out = zeros(n)
    for v, c in zip(vectors, coefficients):
        if c:
            out = [x + c * y for x, y in zip(out, v)]
    return out


def intersection(u, v, n):
    """Orthonormal basis of span u ∩ span v."""
    if not u or not v:
        return []
    kernel = null_space(rows_of(u + [[-x for x in w] for w in v], n), len(u) + len(v))
    return orthonormal([combine(u, k[:len(u)], n) for k in kernel])


class Solver:
    """Solves columns·c = b for many b; the columns need not be independent (dependent ones get 0)."""

    def __init__(self, columns, n):
        self.columns, self.n = columns, n
        m = len(columns)
        rows = rows_of(columns, n)
        for i, row in enumerate(rows):
            row[m + i] = mpf(1)
        self.pivots, self.rest = reduce_rows(rows, m)
        self.m = m

    def solve(self, b):
        """(coefficients, worst violation of the equations that have no unknown left, relative to max |b|)."""
        def image(row):
            return sum((v * b[k - self.m] for k, v in row.items() if k >= self.m), mpf(0))
        coefficients = zeros(self.m)
        for j, row in self.pivots.items():
            coefficients[j] = image(row)
        size = max((abs(x) for x in b), default=mpf(0))
        worst = max((abs(image(row)) for row in self.rest), default=mpf(0))
        return coefficients, (worst / size if size else mpf(0))
