"""Compiled surface of two parameters in RGB, and the point of it nearest to a colour.

The surface is a table of uniform cubic B-splines (m + 3, n + 3, 3) over cells x ∈ [0, m],
y ∈ [0, n] (see `kubelka_munk.py`).
"""

from typing import Any

from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 1024
"""Texels that a thread works on at a time."""
ITERATIONS = 60
"""Most Newton steps, refused ones included."""
CONVERGED = 1e-6
"""Step, in cells, that ends the search."""


@compiled(inline=True)
def _weights(f: Any) -> Any:
    """Cubic B-spline weights at fraction f of a cell, and their first and second derivatives."""
    g = 1.0 - f
    return (
        (g * g * g / 6, 2 / 3 - f * f * (1 - f / 2), 2 / 3 - g * g * (1 - g / 2), f * f * f / 6),
        (-g * g / 2, f * (1.5 * f - 2), -g * (1.5 * g - 2), f * f / 2),
        (g, 3 * f - 2, 3 * g - 2, f),
    )


@compiled(inline=True)
def _cell(x: Any, count: Any) -> Any:
    """Index of the cell that x ∈ [0, count − 3] falls in."""
    return min(int(x), count - 4)


@compiled()
def _terms(table: Any, x: Any, y: Any, colour: Any) -> Any:
    """Cost ½ |f − c|², its gradient and Hessian, and those of the Hessian's terms JᵀJ."""
    i, j = _cell(x, table.shape[0]), _cell(y, table.shape[1])
    wx, wy = _weights(x - i), _weights(y - j)
    cost, gx, gy = 0.0, 0.0, 0.0
    hxx, hxy, hyy, jxx, jxy, jyy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(3):
        f, fx, fy, fxx, fxy, fyy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for p in range(4):
            s0, s1, s2 = 0.0, 0.0, 0.0
            for q in range(4):
                node = table[i + p, j + q, c]
                s0 += wy[0][q] * node
                s1 += wy[1][q] * node
                s2 += wy[2][q] * node
            f += wx[0][p] * s0
            fx += wx[1][p] * s0
            fxx += wx[2][p] * s0
            fy += wx[0][p] * s1
            fxy += wx[1][p] * s1
            fyy += wx[0][p] * s2
        r = f - colour[c]
        cost += 0.5 * r * r
        gx += r * fx
        gy += r * fy
        jxx += fx * fx
        jxy += fx * fy
        jyy += fy * fy
        hxx += r * fxx
        hxy += r * fxy
        hyy += r * fyy
    return cost, (gx, gy), (jxx + hxx, jxy + hxy, jyy + hyy), (jxx, jxy, jyy)


@compiled(inline=True)
def _step(g: Any, h: Any, free_x: Any, free_y: Any, damping: Any) -> Any:
    """Damped Newton step along the free axes, and whether h is positive definite on them."""
    a, b, d = h[0] * (1 + damping), h[1], h[2] * (1 + damping)
    if free_x and free_y:
        determinant = a * d - b * b
        if a <= 0 or determinant <= 1e-12 * a * d:
            return 0.0, 0.0, False
        return (b * g[1] - d * g[0]) / determinant, (b * g[0] - a * g[1]) / determinant, True
    if free_x:
        return (-g[0] / a, 0.0, True) if a > 0 else (0.0, 0.0, False)
    return (0.0, -g[1] / d, True) if d > 0 else (0.0, 0.0, False)


@compiled()
def _descend(table: Any, colour: Any, x: Any, y: Any) -> Any:
    """The nearest point downhill from (x, y): Newton with bounds, damped when it does not help."""
    m, n = table.shape[0] - 3.0, table.shape[1] - 3.0
    damping = 0.0
    cost, g, h, jj = _terms(table, x, y, colour)
    for _ in range(ITERATIONS):
        free_x = not ((x <= 0 and g[0] >= 0) or (x >= m and g[0] <= 0))
        free_y = not ((y <= 0 and g[1] >= 0) or (y >= n and g[1] <= 0))
        if not (free_x or free_y):
            break
        dx, dy, convex = _step(g, h, free_x, free_y, damping)
        if not convex:  # far from the surface its curvature outweighs JᵀJ
            dx, dy, convex = _step(g, jj, free_x, free_y, max(damping, 1e-9))
        new_x, new_y = min(max(x + dx, 0.0), m), min(max(y + dy, 0.0), n)
        moved = max(abs(new_x - x), abs(new_y - y))
        if moved == 0:
            break
        trial = _terms(table, new_x, new_y, colour)
        if trial[0] <= cost:
            x, y, damping = new_x, new_y, damping * 0.1 if damping > 1e-6 else 0.0
            cost, g, h, jj = trial
        else:
            damping = max(damping * 10, 1e-3)
        if moved < CONVERGED:
            break
    return x, y


@on_all_cores(PIECE)
def nearest_point_kernel(start: Any, stop: Any, colours: Any, table: Any, cells: Any) -> None:
    """Moves cells (n, 2) to the point of the surface nearest to each colour (n, 3)."""
    for row in range(start, stop):
        cells[row, 0], cells[row, 1] = _descend(table, colours[row], cells[row, 0], cells[row, 1])


@compiled()
def _value(table: Any, x: Any, y: Any, c: Any) -> Any:
    """Channel c of the surface at cell coordinates (x, y)."""
    i, j = _cell(x, table.shape[0]), _cell(y, table.shape[1])
    wx, wy = _weights(x - i)[0], _weights(y - j)[0]
    total = 0.0
    for p in range(4):
        for q in range(4):
            total += wx[p] * wy[q] * table[i + p, j + q, c]
    return total


@on_all_cores(PIECE)
def surface_kernel(start: Any, stop: Any, cells: Any, table: Any, out: Any) -> None:
    """Fills out (n, 3) with the colours of the surface at cells (n, 2)."""
    for row in range(start, stop):
        for c in range(3):
            out[row, c] = _value(table, cells[row, 0], cells[row, 1], c)
