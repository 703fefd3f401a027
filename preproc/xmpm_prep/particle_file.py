"""Particle files: written as doc/particle_file.md of XMPM3D describes them, and read back."""

from dataclasses import dataclass

import h5py
import numpy as np

from xmpm_prep import __version__
from xmpm_prep.errors import FILES, PrepError
from xmpm_prep.files import input_file, whole_files
from xmpm_prep.paraview import add_poly_data, companions, write_vtkhdf_link, write_xdmf

FORMAT, VERSION = "xmpm3d particles", 1


@dataclass
class ParticleFile:
    """What a particle file holds."""

    path: object
    unit: str
    positions: np.ndarray
    volumes: np.ndarray
    bodies: np.ndarray  # index into body_names
    body_names: list[str]
    materials: list[str]  # one a body
    sets: dict[str, np.ndarray]  # particles of each
    loaded: list[str]  # sets with areas
    attributes: dict  # h, per_cell, origin and what else the file says of itself


def write_particles(path, bodies, clouds, unit, attributes):
    """Write the clouds of bodies; beside the file come what ParaView and meshio open."""
    link, description = companions(path)
    with whole_files(path, link, description) as (data, second, third):
        with h5py.File(data, "w") as file:
            file.attrs["format"] = FORMAT
            file.attrs["version"] = VERSION
            file.attrs["length_unit"] = unit
            file.attrs["made_by"] = f"xmpm-prep {__version__}"
            for name, value in attributes.items():
                file.attrs[name] = value
            _write_datasets(file, bodies, clouds)
            point_data = {"volumes": "volumes", "bodies": "bodies"}
            point_data |= {f"set {name}": f"paraview/set {name}" for name in file.get("sets", ())}
            add_poly_data(
                file,
                file["positions"],
                vertices=[range(len(file["positions"]))],
                point_data={name: file[place] for name, place in point_data.items()},
            )
            names = [body.name for body in bodies]
            write_xdmf(
                third, path, file, "Polyvertex", "paraview/vertices", "positions", point_data, names
            )
        write_vtkhdf_link(second, path)


def _write_datasets(file, bodies, clouds):
    counts = [len(cloud.volumes) for cloud in clouds]
    total = sum(counts)
    first = np.cumsum([0, *counts])
    file["positions"] = np.concatenate([cloud.positions for cloud in clouds])
    file["volumes"] = np.concatenate([cloud.volumes for cloud in clouds])
    file["bodies"] = np.repeat(np.arange(len(bodies), dtype=np.int32), counts)
    file["body_names"] = [body.name for body in bodies]
    file["body_materials"] = [body.material for body in bodies]
    packed = {"compression": "gzip", "shuffle": True} if total else {}
    vertices = np.arange(total)[:, None]
    file.create_dataset("paraview/vertices", data=vertices, **packed)
    for name in sorted({name for cloud in clouds for name in cloud.sets}):
        mine = [
            (start, cloud.sets[name])
            for start, cloud in zip(first, clouds, strict=False)
            if name in cloud.sets
        ]
        group = file.create_group(f"sets/{name}")
        group["particles"] = np.concatenate([start + patch.particles for start, patch in mine])
        group["areas"] = np.concatenate([patch.areas for _, patch in mine])
        group["offsets"] = np.concatenate([patch.offsets for _, patch in mine])
        mask = np.zeros(total, np.uint8)
        mask[group["particles"][()]] = 1
        file.create_dataset(f"paraview/set {name}", data=mask, **packed)


def read_particles(path):
    """Read a particle file."""
    path = input_file(path)
    try:
        with h5py.File(path, "r") as file:
            kind = file.attrs.get("format")
            if kind != FORMAT:
                raise PrepError(f"{path}: the format is '{kind}' instead of '{FORMAT}'", FILES)
            n = len(file["volumes"])
            names = [str(name) for name in file["body_names"].asstr()] if "bodies" in file else []
            names = names or [path.stem]
            materials = names
            if "body_materials" in file:
                materials = [str(name) for name in file["body_materials"].asstr()]
            sets = file.get("sets", {})
            return ParticleFile(
                path,
                str(file.attrs["length_unit"]),
                file["positions"][()].astype(float),
                file["volumes"][()].astype(float),
                file["bodies"][()].astype(int) if "bodies" in file else np.zeros(n, int),
                names,
                materials,
                {name: sets[name]["particles"][()].astype(int) for name in sets},
                [name for name in sets if "areas" in sets[name]],
                {name: file.attrs[name] for name in file.attrs},
            )
    except (OSError, KeyError) as failure:
        raise PrepError(f"{path}: not a readable particle file: {failure}", FILES) from None
