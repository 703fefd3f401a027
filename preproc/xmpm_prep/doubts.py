"""What is nearly always a mistake: walls thinner than a cell, mixed units."""

import numpy as np

from xmpm_prep.surface import triangle_areas

SAMPLES = 800  # rays into a body
THIN_PART = 0.1  # of the surface that may have less than a cell behind it: edges, tips
MOST_CELLS = 3000  # along a body: more is a wrong unit rather than a fine grid
RATIO = 300  # sizes of bodies, or of a body and the distance between bodies


def wall_thickness(model, body):
    """Material behind points spread over the surface (n): lengths of rays against the normals."""
    import pyvista
    from vtkmodules.vtkCommonCore import mutable
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    corners = model.points[body.triangles]
    areas = triangle_areas(model.points, body.triangles)
    size = np.linalg.norm(areas, axis=1)
    generator = np.random.default_rng(1)
    stairs = np.cumsum(size)
    chosen = np.searchsorted(stairs, (np.arange(SAMPLES) + 0.5) / SAMPLES * stairs[-1])
    u, v = generator.random((2, SAMPLES))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    edges = corners[chosen, 1:] - corners[chosen, :1]
    start = corners[chosen, 0] + u[:, None] * edges[:, 0] + v[:, None] * edges[:, 1]
    inward = -areas[chosen] / size[chosen, None]
    length = np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0))
    faces = np.column_stack([np.full(len(corners), 3), body.triangles]).ravel()
    locator = vtkStaticCellLocator()
    locator.SetDataSet(pyvista.PolyData(model.points, faces))
    locator.BuildLocator()
    result = np.full(SAMPLES, np.inf)
    step = 1e-6 * length
    for i in range(SAMPLES):
        t, x, p, sub, cell = mutable(0.0), [0.0] * 3, [0.0] * 3, mutable(0), mutable(0)
        first, last = start[i] + step * inward[i], start[i] + length * inward[i]
        if locator.IntersectWithLine(first, last, 0.0, t, x, p, sub, cell):
            result[i] = np.linalg.norm(np.array(x) - start[i])
    return result


def thin_wall(model, body, h):
    """A complaint where a good part of the surface has less than a cell behind it, else None."""
    thickness = wall_thickness(model, body)
    thin = thickness < h * (1 - 1e-6)
    if thin.mean() <= THIN_PART:
        return None
    wall = np.quantile(thickness[thin], 0.5)
    return (
        f"{model.path}: the cell size --h {h:g} is larger than the wall of '{body.name}', which is "
        f"{wall:.4g} thick on {100 * thin.mean():.0f} % of its surface"
    )


def mixed_units(model, h, unit):
    """A complaint where sizes suggest that units were mixed, else None."""
    boxes = [
        (
            model.points[body.triangles].min(axis=(0, 1)),
            model.points[body.triangles].max(axis=(0, 1)),
        )
        for body in model.bodies
    ]
    sizes = np.array([np.linalg.norm(high - low) for low, high in boxes])
    for body, (low, high) in zip(model.bodies, boxes, strict=True):
        longest = np.max(high - low)
        if longest < h or longest > MOST_CELLS * h:
            word = "less than one cell" if longest < h else f"{longest / h:.0f} cells"
            return (
                f"{model.path}: '{body.name}' is {longest:.4g} {unit} long, {word} of --h {h:g}: "
                "mixed units suspected"
            )
    small, large = np.argmin(sizes), np.argmax(sizes)
    if sizes[large] > RATIO * sizes[small]:
        return (
            f"{model.path}: '{model.bodies[large].name}' is {sizes[large] / sizes[small]:.0f} "
            f"times as large as '{model.bodies[small].name}': mixed units suspected"
        )
    return None
