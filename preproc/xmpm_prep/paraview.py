"""What ParaView and meshio need to open our HDF5 files, without a second copy of the numbers.

A file NAME.h5 gets a group `VTKHDF` whose items are links to our own datasets. Beside it stand
NAME.vtkhdf, a link to that group, for ParaView, and NAME.xdmf, a description for meshio.
"""

from itertools import chain
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import h5py
import numpy as np


def companions(path):
    """Paths of the files beside a HDF5 file: for ParaView and for meshio."""
    path = Path(path)
    return path.with_suffix(".vtkhdf"), path.with_suffix(".xdmf")


def add_poly_data(file, points, vertices=(), lines=(), polygons=(), point_data=None):
    """Add a group VTKHDF to an open HDF5 file.

    `points` and the values of `point_data` are datasets of that file, which are linked, or arrays.
    `vertices`, `lines` and `polygons` are sequences of cells, each a sequence of point numbers.
    """
    group = file.create_group("VTKHDF", track_order=True)
    group.attrs["Version"] = [2, 2]
    group.attrs["Type"] = np.bytes_("PolyData")
    group["Points"] = points
    group["NumberOfPoints"] = [len(points)]
    cells = {"Vertices": vertices, "Lines": lines, "Polygons": polygons, "Strips": ()}
    for name, some in cells.items():
        part = group.create_group(name)
        some = np.asarray(some) if len({len(cell) for cell in some}) == 1 else list(some)
        lengths = [len(cell) for cell in some]
        ids = np.fromiter(chain.from_iterable(some), np.int64, sum(lengths))
        part["NumberOfCells"] = [len(lengths)]
        part["NumberOfConnectivityIds"] = [len(ids)]
        part["Connectivity"] = ids
        part["Offsets"] = np.cumsum([0, *lengths], dtype=np.int64)
    fields = group.create_group("PointData")
    for name, values in (point_data or {}).items():
        fields[name] = values


def write_vtkhdf_link(path, target):
    """A file for ParaView whose only item is the group VTKHDF of the file `target` beside it."""
    with h5py.File(path, "w") as file:
        file["VTKHDF"] = h5py.ExternalLink(Path(target).name, "/VTKHDF")


def write_xdmf(path, target, file, topology, cells, points, point_data, names=None):
    """A description for meshio of an HDF5 file that is open as `file` and will be called `target`.

    `topology` is Polyvertex or Triangle; `cells`, `points` and the values of `point_data` are names
    of datasets. `names` are texts that become meshio's field_data, numbered from 0.
    """

    def item(name):
        data = file[name]
        kind = {"f": "Float", "i": "Int", "u": "UInt"}[data.dtype.kind]
        return (
            f'<DataItem DataType="{kind}" Precision="{data.dtype.itemsize}" Format="HDF" '
            f'Dimensions="{" ".join(map(str, data.shape))}">'
            f"{escape(Path(target).name)}:{escape(data.name)}</DataItem>"
        )

    lines = [
        '<?xml version="1.0"?>',
        '<Xdmf Version="3.0"><Domain><Grid Name="Grid">',
        f'<Geometry GeometryType="XYZ">{item(points)}</Geometry>',
        f'<Topology TopologyType="{topology}" NumberOfElements="{len(file[cells])}"'
        f"{' NodesPerElement=' + chr(34) + '1' + chr(34) if topology == 'Polyvertex' else ''}>"
        f"{item(cells)}</Topology>",
    ]
    for name, data in point_data.items():
        kind = "Vector" if file[data].ndim == 2 else "Scalar"
        lines.append(
            f'<Attribute Name={quoteattr(name)} AttributeType="{kind}" Center="Node">'
            f"{item(data)}</Attribute>"
        )
    if names:
        inside = "".join(
            f'<map key={quoteattr(name)} dim="3">{number}</map>'
            for number, name in enumerate(names)
        )
        lines.append(f'<Information Name="bodies"><![CDATA[<main>{inside}</main>]]></Information>')
    lines.append("</Grid></Domain></Xdmf>\n")
    Path(path).write_text("\n".join(lines), encoding="utf-8")
