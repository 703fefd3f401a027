"""Exact solutions that the cases of cracks compare with. Units are those of the deck."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Solid:
    """An isotropic elastic material."""

    young: float
    poisson: float
    density: float

    @property
    def shear(self) -> float:
        """Shear modulus."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def c_s(self) -> float:
        """Speed of shear waves."""
        return float(np.sqrt(self.shear / self.density))

    @property
    def c_d(self) -> float:
        """Speed of dilatational waves."""
        return self.c_s * float(np.sqrt((2 - 2 * self.poisson) / (1 - 2 * self.poisson)))


def tension(pull: float, direction: np.ndarray) -> np.ndarray:
    """Uniaxial stress in a direction (3,3)."""
    return pull * np.outer(direction, direction)


def voigt(stress: np.ndarray) -> list[float]:
    """Components xx yy zz xy yz xz of a stress (3,3)."""
    return [float(stress[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]


def penny_k(
    stress: np.ndarray,
    normal: np.ndarray,
    centre: np.ndarray,
    radius: float,
    points: np.ndarray,
    poisson: float,
) -> np.ndarray:
    """K_I, K_II, K_III (3,n) of a penny-shaped crack in an infinite body at points of its front.

    Eq. 63-65 of 10.1002/nme.6653, after Sneddon (1946) and Kassir and Sih (1966), written for any
    remote stress: with the traction t = stress normal, e1 the radial direction, e3 = e1 x normal,

        K_I = 2/pi sqrt(pi a) t.n, K_II = k t.e1, K_III = (1 - nu) k t.e3,
        k = 4/(pi (2 - nu)) sqrt(pi a).
    """
    across = points - centre
    across = across - np.outer(across @ normal, normal)
    e1 = across / np.linalg.norm(across, axis=1, keepdims=True)
    e3 = np.cross(e1, normal)
    traction = stress @ normal
    root = np.sqrt(np.pi * radius)
    shear = 4 / (np.pi * (2 - poisson)) * root
    return np.array(
        [
            np.full(len(points), 2 / np.pi * root * (traction @ normal)),
            shear * (e1 @ traction),
            (1 - poisson) * shear * (e3 @ traction),
        ]
    )


def half_plane_k(t: np.ndarray, pull: float, solid: Solid) -> np.ndarray:
    """K_I of a half-plane crack at a time t after a step wave of tension has reached it.

    L. B. Freund, Dynamic Fracture Mechanics (Cambridge, 1990), section 2.5, plane strain. It holds
    until a wave comes back from another boundary.
    """
    reach = solid.c_d * np.maximum(t, 0.0) * (1 - 2 * solid.poisson) / np.pi
    return 2 * pull / (1 - solid.poisson) * np.sqrt(reach)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Matrix that turns by an angle about an axis (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
