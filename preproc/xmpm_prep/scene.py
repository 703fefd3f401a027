"""What `view` shows, as plain triangles and lines: bodies, sets, cracks, fronts, grid."""

from dataclasses import dataclass, field

import h5py
import numpy as np

from xmpm_prep.parts import pack, unpack

BODY_COLOURS = ("#8fa3b8", "#b8a88f", "#93b58f", "#ab93b8", "#b89393", "#8fb5b8")
SET_COLOURS = ("#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
CRACK_COLOUR, EDGE_COLOUR, FRONT_COLOUR, GRID_COLOUR = "#7b2d8b", "#3c1644", "#e10000", "#9a9a9a"
MOST_LINES = 60  # of the grid in a direction; of a finer one every second, fifth ... is shown
SIDES = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])
QUADS = np.array(  # corners of a unit cube on each side, outward
    [
        [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
        [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    ]
)


@dataclass
class Item:
    """Something of one colour: triangles, or lines where `cells` has two columns."""

    name: str
    kind: str  # body, set, crack, edges, front, grid
    points: np.ndarray  # (n,3)
    cells: np.ndarray  # (m,3) or (m,2)
    colour: str


@dataclass
class Scene:
    """All that is shown."""

    items: list[Item] = field(default_factory=list)
    unit: str = ""
    notes: list[str] = field(default_factory=list)

    def of_kind(self, *kinds):
        """Items of these kinds."""
        return [item for item in self.items if item.kind in kinds]

    def bounds(self):
        """Lowest and highest corner of everything but the grid."""
        shown = [item.points for item in self.items if item.kind != "grid" and len(item.points)]
        every = np.concatenate(shown)
        return every.min(axis=0), every.max(axis=0)


def add_particles(scene, cloud):
    """The cells that particles of a file fill, and the faces of its sets."""
    spacing, origin = _lattice_of(cloud)
    for number, name in enumerate(cloud.body_names):
        rows = np.flatnonzero(cloud.bodies == number)
        cells = np.floor((cloud.positions[rows] - origin) / spacing).astype(np.int64)
        filled, cell_of_row = np.unique(pack(cells), return_inverse=True)
        cells = unpack(filled)
        cell_of = np.full(len(cloud.volumes), -1)
        cell_of[rows] = cell_of_row.ravel()
        owner, side = _exposed(cells)
        taken = np.zeros(len(owner), bool)
        for set_name in cloud.sets:
            chosen = _in_set(cloud, set_name, cell_of, len(cells), owner, side) & ~taken
            taken |= chosen
            _add_faces(scene, f"set {set_name}", "set", cells, owner, side, chosen, spacing, origin)
        _add_faces(scene, f"body {name}", "body", cells, owner, side, ~taken, spacing, origin)
    scene.unit = cloud.unit


def _in_set(cloud, name, cell_of, count, owner, side):
    """Which faces belong to a set: of cells with its particles, and along their areas."""
    members = cell_of[cloud.sets[name]]
    here = members >= 0
    found = np.zeros(count, bool)
    found[members[here]] = True
    if name not in cloud.loaded:
        return found[owner]
    area = np.zeros((count, 3))
    np.add.at(area, members[here], _areas(cloud, name)[here])
    along = np.einsum("ij,ij->i", area[owner], SIDES[side])
    return found[owner] & (along > 0.3 * np.linalg.norm(area[owner], axis=1))


def _areas(cloud, name):
    with h5py.File(cloud.path, "r") as file:
        return file[f"sets/{name}/areas"][()]


def _lattice_of(cloud):
    """Edge of the cells to draw, and a corner of one: sub-cells of a lattice, else the grid's."""
    origin = np.asarray(cloud.attributes.get("origin", (0, 0, 0)), float)
    if "cell_size" not in cloud.attributes:
        return float(np.cbrt(np.quantile(cloud.volumes, 0.9))) * 1.3, origin
    size = float(cloud.attributes["cell_size"])
    if cloud.attributes.get("way") == "lattice":
        size /= int(cloud.attributes.get("per_cell", 1))
    return size, origin


def _exposed(cells):
    """Sides of filled cells that no other shares: a row of `cells`, number of the side."""
    low = cells.min(axis=0) - 1
    extent = np.ptp(cells, axis=0) + 3
    strides = np.array([1, extent[0], extent[0] * extent[1]])
    key = (cells - low) @ strides
    first = np.argsort(key)
    filled = key[first]
    owners, sides = [], []
    for number, step in enumerate(SIDES):
        beyond = filled + step @ strides
        at = np.minimum(np.searchsorted(filled, beyond), len(filled) - 1)
        free = first[filled[at] != beyond]
        owners.append(free)
        sides.append(np.full(len(free), number))
    return np.concatenate(owners), np.concatenate(sides)


def _add_faces(scene, name, kind, cells, owner, side, chosen, spacing, origin):
    corners = (cells[owner[chosen], None] + QUADS[side[chosen]]).reshape(-1, 3)
    if len(corners) == 0:
        return
    corners, number = np.unique(corners, axis=0, return_inverse=True)
    quads = number.reshape(-1, 4)
    cells = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    colours = BODY_COLOURS if kind == "body" else SET_COLOURS
    same = [item for item in scene.of_kind(kind) if item.name == name]
    count = len({item.name for item in scene.of_kind(kind)})
    colour = same[0].colour if same else colours[count % len(colours)]
    scene.items.append(Item(name, kind, origin + spacing * corners, cells, colour))


def add_crack(scene, path):
    """A crack surface with the edges of its triangles, and its fronts where the file has them."""
    with h5py.File(path, "r") as file:
        points = file["vertices"][()].astype(float)
        triangles = file["triangles"][()].astype(np.int64)
        front = file["front_edges"][()] if "front_edges" in file else np.zeros((0, 2), np.int64)
        unit = str(file.attrs.get("length_unit", ""))
    if scene.unit and unit != scene.unit:
        scene.notes.append(f"{path} is in {unit}, the others in {scene.unit}")
    scene.unit = scene.unit or unit
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, ::2]]))
    name = f"crack {path.stem}"
    scene.items.append(Item(name, "crack", points, triangles, CRACK_COLOUR))
    scene.items.append(Item(name, "edges", points, np.unique(edges, axis=0), EDGE_COLOUR))
    if len(front):
        scene.items.append(Item(f"front of {path.stem}", "front", points, front, FRONT_COLOUR))


def add_grid(scene, size, origin):
    """Lines of the grid on the sides of the box around everything that the first view looks at."""
    low, high = scene.bounds()
    first = np.floor((low - origin) / size - 1e-9)
    last = np.ceil((high - origin) / size + 1e-9)
    step = next(
        s for s in (1, 2, 5, 10, 20, 50, 100, 1000, 10**6) if max(last - first) / s <= MOST_LINES
    )
    first, last = np.floor(first / step) * step, np.ceil(last / step) * step
    ends = []
    for normal in range(3):
        a, b = (normal + 1) % 3, (normal + 2) % 3
        for along, across in ((a, b), (b, a)):
            for place in np.arange(first[across], last[across] + step / 2, step):
                line = np.tile(first, (2, 1))
                line[:, across] = place
                line[1, along] = last[along]
                if normal == 1:
                    line[:, 1] = last[1]
                ends.append(line)
    points = origin + size * np.concatenate(ends)
    lines = np.arange(len(points)).reshape(-1, 2)
    name = "grid" if step == 1 else f"grid, every {step} cells"
    scene.items.append(Item(f"{name} of {size:g}", "grid", points, lines, GRID_COLOUR))
