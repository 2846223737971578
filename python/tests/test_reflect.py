"""Single queries: equal to those of the command line."""

import numpy as np
import pytest

import octagloss


@pytest.mark.parametrize(
    "lobe, filter, roughness",
    [
        ("ggx", "adaptive:0.005", 0.4),
        ("ggx", "adaptive:0.05", 0.0),
        ("ggx", "pyramid", 0.3),
        ("ggx", "box", 0.6),
        ("phong", "adaptive", 0.5),
        ("cone", "adaptive:0.01", 0.2),
        ("charlie", "adaptive:0.01", 0.7),
        ("ggx", "reference", 0.5),
    ],
)
def test_answers_equal_the_command_lines(program, sky, sky_file, directions, lobe, filter, roughness):
    directions = directions[:20] if filter == "reference" else directions
    theirs = program.query(sky_file, directions, "--lobe", lobe, "--filter", filter, "--roughness", roughness)
    ours = sky.reflect(directions, roughness, lobe=lobe, filter=filter)
    assert ours.dtype == np.float32 and ours.shape == directions.shape
    np.testing.assert_array_equal(ours, theirs)


@pytest.mark.smoke
def test_a_roughness_each_and_bounds_equal_the_command_lines(program, sky, sky_file, directions):
    roughness = np.linspace(0.0, 1.0, len(directions)).round(2)
    columns = np.column_stack([directions, roughness])
    theirs = program.query(sky_file, columns, "--bound")
    radiance, bounds = sky.reflect(directions, roughness, bounds=True)
    np.testing.assert_array_equal(np.column_stack([radiance, bounds]), theirs)
    assert np.isinf(bounds[roughness == 0]).all() and np.isfinite(bounds[roughness > 0]).all()
    # The bounds hold against the octahedral map, which is within a few percent of the source.
    exact = octagloss.reference(sky, directions[::10], roughness[::10])
    error = np.abs((radiance[::10] - exact) @ [0.2126, 0.7152, 0.0722])
    assert (error <= bounds[::10, 0] + 0.05 * exact.mean()).all()


def test_irradiance_is_pi_times_the_cosine_lobe(program, sky, sky_file, directions):
    theirs = program.query(sky_file, directions, "--lobe", "cosine", "--bound")
    irradiance, bounds = sky.irradiance(directions, bounds=True)
    np.testing.assert_allclose(irradiance, np.pi * theirs[:, :3], rtol=1e-6)
    np.testing.assert_allclose(bounds, np.pi * theirs[:, 3:], rtol=1e-6)
    np.testing.assert_allclose(sky.irradiance(directions), irradiance)


def test_options_of_reading_equal_the_command_lines(program, sky_file, directions):
    options = ["--rotate-y", "30", "--mirror", "--scale", "2.5"]
    theirs = program.query(sky_file, directions, "--roughness", "0.5", *options)
    turned = octagloss.Environment.from_file(sky_file, rotate_y=30, mirror=True, scale=2.5)
    np.testing.assert_array_equal(turned.reflect(directions, 0.5), theirs)


def test_the_reference_equals_the_command_lines(program, sky, sky_file, directions):
    for lobe, roughness in [("ggx", 0.3), ("cosine", None)]:
        arguments = ["--lobe", lobe, "--filter", "reference"]
        arguments += [] if roughness is None else ["--roughness", roughness]
        theirs = program.query(sky_file, directions[:20], *arguments)
        ours = octagloss.reference(sky, directions[:20], roughness, lobe=lobe)
        assert ours.dtype == np.float64
        np.testing.assert_array_equal(ours.astype(np.float32), theirs)


def test_leading_axes_are_kept_and_roughness_is_broadcast(lamp, directions):
    grid = directions.reshape(4, 50, 3)
    roughness = np.array([[0.2], [0.4], [0.6], [0.8]])
    radiance, bounds = lamp.reflect(grid, roughness, bounds=True)
    assert radiance.shape == (4, 50, 3) and bounds.shape == (4, 50, 4)
    for row in range(4):
        alone = lamp.reflect(grid[row], roughness[row, 0], sharpest=0.2)
        np.testing.assert_array_equal(radiance[row], alone)
    table = lamp.reflect(directions[:, None], roughness[:, 0])
    assert table.shape == (200, 4, 3)
    np.testing.assert_array_equal(table[:50, 0], radiance[0])
    assert lamp.reflect([1, 0, 0], 0.5).shape == (3,)
    assert octagloss.reference(lamp, [1, 0, 0], [0.4, 0.5]).shape == (2, 3)
    # Answers depend on neither the order nor on earlier calls.
    np.testing.assert_array_equal(lamp.reflect(grid[::-1], roughness[::-1])[::-1], radiance)


def test_any_kind_of_array_is_taken(lamp, directions):
    exact = lamp.reflect(directions, 0.5)
    for same in [
        np.asfortranarray(directions),
        np.repeat(directions, 2, axis=0)[::2],
        directions[::-1][::-1],
        directions.astype(">f8"),
        directions.tolist(),
        3.0 * directions,
    ]:
        np.testing.assert_allclose(lamp.reflect(same, 0.5), exact, rtol=1e-6)
    single = directions.astype(np.float32)
    np.testing.assert_array_equal(lamp.reflect(single, 0.5), lamp.reflect(single.astype(float), 0.5))
    np.testing.assert_array_equal(lamp.reflect(np.eye(3, dtype=int), 0.5), lamp.reflect(np.eye(3), 0.5))
    assert lamp.reflect(np.eye(3, dtype=np.float16), 0.5).shape == (3, 3)
    unaligned = np.frombuffer(b"\0" + directions.tobytes(), np.uint8)[1:].view(float).reshape(-1, 3)
    np.testing.assert_array_equal(lamp.reflect(unaligned, 0.5), exact)
    # Lengths beyond the range of their squares.
    np.testing.assert_array_equal(lamp.reflect([1e-300, 0, 0], 0.5), lamp.reflect([1e300, 0, 0], 0.5))


def test_no_directions_are_no_answers(lamp):
    for shape in [(0, 3), (2, 0, 3)]:
        radiance, bounds = lamp.reflect(np.empty(shape), 0.5, bounds=True)
        assert radiance.shape == shape and bounds.shape == (*shape[:-1], 4)
        assert lamp.reflect(np.empty(shape), np.empty(shape[:-1])).shape == shape
        assert octagloss.reference(lamp, np.empty(shape), 0.5).shape == shape


@pytest.mark.parametrize(
    "directions, roughness, options, error, words",
    [
        ([1, 0], 0.5, {}, ValueError, r"`directions` has the shape \(2,\); \(..., 3\) is needed"),
        (np.empty((0, 2)), 0.5, {}, ValueError, r"shape \(0, 2\)"),
        (1.0, 0.5, {}, ValueError, r"shape \(\); \(..., 3\) is needed"),
        ([[1, 0, 0], [0, np.nan, 0]], 0.5, {}, ValueError, r"directions\[1, 1\] is NaN; it must be finite"),
        ([0, 0, np.inf], 0.5, {}, ValueError, r"directions\[2\] is inf"),
        ([[[1, 0, 0], [0, 0, 0]]], 0.5, {}, ValueError, r"directions\[0, 1\] is 0, 0, 0"),
        ([1j, 0, 0], 0.5, {}, TypeError, "`directions` has the dtype complex128"),
        (["a", "b", "c"], 0.5, {}, TypeError, "real numbers are needed"),
        (None, 0.5, {}, TypeError, "dtype object"),
        ([1, 0, 0], None, {}, ValueError, "the lobe ggx needs `roughness`"),
        ([1, 0, 0], 1.5, {}, ValueError, "roughness is 1.5; it must be between 0 and 1"),
        ([[1, 0, 0]] * 2, [0.1, -0.1], {}, ValueError, r"roughness\[1\] is -0.1"),
        ([1, 0, 0], np.nan, {}, ValueError, "roughness is NaN"),
        ([[1, 0, 0]] * 3, [0.1, 0.2], {}, ValueError, r"shape \(2,\), which does not fit \(3,\) directions"),
        ([1, 0, 0], 0.5, {"lobe": "cosine"}, ValueError, "no roughness; omit"),
        ([1, 0, 0], 0.5, {"lobe": "blinn"}, ValueError, '`lobe` is "blinn"; choose one of ggx, phong'),
        ([1, 0, 0], 0.5, {"filter": "adaptive:0"}, ValueError, "at least 1e-6"),
        ([1, 0, 0], 0.5, {"filter": "fitted:4"}, ValueError, "use pyramid"),
        ([1, 0, 0], 0.5, {"filter": "pyramid", "lobe": "cone"}, ValueError, "supports ggx only"),
        ([1, 0, 0], 0.5, {"filter": "box", "bounds": True}, ValueError, "`bounds` needs `filter` adaptive:E"),
        ([1, 0, 0], 0.5, {"oem_size": 0}, ValueError, "`oem_size` must be at least 1"),
        ([1, 0, 0], 0.5, {"oem_size": 60000}, MemoryError, "at most 16384"),
        ([1, 0, 0], 0.5, {"oem_size": -1}, OverflowError, "oem_size"),
        ([1, 0, 0], 0.5, {"sharpest": 0.6}, ValueError, "below `sharpest`"),
        ([1, 0, 0], 0.5, {"sharpest": 2}, ValueError, "between 0 and 1"),
    ],
)
def test_wrong_arguments_are_named(lamp, directions, roughness, options, error, words):
    with pytest.raises(error, match=words):
        lamp.reflect(directions, roughness, **options)


def test_spherical_harmonics_equal_the_reports(program, sky, sky_file):
    arguments = [
        "bake",
        sky_file,
        "--size",
        "4",
        "--levels",
        "1",
        "--json",
        "-o",
        "a.ktx2",
        "--engine",
        "cpu",
    ]
    report = program.json(*arguments, "--sh-order", "4")
    ours = sky.sh(4)
    assert ours.dtype == np.float64 and ours.shape == (25, 3)
    np.testing.assert_allclose(ours, report["sh"]["coefficients"], rtol=1e-12, atol=1e-12)
    report = program.json(*arguments, "--sh-window", "hanning:3", "--force")
    np.testing.assert_allclose(sky.sh(window="hanning:3"), report["sh"]["coefficients"], rtol=1e-12)
    # The constant is pi: irradiance of the mean radiance.
    np.testing.assert_allclose(sky.sh(scale="irradiance")[0], np.pi * sky.sh()[0])
    assert sky.sh(scale="filament").shape == (9, 3)
    for arguments, words in [
        ({"order": 5}, "0 to 4"),
        ({"window": "box"}, "choose one of none"),
        ({"scale": "three"}, "choose one of radiance"),
        ({"order": 3, "scale": "filament"}, "`order` 2"),
    ]:
        with pytest.raises(ValueError, match=words):
            sky.sh(**arguments)


def test_the_sun_equals_that_of_info(program, sky, sky_file, lamp):
    theirs = program.json("info", sky_file, "--json")["sun"]
    sun = sky.sun()
    assert sun.is_sun and "sun at" in repr(sun)
    for key, value in theirs.items():
        np.testing.assert_allclose(getattr(sun, key), value, rtol=1e-5, err_msg=key)
    rest, sun = sky.extract_sun()
    again = rest.sun()
    assert again is None or not again.is_sun
    weights = sky.texel_directions()[1][..., None]
    taken = (weights * (sky.texels.astype(float) - rest.texels)).sum(axis=(0, 1))
    np.testing.assert_allclose(sun.irradiance, taken, rtol=1e-9)
    assert octagloss.Environment.from_array(np.ones((8, 16, 3))).sun() is None
    assert octagloss.Environment.from_array(np.ones((8, 16, 3))).extract_sun() is None
