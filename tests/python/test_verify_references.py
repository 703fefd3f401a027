"""Exact solutions and measures that the cases of cracks compare with."""

import numpy as np
import pytest

from verify.cases import penny_step
from verify.fronts import amplitudes, box_factor, rms
from verify.measure import ROOT, read_table
from verify.solids import Solid, half_plane_k, penny_k, rotation, tension, voigt


def test_wave_speeds_of_steel():
    steel = Solid(2e5, 0.298, 7.9e-3)
    # Their squares times the density are the shear and the longitudinal modulus.
    assert steel.density * steel.c_s**2 == pytest.approx(2e5 / 2.596, rel=1e-12)
    modulus = 2e5 * 0.702 / (1.298 * 0.404)
    assert steel.density * steel.c_d**2 == pytest.approx(modulus, rel=1e-12)


def front(normal, along, radius, n=24):
    angle = 2 * np.pi * np.arange(n) / n
    across = np.cross(normal, along)
    return radius * (np.outer(np.cos(angle), along) + np.outer(np.sin(angle), across))


def test_inclined_penny_has_the_modes_of_the_paper():
    slope = np.deg2rad(30)
    normal = np.array([np.sin(slope), 0, np.cos(slope)])
    along = np.array([np.cos(slope), 0, -np.sin(slope)])
    points = front(normal, along, 10.0)
    k = penny_k(tension(40.0, np.eye(3)[2]), normal, np.zeros(3), 10.0, points, 0.298)
    k /= 80 * np.sqrt(10 / np.pi)
    # cos**2(30), and figure 15 of 10.1002/nme.6653: 4 digits.
    assert np.abs(k).max(axis=1) == pytest.approx([0.75, 0.5088, 0.3572], abs=5e-5)
    # The plus face slips along the traction, which points down the slope: K_II < 0 at `along`.
    assert k[1, 0] < 0
    assert k[2, 0] == pytest.approx(0, abs=1e-12)


def test_penny_turns_with_its_frame():
    turn = rotation(np.array([1.0, -2.0, 0.5]), 0.7)
    stress = np.array([[3.0, 1, 0], [1, -2, 0.5], [0, 0.5, 4]])
    normal, along = np.array([0.0, 0, 1]), np.array([1.0, 0, 0])
    points = front(normal, along, 2.0)
    k = penny_k(stress, normal, np.zeros(3), 2.0, points, 0.3)
    turned = penny_k(
        turn @ stress @ turn.T, turn @ normal, np.ones(3), 2.0, points @ turn.T + 1, 0.3
    )
    assert turned == pytest.approx(k, abs=1e-12)  # rounding


def test_half_plane_grows_with_the_root_of_time_after_the_wave():
    steel = Solid(2e5, 0.3, 7.9e-3)
    k = half_plane_k(np.array([-1.0, 0.0, 1.0, 4.0]), 100.0, steel)
    assert k[:2].tolist() == [0, 0]
    assert k[3] / k[2] == pytest.approx(2, rel=1e-12)


def test_the_box_is_taken_out_exactly_where_it_goes_with_the_cube():
    factor = [1 - 0.7 / w**3 for w in (3.0, 4.5)]
    assert box_factor(5 * factor[0], 5 * factor[1], 3.0, 4.5) == pytest.approx(factor[0], rel=1e-12)


def test_amplitudes_are_fitted_and_vanish_from_a_mode_that_is_not_there():
    s = np.linspace(0, 2 * np.pi, 40)
    exact = np.array([np.ones(40), np.cos(s), 0 * s])
    found = amplitudes(np.array([1.02 * exact[0], 0.9 * exact[1], 0.1 + exact[2]]), exact)
    assert found[:2] == pytest.approx([1.02, 0.9], rel=1e-12)
    assert np.isnan(found[2])


def test_rotation_is_one_and_leaves_its_axis():
    axis = np.array([0.3, -1.0, 2.0])
    turn = rotation(axis, 1.1)
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-14)
    assert turn @ axis == pytest.approx(axis, abs=1e-14)
    assert np.trace(turn) == pytest.approx(1 + 2 * np.cos(1.1), abs=1e-14)


def test_components_stand_in_the_order_of_the_deck():
    stress = np.array([[1, 4, 6], [4, 2, 5], [6, 5, 3]])
    assert voigt(stress) == [1, 2, 3, 4, 5, 6]


def test_the_peak_of_a_parabola_is_found_between_its_samples():
    t = np.linspace(0, 2, 21)
    assert penny_step.peak(t, 3 - (t - 1.03) ** 2) == pytest.approx((3, 1.03), rel=1e-9)


def test_reference_of_the_sudden_penny_has_its_overshoot_and_its_static_end():
    table = read_table(ROOT / "tests" / "verify" / "data" / "step_penny.csv")
    peak = penny_step.peak(table["time"], table["ratio"])
    assert peak == pytest.approx((1.313, 2.06), rel=0.01)
    assert rms(table["ratio"][table["time"] > 6] - 1) < 0.02  # small waves are left
    # At first K is that of a half-plane, for no wave has crossed the crack yet. Its front is
    # curved, which takes off a few percent, and the table is coarse there.
    solid = Solid(1.0, 0.3, 1.0)
    t = table["time"][2:6]
    plane = half_plane_k(t / solid.c_s, 1.0, solid) / (2 * np.sqrt(1 / np.pi))
    assert table["ratio"][2:6] == pytest.approx(plane, rel=0.05)


def test_reference_of_the_bar_has_the_peaks_of_its_waves():
    table = read_table(ROOT / "tests" / "verify" / "data" / "ellipse_bar.csv")
    for column, height, when in (("minor_end", 240, 54.7), ("major_end", 175, 64.0)):
        i = np.argmax(table[column])
        assert table[column][i] == pytest.approx(height, rel=0.01)
        assert table["time"][i] == pytest.approx(when, abs=0.7)
    # The wave needs 150 mm / c_d = 23 us to the crack.
    arrival = 150 / Solid(2e5, 0.298, 7.9e-3).c_d * 1e3
    assert np.abs(table["minor_end"][table["time"] < arrival - 1]).max() < 2
