"""A half-plane crack that runs after a sudden pull, exactly; the energy that the grid cannot see.

L. B. Freund, Dynamic Fracture Mechanics, Cambridge University Press 1990: K_I of a crack whose tip
moves at v is k_I(v) times that of a tip that stands there (sec. 6.4), and the tip that stands has
K_I ~ sqrt(t) after a step of tension (sec. 2.5).
"""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from verify.solids import Solid, half_plane_k


def rayleigh_speed(solid: Solid) -> float:
    """Speed of Rayleigh waves."""
    k = (solid.c_s / solid.c_d) ** 2
    cubic = [-1, 8, -(24 - 16 * k), 16 * (1 - k)]
    roots = np.roots(cubic)
    root = min(r.real for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1)
    return solid.c_s * float(np.sqrt(root))


def speed_factor(v: float, solid: Solid) -> float:
    """k_I(v): (1 - v/c_R)/sqrt(1 - v/c_d) times S(1/v), a factor of Rayleigh's function."""
    if v == 0:
        return 1.0
    a, b = 1 / solid.c_d, 1 / solid.c_s

    def phase(slowness: float) -> float:
        root = np.sqrt(max((slowness**2 - a**2) * (b**2 - slowness**2), 0.0))
        turn = np.arctan(4 * slowness**2 * root / (b**2 - 2 * slowness**2) ** 2)
        return float(turn / (slowness - 1 / v))

    integral = quad(phase, a, b, points=[b / np.sqrt(2)], limit=400)[0]
    factor = (1 - v / rayleigh_speed(solid)) / np.sqrt(1 - v / solid.c_d)
    return float(factor * np.exp(-integral / np.pi))


def rate_factor(v: float, solid: Solid) -> float:
    """A_I(v): G = A_I K_I**2/(2 mu); 1 - nu at rest (eq. 50 and 51 of 10.1002/nme.6653)."""
    if v == 0:
        return 1 - solid.poisson
    s = (v / solid.c_s) ** 2
    first, second = np.sqrt(1 - (v / solid.c_d) ** 2), np.sqrt(1 - s)
    return float(first * s / (4 * first * second - (1 + second**2) ** 2))


def growth(pull: float, toughness: float, times: np.ndarray, solid: Solid) -> tuple[float, ...]:
    """Onset, speeds and ways of a tip that obeys K_I = K_Ic/(1 - v/c_R) (eq. 59 and 60)."""
    c_r = rayleigh_speed(solid)
    onset = float((toughness / half_plane_k(np.ones(1), pull, solid)[0]) ** 2)
    shares = np.linspace(0, 0.8, 161)
    # K(0) that drives a tip at each speed, as a table: it rises with the speed
    driven = [toughness / (1 - s) / speed_factor(s * c_r, solid) for s in shares]
    speeds = c_r * np.interp(half_plane_k(times, pull, solid), driven, shares, left=0.0)
    ways = np.concatenate([[0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times))])
    return onset, speeds, ways


def toughness_for(pull: float, onset: float, solid: Solid) -> float:
    """K_Ic with which the tip starts at a time."""
    return float(half_plane_k(np.array([onset]), pull, solid)[0])


def time_of(way: float, pull: float, toughness: float, solid: Solid) -> float:
    """When the tip has gone so far."""

    def miss(time: float) -> float:
        return growth(pull, toughness, np.linspace(0, time, 400), solid)[2][-1] - way

    onset = growth(pull, toughness, np.zeros(2), solid)[0]
    return float(brentq(miss, onset, 40 * onset, xtol=1e-4 * onset))


def nodes_of(x: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (8,n) and weights (8,n) of linear functions at places (n,3)."""
    cell = np.floor(x / h).astype(int)
    t = x / h - cell
    low = cell.min(axis=0)
    shape = cell.max(axis=0) - low + 2
    nodes, weights = [], []
    for corner in product((0, 1), repeat=3):
        nodes.append(np.ravel_multi_index((cell - low + corner).T, shape))
        weights.append(np.prod(np.where(corner, t, 1 - t), axis=1))
    return np.array(nodes), np.array(weights)


def resolved(values: np.ndarray, x: np.ndarray, h: float, side: np.ndarray) -> np.ndarray:
    """What nodes see of fields (n,f) of equal particles: 2 S f - S S f, apart on each side.

    `side` is 1, -1, or 0 ahead of the front, where particles belong to both halves.
    """
    nodes, weights = nodes_of(x, h)
    count = nodes.max() + 1
    share = np.array([0.5 * (1 - side), 0.5 * (1 + side)])
    reached = np.array(
        [np.bincount(nodes.ravel(), np.tile(side == s, 8), count) > 0 for s in (-1, 1)]
    )
    split = reached.all(axis=0)

    def mean(column: np.ndarray) -> np.ndarray:
        sums = np.array(
            [
                [
                    np.bincount(nodes.ravel(), (weights * g * f).ravel(), count)
                    for f in (column, np.ones_like(column))
                ]
                for g in share
            ]
        )
        sums[:, :, ~split] = sums[:, :, ~split].sum(axis=0)
        means = sums[:, 0] / np.maximum(sums[:, 1], 1e-300)
        return sum(g * (weights * m[nodes]).sum(axis=0) for g, m in zip(share, means, strict=True))

    result = np.empty_like(values)
    for k in range(values.shape[1]):
        first = mean(values[:, k])
        result[:, k] = first + mean(values[:, k] - first)
    return result


def elastic_density(stress: np.ndarray, solid: Solid) -> np.ndarray:
    """Elastic energy per volume of stresses xx yy zz xy yz xz (n,6)."""
    square = np.sum(stress[:, :3] ** 2, axis=1) + 2 * np.sum(stress[:, 3:] ** 2, axis=1)
    trace = np.sum(stress[:, :3], axis=1)
    nu = solid.poisson
    return (square - nu / (1 + nu) * trace**2) / (4 * solid.shear)
