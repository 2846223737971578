"""Maps of the sphere."""

import numpy as np
import pytest

from octagloss import maps


def test_conventions():
    # The panorama's centre looks along +X, its right half along +Z.
    np.testing.assert_allclose(
        maps.equirect_from_direction([[1, 0, 0], [0, 0, 1]]), [[0.5, 0.5], [0.75, 0.5]]
    )
    np.testing.assert_allclose(maps.equirect_from_direction([0, 5, 0]), [0.5, 0])
    # +Y is the octahedral centre, +X and +Z the midpoints of edges.
    centre = maps.oct_from_direction([[0, 1, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(centre, [[0, 0], [1, 0], [0, 1]], atol=1e-15)
    faces, uv = maps.cube_from_direction(np.concatenate([np.eye(3), -np.eye(3)]))
    assert faces.tolist() == [0, 2, 4, 1, 3, 5] and faces.dtype == np.int64
    np.testing.assert_allclose(uv, 0)
    # +X is (1, -t, -s).
    expected = np.array([1, -0.25, -0.5]) / np.linalg.norm([1, 0.25, 0.5])
    np.testing.assert_allclose(maps.direction_from_cube(0, [0.5, 0.25]), expected)


def test_round_trips(directions):
    unit = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    grid = unit.reshape(4, 50, 3)
    np.testing.assert_allclose(
        maps.direction_from_equirect(maps.equirect_from_direction(grid)), grid, atol=1e-12
    )
    np.testing.assert_allclose(maps.direction_from_oct(maps.oct_from_direction(grid)), grid, atol=1e-12)
    faces, uv = maps.cube_from_direction(grid)
    for face in range(6):
        own = faces == face
        np.testing.assert_allclose(maps.direction_from_cube(face, uv[own]), grid[own], atol=1e-12)


@pytest.mark.parametrize("name", maps.names())
def test_named_maps_go_both_ways_and_cover_the_sphere(name, directions):
    unit = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    components, uv = maps.map_from_direction(name, directions)
    rectangles = maps.components(name)
    total = 0.0
    for component, (low, high) in enumerate(rectangles):
        own = components == component
        back = maps.direction_from_map(name, uv[own], component)
        np.testing.assert_allclose(back, unit[own], atol=1e-9)
        # Midpoints of 200 x 200 cells.
        low, high = np.array(low), np.array(high)
        steps = (np.arange(200) + 0.5) / 200
        points = low + (high - low) * np.stack(np.meshgrid(steps, steps), axis=-1)
        density = maps.density(name, points, component)
        assert density.shape == (200, 200)
        total += density.mean() * np.prod(high - low)
    # The rim of a mirror ball is singular.
    np.testing.assert_allclose(total, 4 * np.pi, rtol=0.02)


def test_wrong_arguments_are_named():
    for call, words in [
        (lambda: maps.direction_from_oct([0, 1.5]), r"uv is 0, 1.5; it must be from -1, -1 to 1, 1"),
        (lambda: maps.direction_from_equirect([[0, 0], [2, 0]]), r"uv\[1\] is 2, 0"),
        (lambda: maps.direction_from_oct([0, np.nan]), r"uv\[1\] is NaN"),
        (lambda: maps.direction_from_oct([0, 0, 0]), r"`uv` has the shape \(3,\); \(..., 2\) is needed"),
        (lambda: maps.oct_from_direction([0, 0, 0]), "not a direction"),
        (lambda: maps.direction_from_cube(6, [0, 0]), "`face` is 6; it must be 0 to 5"),
        (lambda: maps.map_from_direction("mercator", [1, 0, 0]), "choose one of octahedral"),
        (lambda: maps.density("cube", [0, 0], 6), "`component` is 6; cube has 0 to 5"),
        (lambda: maps.components(""), "choose one of"),
    ]:
        with pytest.raises(ValueError, match=words):
            call()
