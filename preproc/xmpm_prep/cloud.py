"""Particles of a body, with the parts of named surfaces that they carry."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Patch:
    """Particles of one body at a named surface."""

    particles: np.ndarray  # (k) numbers, each once, ascending
    areas: np.ndarray  # (k,3) outward area vectors [length^2]
    offsets: np.ndarray  # (k,3) from the particle to the middle of its patch [length]


@dataclass
class Cloud:
    """Particles of one body."""

    positions: np.ndarray  # (n,3) [length]
    volumes: np.ndarray  # (n) [length^3]
    sets: dict[str, Patch] = field(default_factory=dict)


def make_patch(positions, particle, area, centre, weight=None):
    """Patches of surface, each given to a particle, gathered by particle.

    `particle` (m) may name a particle more than once, `area` (m,3) and `centre` (m,3) are those of
    the patches; `weight` (m) is the part of a patch that the particle gets.
    """
    if weight is not None:
        area = area * weight[:, None]
    size = np.linalg.norm(area, axis=1)
    particles, place = np.unique(particle, return_inverse=True)
    n = len(particles)
    total = np.bincount(place, size, n)
    areas = np.stack([np.bincount(place, area[:, i], n) for i in range(3)], axis=1)
    middle = np.stack([np.bincount(place, size * centre[:, i], n) for i in range(3)], axis=1)
    middle /= np.maximum(total, np.finfo(float).tiny)[:, None]
    return Patch(particles, areas, middle - positions[particles])
