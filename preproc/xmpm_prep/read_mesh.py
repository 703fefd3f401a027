"""Volume meshes through gmsh (.msh) and meshio (all others), and closed surfaces."""

import contextlib
import io

import numpy as np

from xmpm_prep.elements import (
    CORNERS,
    corner_count,
    element_volumes,
    match_faces,
    middle_nodes,
    outer_faces,
    right_way_round,
    to_tetrahedra,
    triangulate,
)
from xmpm_prep.errors import FILES, PrepError
from xmpm_prep.gmsh_session import gmsh_session, open_in_gmsh
from xmpm_prep.model import Body, Model, split_name
from xmpm_prep.surface import check_closed, turn_outward, weld

FLAT = {"triangle": 3, "quad": 4}  # corners of flat elements, of any order
SURFACES = {".stl", ".off", ".ply", ".obj", ".vtk", ".vtp", ".vtu", ".wrl"}
WELD = 1e-6  # corners of triangles nearer than this part of the model are one
COUNT = {kind: corners for corners, kind in CORNERS.items()}
TAGS = ("gmsh:physical", "medit:ref", "cell_tags", "material", "region", "CellEntityIds")


def physical_name(gmsh, dimension, group):
    """Name of a physical group, made from its number where it has none."""
    name = gmsh.model.getPhysicalName(dimension, group).strip()
    return name or f"{'body' if dimension == 3 else 'surface'}_{group}"


# --- .msh -----------------------------------------------------------------------------------------


def read_msh(path):
    """A mesh of gmsh, any version of the format."""
    with gmsh_session() as gmsh:
        open_in_gmsh(gmsh, path)
        if len(gmsh.model.mesh.getElementTypes(3)) == 0:
            raise PrepError(f"{path}: the mesh has no volume elements", FILES)
        bodies, sets = {}, {}
        for found, dimension in ((bodies, 3), (sets, 2)):
            for _, group in gmsh.model.getPhysicalGroups(dimension):
                name = physical_name(gmsh, dimension, group)
                entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, group)
                found.setdefault(name, set()).update(map(int, entities))
        if not bodies:
            bodies = {path.stem: {tag for _, tag in gmsh.model.getEntities(3)}}
        points, cells, faces = gmsh_cells(gmsh, bodies, sets)
    return model_of_mesh(path, points, cells, faces)


def gmsh_cells(gmsh, bodies, sets):
    """Nodes, volume elements of each body, and faces of each set, out of gmsh."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    tags = tags[order]
    cells = {
        name: [block for entity in sorted(some) for block in _elements(gmsh, 3, entity, tags)]
        for name, some in bodies.items()
    }
    faces = {
        name: [ids for entity in sorted(some) for _, ids in _elements(gmsh, 2, entity, tags)]
        for name, some in sets.items()
    }
    return coordinates.reshape(-1, 3)[order], cells, faces


def _elements(gmsh, dimension, entity, tags):
    for kind, _, nodes in zip(*gmsh.model.mesh.getElements(dimension, entity), strict=True):
        _, _, _, count, _, corners = gmsh.model.mesh.getElementProperties(kind)
        ids = np.searchsorted(tags, nodes.reshape(-1, count))
        if dimension == 3 and count == 10 and corners == 4:
            yield (
                "tetra",
                ids[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]],
            )  # as EDGES has them
        else:
            yield CORNERS.get(corners, "face") if dimension == 3 else "face", ids[:, :corners]


# --- formats of meshio ----------------------------------------------------------------------------


def read_any(path):
    """A mesh of any format that meshio reads: of volume elements, or a closed surface."""
    mesh = _meshio(path)
    points = np.asarray(mesh.points, float)
    points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    if not any(corner_count(block.type) for block in mesh.cells):
        if path.suffix.lower() in SURFACES and any(_flat(block.type) for block in mesh.cells):
            return _model_of_surface(path, points, _triangles(mesh))
        raise PrepError(f"{path}: the mesh has no volume elements", FILES)
    cells = {}
    names, groups = _groups(mesh, path, corner_count, "body")
    for block, group in zip(mesh.cells, groups, strict=True):
        corners = corner_count(block.type)
        width = 10 if block.type == "tetra10" else corners
        for number, name in enumerate(names if corners else ()):
            ids = np.asarray(block.data, np.int64)[group == number][:, :width]
            if len(ids):
                cells.setdefault(name, []).append((CORNERS[corners], ids))
    faces = {}
    names, groups = _groups(mesh, path, _flat, "surface")
    for block, group in zip(mesh.cells, groups, strict=True):
        for number, name in enumerate(names if _flat(block.type) else ()):
            ids = np.asarray(block.data, np.int64)[group == number][:, : _flat(block.type)]
            faces.setdefault(name, []).append(ids)
    return model_of_mesh(path, points, cells, faces)


def _meshio(path):
    import meshio

    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            return meshio.read(path)
    except (Exception, SystemExit) as failure:  # it has exceptions of every kind, and exits
        reason = " ".join(said.getvalue().split()) or str(failure) or type(failure).__name__
        raise PrepError(f"{path}: meshio cannot read it: {reason}", FILES) from None


def _flat(kind):
    return next((corners for name, corners in FLAT.items() if kind.startswith(name)), 0)


def _triangles(mesh):
    found = []
    for block in mesh.cells:
        ids = np.asarray(block.data, np.int64)
        if _flat(block.type):
            found.append(ids[:, :3])
        if _flat(block.type) == 4:
            found.append(ids[:, [0, 2, 3]])
    return np.concatenate(found)


def _groups(mesh, path, counts, word):
    """Names of groups, and for each block the group of its cells, -1 for none.

    Named sets of cells come first, else numbers of cells with the names that the file has for them,
    else all volume elements are one body.
    """
    groups = [np.full(len(block.data), -1) for block in mesh.cells]
    mine = [i for i, block in enumerate(mesh.cells) if counts(block.type)]
    names = []
    for name, blocks in mesh.cell_sets.items():
        rows = {i: np.asarray(blocks[i], int) for i in mine if blocks[i] is not None}
        if name.startswith("gmsh:") or not any(len(some) for some in rows.values()):
            continue
        for i, some in rows.items():
            groups[i][some] = len(names)
        names.append(name)
    key = next((key for key in TAGS if key in mesh.cell_data), None)
    if not names and key:
        tags = [np.asarray(values).astype(int) for values in mesh.cell_data[key]]
        known = _names_of_tags(mesh, key, 3 if word == "body" else 2)
        for tag in sorted({int(tag) for i in mine for tag in tags[i]} - {0}):
            for i in mine:
                groups[i][tags[i] == tag] = len(names)
            names.append(known.get(tag, f"{word}_{tag}"))
    if not names and word == "body":
        for i in mine:
            groups[i][:] = 0
        names = [path.stem]
    return names, groups


def _names_of_tags(mesh, key, dimension):
    if key == "cell_tags":  # MED
        return {tag: some[0] for tag, some in getattr(mesh, "cell_tags", {}).items() if some}
    return {
        int(value[0]): name
        for name, value in mesh.field_data.items()
        if len(value) > 1 and int(value[1]) == dimension
    }


# --- from elements to a model ---------------------------------------------------------------------


def model_of_mesh(path, points, cells, faces):
    """A model from volume elements `{body: [(kind, nodes)]}` and faces `{set: [corners]}`."""
    model = Model(path, points, [], source="mesh")
    for name, blocks in cells.items():
        blocks = [(kind, _right_way_round(path, name, points, kind, ids)) for kind, ids in blocks]
        if blocks:
            model.bodies.append(_body(model, name, blocks, faces))
    if not model.bodies:
        raise PrepError(f"{path}: the mesh has no volume elements", FILES)
    return model


def _right_way_round(path, name, points, kind, ids):
    """Elements none of which is inside out or flat; nodes on edges move with their corners."""
    corners = COUNT[kind]
    volume = element_volumes(points, kind, ids[:, :corners])
    edge = np.ptp(points[ids[:, :corners]], axis=1).max(axis=1)
    flat = np.abs(volume) <= 1e-12 * edge**3
    if flat.all() or np.any(edge == 0):
        raise PrepError(f"{path}: the mesh of '{name}' has elements without volume")
    ids = ids[~flat]
    if ids.shape[1] == corners:
        return right_way_round(points, kind, ids)
    wrong = volume[~flat] < 0
    ids = ids.copy()
    ids[wrong] = ids[wrong][:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    return ids


def _body(model, name, blocks, faces):
    tens = [ids for kind, ids in blocks if kind == "tetra" and ids.shape[1] == 10]
    edges, middles = middle_nodes(np.concatenate(tens)) if tens else (np.zeros((0, 2), int), None)
    outer = outer_faces([(kind, ids[:, : COUNT[kind]]) for kind, ids in blocks])
    triangles, face, model.points = triangulate(model.points, outer, edges, middles)
    body = Body(*split_name(name), triangles)
    for set_name, wanted in faces.items():
        rows = [match_faces(outer, some) for some in wanted if len(some)]
        rows = np.unique(np.concatenate(rows)) if rows else np.zeros(0, int)
        if len(rows):
            body.sets[set_name] = np.flatnonzero(np.isin(face, rows))
    body.volume = model.enclosed(body)
    tetra, hexa = [], []
    for kind, ids in blocks:
        if kind == "hexahedron":
            hexa.append(ids)
        else:
            tetra.append(to_tetrahedra(model.points, kind, ids))
    body.cells = {
        kind: np.concatenate(some)
        for kind, some in (("tetra", tetra), ("hexahedron", hexa))
        if some
    }
    return body


# --- closed surfaces ------------------------------------------------------------------------------


def read_surface(path):
    """A body from a closed surface of triangles (STL and the like)."""
    mesh = _meshio(path)
    if not any(_flat(block.type) for block in mesh.cells):
        raise PrepError(f"{path}: the file holds no triangles", FILES)
    return _model_of_surface(path, np.asarray(mesh.points, float), _triangles(mesh))


def _model_of_surface(path, points, triangles):
    if not np.isfinite(points[triangles]).all():
        raise PrepError(f"{path}: a corner of a triangle is not finite", FILES)
    points, triangles, _ = weld(points, triangles, WELD * np.ptp(points, axis=0).max())
    check_closed(points, triangles, path)
    triangles, turned = turn_outward(points, triangles)
    model = Model(path, points, [Body(*split_name(path.stem), triangles)], source="surface")
    model.bodies[0].volume = model.enclosed(model.bodies[0])
    size = np.ptp(points, axis=0)
    if not model.bodies[0].volume > 1e-9 * size.max() ** 3 * (size.min() / size.max()):
        raise PrepError(f"{path}: the surface encloses no volume")
    if turned:
        model.notes.append(f"{turned} triangles were turned round to face outward")
    return model
