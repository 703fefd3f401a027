"""Geometry through gmsh: .geo, STEP, BREP, IGES."""

import numpy as np

from xmpm_prep.curved import ORDER, flux_through, read_curved
from xmpm_prep.errors import FILES, PrepError
from xmpm_prep.gmsh_session import gmsh_session, open_in_gmsh
from xmpm_prep.model import Body, Model, split_name
from xmpm_prep.read_mesh import gmsh_cells, model_of_mesh, physical_name
from xmpm_prep.step_unit import step_unit
from xmpm_prep.surface import is_consistent, turn_outward

CLOSE = 2.5e-4  # volume between the surface and its triangles over all
SEGMENTS = 20  # curved ones of a full circle
MOST_SPLIT = 40  # of a curved segment into straight ones
SAGITTA = 0.01  # most distance of triangles from the surface, in cells
SURFACE_OPTIONS = {  # of gmsh: sizes by curvature alone
    "Algorithm": 1,  # MeshAdapt: the others choose other triangles where rounding differs
    "MeshSizeFromCurvature": SEGMENTS,
    "MeshSizeFromPoints": 0,
    "MeshSizeExtendFromBoundary": 0,
    "MeshSizeMin": 0,
    "MeshSizeMax": 1e22,
    "MeshSizeFactor": 1,
    "ElementOrder": 1,
    "RecombineAll": 0,
    "SubdivisionAlgorithm": 0,
}
OCC_UNITS = {"m": "M", "mm": "MM", "cm": "CM", "um": "UM", "km": "KM", "in": "INCH", "ft": "FT"}


def read(path, cell, mesh_size, all_faces):
    """Bodies of a geometry file, with surface triangles or with a volume mesh."""
    unit = step_unit(path) if path.suffix.lower() in (".step", ".stp") else None
    with gmsh_session() as gmsh:
        if unit in OCC_UNITS:  # gmsh would turn everything into millimetres
            gmsh.option.setString("Geometry.OCCTargetUnit", OCC_UNITS[unit])
        gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
        open_in_gmsh(gmsh, path)
        gmsh.model.occ.synchronize()
        if not gmsh.model.getEntities(3):
            found = "surfaces only" if gmsh.model.getEntities(2) else "no volume"
            raise PrepError(f"{path}: the geometry has {found}; particles need a volume", FILES)
        bodies, left_out = name_bodies(gmsh, path)
        sets = name_sets(gmsh, all_faces)
        if mesh_size:
            model = _mesh_volumes(gmsh, path, bodies, sets, mesh_size)
        else:
            model = _mesh_surfaces(gmsh, path, bodies, sets, cell)
        model.unit = unit
        if left_out:
            model.notes.append(f"{left_out} volumes have no physical name and are left out")
        return model


def name_bodies(gmsh, path):
    """Volumes of each body name: physical groups, else labels of the file, else one body."""
    entities = [tag for _, tag in gmsh.model.getEntities(3)]
    groups = gmsh.model.getPhysicalGroups(3)
    bodies = {}
    if groups:
        for _, group in groups:
            name = physical_name(gmsh, 3, group)
            bodies.setdefault(name, set()).update(
                map(int, gmsh.model.getEntitiesForPhysicalGroup(3, group))
            )
        _check_shared(path, bodies)
        return bodies, len(set(entities).difference(*bodies.values()))
    labels = [gmsh.model.getEntityName(3, tag).rpartition("/")[2] for tag in entities]
    if len(entities) > 1 and all(labels) and len(set(labels)) == len(labels):
        return {label: {tag} for label, tag in zip(labels, entities, strict=True)}, 0
    return {path.stem: set(entities)}, 0


def _check_shared(path, bodies):
    names = list(bodies)
    for i, one in enumerate(names):
        for two in names[i + 1 :]:
            if bodies[one] & bodies[two]:
                raise PrepError(
                    f"{path}: the physical volumes '{one}' and '{two}' share a volume, which would "
                    "be filled twice"
                )


def name_sets(gmsh, all_faces):
    """Surfaces of each set name; with `all_faces` also one set a surface."""
    sets = {}
    for _, group in gmsh.model.getPhysicalGroups(2):
        name = physical_name(gmsh, 2, group)
        sets.setdefault(name, set()).update(
            map(int, gmsh.model.getEntitiesForPhysicalGroup(2, group))
        )
    for _, tag in gmsh.model.getEntities(2):
        label = gmsh.model.getEntityName(2, tag).rpartition("/")[2]
        if label and label not in sets:
            sets[label] = {tag}
        if all_faces:
            sets[f"surface_{tag}"] = {tag}
    return sets


# --- triangles on the surfaces ------------------------------------------------------------------


def _mesh_surfaces(gmsh, path, bodies, sets, cell):
    """Triangles fine enough for the volume, and the volume of the geometry itself."""
    for name, value in SURFACE_OPTIONS.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.model.mesh.removeConstraints()
    for field in gmsh.model.mesh.field.list():
        gmsh.model.mesh.field.remove(field)
    if set(gmsh.model.getEntities(1)) - set(gmsh.model.occ.getEntities(1)):
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", _uniform_size(gmsh))
    gmsh.model.mesh.clear()
    gmsh.model.mesh.generate(2)
    curved = read_curved(gmsh)
    split = _split_for(gmsh, cell)
    volumes = None
    while True:
        model = _collect(gmsh, path, bodies, sets, *curved.triangles(split))
        volumes = volumes or _true_volumes(gmsh, model, bodies)
        for body, volume in zip(model.bodies, volumes, strict=True):
            body.volume = volume
        worst = max(abs(model.enclosed(b) / b.volume - 1) for b in model.bodies)
        if worst <= CLOSE or split >= MOST_SPLIT:
            return model
        split = min(MOST_SPLIT, int(np.ceil(split * max(1.2, np.sqrt(1.2 * worst / CLOSE)))))


def _uniform_size(gmsh):
    """One size for all curves, by the smallest radius, for gmsh's own geometry.

    There gmsh 4.15 does not come back from meshing a circle whose size is from curvature alone.
    """
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    diagonal = float(np.linalg.norm(high - low))
    size = diagonal
    for _, tag in gmsh.model.getEntities(1):
        first, last = gmsh.model.getParametrizationBounds(1, tag)
        places = np.linspace(first[0], last[0], 9)[1:-1]
        curvature = np.max(gmsh.model.getCurvature(1, tag, places))
        if curvature > 1e-6 / diagonal:
            size = min(size, 2 * np.pi / SEGMENTS / curvature)
    return max(size, diagonal / 300)


def _split_for(gmsh, cell):
    """Into how many an edge is split, for the largest circle to be close to its triangles."""
    if not cell:
        return 4
    box = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    radius = np.linalg.norm(box[1] - box[0]) / 4
    segments = np.pi / np.sqrt(2 * SAGITTA * cell / radius)
    return int(np.clip(np.ceil(segments / SEGMENTS), 4, MOST_SPLIT // 2))


def _collect(gmsh, path, bodies, sets, points, on_surface):
    model = Model(path, points, [])
    for name, volumes in bodies.items():
        sides = _sides(gmsh, volumes)
        rows = [on_surface[tag][:, ::sign] for tag, sign in sides]
        owner = np.repeat([tag for tag, _ in sides], [len(some) for some in rows])
        triangles = np.concatenate(rows)
        if not is_consistent(triangles):
            triangles, _ = turn_outward(points, triangles)
        own = {
            set_name: np.flatnonzero(np.isin(owner, list(surfaces)))
            for set_name, surfaces in sets.items()
            if surfaces & {tag for tag, _ in sides}
        }
        body = Body(*split_name(name), triangles, own)
        if model.enclosed(body) < 0:
            body.triangles = triangles[:, ::-1]
        model.bodies.append(body)
    return model


def _sides(gmsh, volumes):
    """Outer surfaces of volumes with their signs; a surface between two of them is none."""
    sides = []
    for volume in sorted(volumes):
        sides += gmsh.model.getBoundary([(3, volume)], combined=False, oriented=True)
    signed = [(abs(tag), 1 if tag > 0 else -1) for _, tag in sides]
    count = {}
    for tag, _ in signed:
        count[tag] = count.get(tag, 0) + 1
    return [(tag, sign) for tag, sign in signed if count[tag] == 1]


def _true_volumes(gmsh, model, bodies):
    """Volumes of the geometry: by OpenCASCADE, or by integrals over curved triangles."""
    known = {tag for _, tag in gmsh.model.occ.getEntities(3)}
    result = []
    for body, volumes in zip(model.bodies, bodies.values(), strict=True):
        if volumes <= known:
            result.append(sum(gmsh.model.occ.getMass(3, tag) for tag in volumes))
            continue
        volume = abs(sum(sign * flux_through(gmsh, tag) for tag, sign in _sides(gmsh, volumes)))
        near = model.enclosed(body)  # gmsh's signs of surfaces may not agree
        result.append(volume if abs(volume / near - 1) < 0.05 else near)
    return result


# --- volume mesh ----------------------------------------------------------------------------------


def _mesh_volumes(gmsh, path, bodies, sets, size):
    """Tetrahedra (or what the .geo asks for) of about a size."""
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.ElementOrder", 1)
    gmsh.model.mesh.generate(3)
    model = model_of_mesh(path, *gmsh_cells(gmsh, bodies, sets))
    model.source = "geometry"
    if set(gmsh.model.getEntities(3)) - set(gmsh.model.occ.getEntities(3)):
        gmsh.model.mesh.setOrder(ORDER)
    for body, volume in zip(model.bodies, _true_volumes(gmsh, model, bodies), strict=True):
        body.volume = volume
    return model
