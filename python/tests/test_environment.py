"""Environments from files and arrays."""

import os

import numpy as np
import pytest

import octagloss
from octagloss import Environment


@pytest.mark.smoke
def test_versions_agree(program):
    assert program("--version").split()[1] == octagloss.__version__


@pytest.mark.parametrize(
    "layout, shape", [("panorama", (8, 16, 3)), ("cube", (6, 4, 4, 3)), ("octahedral", (8, 8, 3))]
)
def test_arrays_come_back_as_they_went_in(layout, shape):
    array = np.random.default_rng(1).random(shape, np.float32)
    environment = Environment.from_array(array, layout)
    assert environment.layout == layout and environment.shape == shape
    np.testing.assert_array_equal(environment.texels, array)
    centres, solid_angles = environment.texel_directions()
    assert centres.shape == shape and solid_angles.shape == shape[:-1]
    np.testing.assert_allclose(np.linalg.norm(centres, axis=-1), 1.0)
    np.testing.assert_allclose(solid_angles.sum(), 4 * np.pi)
    # A mirror looks at the texel itself.
    np.testing.assert_allclose(
        octagloss.reference(environment, centres, 0.0), array, rtol=1e-6, err_msg="texel centres"
    )
    assert layout in repr(environment)


def test_texels_are_a_read_only_view(sky):
    texels = sky.texels
    assert not texels.flags.owndata and not texels.flags.writeable
    assert np.shares_memory(texels, sky.texels)
    with pytest.raises(ValueError, match="read-only"):
        texels[0, 0, 0] = 1.0
    with pytest.raises(ValueError, match="WRITEABLE"):
        texels.setflags(write=True)
    # The view keeps the numbers alive.
    environment = Environment.from_array(np.full((4, 8, 3), 7.0))
    texels = environment.texels
    del environment
    junk = [np.zeros((4, 8, 3), np.float32) for _ in range(100)]
    assert (texels == 7.0).all() and len(junk) == 100


def test_later_changes_of_the_array_do_not_reach_the_environment():
    array = np.ones((4, 8, 3), np.float32)
    environment = Environment.from_array(array)
    array[:] = 5.0
    assert (environment.texels == 1.0).all()


def test_any_kind_of_array_is_taken():
    array = np.random.default_rng(2).random((8, 16, 3), np.float32)
    for same in [
        np.asfortranarray(array),
        np.repeat(array, 2, axis=1)[:, ::2],
        array[::-1][::-1],
        array.astype(float),
        array.astype(">f4"),
        array.tolist(),
    ]:
        np.testing.assert_array_equal(Environment.from_array(same).texels, array)
    assert Environment.from_array(np.ones((8, 16, 3), np.uint8)).texels.max() == 1.0
    subnormal = np.full((4, 8, 3), 1e-42, np.float32)
    np.testing.assert_array_equal(Environment.from_array(subnormal).texels, subnormal)


def bad(value, place=(1, 2, 0), dtype=float):
    array = np.ones((4, 8, 3), dtype)
    array[place] = value
    return array


@pytest.mark.parametrize(
    "array, layout, error, words",
    [
        (bad(np.nan), "panorama", ValueError, r"array\[1, 2, 0\] is NaN; radiance must be finite"),
        (bad(np.inf, (3, 7, 2), np.float32), "panorama", ValueError, r"array\[3, 7, 2\] is inf"),
        (bad(-1e-30), "panorama", ValueError, r"array\[1, 2, 0\] is -1e-30"),
        (bad(1e39), "panorama", ValueError, r"is 1e39; .* at most 3.4"),
        (
            np.ones((4, 8)),
            "panorama",
            ValueError,
            r"shape \(4, 8\); the layout panorama needs \(height, width, 3\)",
        ),
        (np.ones((4, 8, 4)), "panorama", ValueError, r"\(4, 8, 4\)"),
        (np.ones((0, 8, 3)), "panorama", ValueError, "sides must be 1 to 65536"),
        (np.ones((5, 4, 4, 3)), "cube", ValueError, r"the layout cube needs \(6, n, n, 3\)"),
        (np.ones((6, 4, 5, 3)), "cube", ValueError, r"\(6, n, n, 3\)"),
        (np.ones((4, 8, 3)), "octahedral", ValueError, r"\(n, n, 3\)"),
        (np.ones((4, 8, 3)), "sphere", ValueError, "choose one of cube, panorama, octahedral"),
        (np.ones((4, 8, 3), bool), "panorama", TypeError, "dtype bool"),
        (np.ones((4, 8, 3), complex), "panorama", TypeError, "dtype complex128"),
        ("sky.exr", "panorama", TypeError, "real numbers are needed"),
    ],
)
def test_wrong_arrays_are_named(array, layout, error, words):
    with pytest.raises(error, match=words):
        Environment.from_array(array, layout)


def test_files_of_every_kind_are_read(program, sky, sky_file, tmp_path):
    assert Environment.from_file(str(sky_file)).layout == "panorama"
    program("convert", sky_file, "--layout", "octahedral", "--size", "64", "-o", "octahedral.exr")
    assert Environment.from_file(tmp_path / "octahedral.exr").shape == (64, 64, 3)
    octagloss.bake(sky, size=8, levels=1, output=tmp_path / "cube.ktx2")
    assert Environment.from_file(tmp_path / "cube.ktx2").shape == (6, 8, 8, 3)
    octagloss.bake(sky, size=8, levels=1, output=tmp_path / "faces", container="exr", pixel="f32")
    names = [tmp_path / f"faces/m0_{face}.exr" for face in ["px", "nx", "py", "ny", "pz", "nz"]]
    faces = Environment.from_file(names, layout="faces")
    np.testing.assert_array_equal(faces.texels, Environment.from_file(tmp_path / "faces").texels)


def test_files_are_read_by_the_map_that_their_header_names(program, sky_file, tmp_path):
    maps = {"equirect": (16, 32, 3), "cube": (6, 16, 16, 3), "octahedral": (16, 16, 3)}
    for name in octagloss.maps.names():
        path = tmp_path / f"{name}.exr"
        program("convert", sky_file, "--layout", name, "--size", "16", "--border", "2", "-o", path)
        if name in maps:
            assert Environment.from_file(path).shape == maps[name]
            wrong = "cross" if name == "cube" else "strip"
            with pytest.raises(octagloss.InputError, match=f"its map is {name} .*, but `layout` is {wrong}"):
                Environment.from_file(path, layout=wrong)
        else:
            with pytest.raises(octagloss.InputError, match=f"its map is {name} .*, which no environment has"):
                Environment.from_file(path)


def test_wrong_files_are_named(tmp_path, sky_file):
    with pytest.raises(FileNotFoundError, match="missing.exr: No such file") as caught:
        Environment.from_file(tmp_path / "missing.exr")
    assert caught.value.errno == 2
    (tmp_path / "text.exr").write_text("not an image")
    for kind in [octagloss.InputError, OSError, ValueError]:
        with pytest.raises(kind, match="text.exr: not an image"):
            Environment.from_file(tmp_path / "text.exr")
    (tmp_path / "cut.exr").write_bytes(sky_file.read_bytes()[:5000])
    with pytest.raises(octagloss.InputError, match="cut.exr"):
        Environment.from_file(tmp_path / "cut.exr")
    with pytest.raises(ValueError, match="a cube takes six face files, got 5"):
        Environment.from_file([sky_file] * 5)
    os.mkfifo(tmp_path / "pipe.exr")
    with pytest.raises(octagloss.InputError, match="a named pipe"):
        Environment.from_file(tmp_path / "pipe.exr")
    for options, words in [
        ({"layout": "sphere"}, "must be auto, equirect"),
        ({"layout": "octahedral"}, "sky.exr"),
        ({"scale": 0}, "above 0"),
        ({"scale": np.nan}, "finite"),
        ({"rotate_y": np.inf}, "finite"),
        ({"pad": "white"}, "must be black or edge"),
        ({"strict": True, "sanitize": True}, "contradict"),
    ]:
        with pytest.raises(ValueError, match=words):
            Environment.from_file(sky_file, **options)
    for path, words in [
        (3, "`path` is of the type int; a path, or a list of six, is needed"),
        (None, "NoneType"),
        (b"sky.exr", "of the type bytes"),
        ([1], "of the type list"),
    ]:
        with pytest.raises(TypeError, match=words):
            Environment.from_file(path)
    with pytest.raises(ValueError, match="six face files, got 0"):
        Environment.from_file([])
    with pytest.raises(OSError, match="NUL byte"):
        Environment.from_file("sky\0.exr")


def radiance_file(path, rows, columns):
    """A Radiance file, flat, of one grey."""
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n".encode()
    path.write_bytes(header + bytes([128, 128, 128, 129]) * (rows * columns))


def test_repairs_are_warnings(tmp_path):
    radiance_file(tmp_path / "band.hdr", 4, 16)
    with pytest.raises(octagloss.InputError, match="band.hdr"):
        Environment.from_file(tmp_path / "band.hdr")
    with pytest.warns(UserWarning, match="band.hdr: "):
        padded = Environment.from_file(tmp_path / "band.hdr", pad="black")
    assert padded.shape == (8, 16, 3) and len(padded.warnings) == 1
    assert padded.repaired["negative"] == 0 and padded.texels[0].max() == 0


def test_rotation_carries_z_to_x():
    texels = np.zeros((64, 128, 3), np.float32)
    centres, _ = Environment.from_array(texels).texel_directions()
    texels[centres[..., 2] > 0.9] = 1.0
    lit = Environment.from_array(texels)
    assert lit.reflect([0, 0, 1], 0.1)[0] > 0.9 and lit.reflect([1, 0, 0], 0.1)[0] < 0.1
    turned = lit.rotated_y(90)
    assert turned.reflect([1, 0, 0], 0.1)[0] > 0.9 and turned.reflect([0, 0, 1], 0.1)[0] < 0.1
    mirrored = Environment.from_array(texels, mirror=True)
    assert mirrored.reflect([0, 0, -1], 0.1)[0] > 0.9
    with pytest.raises(ValueError, match="finite"):
        lit.rotated_y(np.nan)
