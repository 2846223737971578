"""Bakes to arrays and to files: the bytes of the command line."""

import json

import numpy as np
import pytest

import octagloss
from octagloss import Environment

SMALL = {"size": 16, "levels": 3}
SMALL_ARGUMENTS = ["--size", "16", "--levels", "3", "--engine", "cpu", "--quiet"]


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    "options, arguments",
    [
        pytest.param({}, [], marks=pytest.mark.smoke),
        ({"pixel": "rgb9e5", "ladder": "filament"}, ["--pixel", "rgb9e5", "--ladder", "filament"]),
        ({"lobe": "cone", "filter": "adaptive:0.02"}, ["--lobe", "cone", "--filter", "adaptive:0.02"]),
        ({"chain": "solved"}, ["--chain", "solved"]),
        ({"overflow": "compress"}, ["--overflow", "compress"]),
    ],
)
def test_files_are_the_bytes_of_the_command_lines(program, sky, sky_file, tmp_path, options, arguments):
    program("bake", sky_file, "-o", "theirs.ktx2", *SMALL_ARGUMENTS, *arguments)
    octagloss.bake(sky, **SMALL, output=tmp_path / "ours.ktx2", **options)
    assert (tmp_path / "ours.ktx2").read_bytes() == (tmp_path / "theirs.ktx2").read_bytes()


def test_suns_are_those_of_the_command_line(program, sky, sky_file, tmp_path):
    program("bake", sky_file, "-o", "theirs.ktx2", *SMALL_ARGUMENTS, "--extract-sun=1")
    rest, suns = sky.extract_suns(1)
    octagloss.bake(rest, **SMALL, output=tmp_path / "one.ktx2")
    assert len(suns) == 1
    assert (tmp_path / "one.ktx2").read_bytes() == (tmp_path / "theirs.ktx2").read_bytes()
    sun = suns[0]
    towards = f"{sun.azimuth_degrees},{sun.elevation_degrees}:0,-90"
    with pytest.warns(UserWarning, match="no light stands out"):
        rest, again = sky.extract_suns(towards)
    assert [found.direction for found in again] == [sun.direction]
    for which in (0, 33, "up", 1.5):
        with pytest.raises(ValueError, match="`which` is"):
            sky.extract_suns(which)


@pytest.mark.filterwarnings("ignore:.* texels exceed the range")
@pytest.mark.parametrize("target", ["three", "filament", "oem", "babylon"])
def test_targets_are_the_bytes_of_the_command_lines(program, sky, sky_file, tmp_path, target):
    size = 64 if target == "babylon" else 32
    arguments = ["--size", size, "--engine", "cpu", "--quiet"]
    program("bake", sky_file, "--target", target, "-o", "theirs", *arguments)
    bake = octagloss.bake(sky, target=target, size=size, output=tmp_path / "ours")
    assert bake.target == target
    ours, theirs = files(tmp_path / "ours"), files(tmp_path / "theirs")
    report, their_report = json.loads(ours.pop("report.json")), json.loads(theirs.pop("report.json"))
    assert ours.keys() == theirs.keys()
    for name, content in ours.items():
        assert content == theirs[name], name
    for part in [report, their_report]:
        # The program measures the typical error.
        for key in ["seconds", "input", "input_files", "fingerprint", "typical_error"]:
            part.pop(key, None)
        for level in part["levels"] + part.get("sheen", []):
            level.pop("seconds")
    # The remedies have other names.
    warned, they_warned = report.pop("warnings"), their_report.pop("warnings")
    assert [text.split(",")[0] for text in warned] == [text.split(",")[0] for text in they_warned]
    assert report == their_report


def test_levels_are_arrays(sky, tmp_path):
    bake = octagloss.bake(sky, **SMALL, bounds=True, irradiance=4, skybox=8)
    assert [level.roughness for level in bake.levels] == [0.0, 0.5, 1.0]
    assert [level.texels.shape for level in bake.levels] == [(6, n, n, 3) for n in [16, 8, 4]]
    mirror, middle, _ = bake.levels
    assert mirror.bounds is None and middle.bounds.shape == (6, 8, 8)
    np.testing.assert_allclose(middle.error_bound_max, middle.bounds.max())
    assert middle.leaves_per_texel > 0 and middle.error_bound_mean < middle.error_bound_max
    assert not middle.texels.flags.owndata and not middle.texels.flags.writeable
    assert bake.irradiance.texels.shape == (6, 4, 4, 3) and bake.skybox.texels.shape == (6, 8, 8, 3)
    assert bake.sh.shape == (9, 3) and bake.sheen == [] and bake.target is None
    np.testing.assert_allclose(bake.source_energy, bake.oem_energy, rtol=1e-5)
    # The middle of a texel is the query along it.
    centres, _ = Environment.from_array(middle.texels, "cube").texel_directions()
    queried = sky.reflect(centres, 0.5, oem_size=bake.oem_size, filter="adaptive:0.001")
    np.testing.assert_allclose(middle.texels, queried, rtol=0.03)
    bake.write(tmp_path / "late.ktx2", pixel="f32")
    np.testing.assert_array_equal(Environment.from_file(tmp_path / "late.ktx2").texels, mirror.texels)
    assert {path.name for path in tmp_path.iterdir()} >= {
        "late.ktx2",
        "late.irradiance.ktx2",
        "late.skybox.ktx2",
    }


def test_levels_may_be_panoramas_and_octahedral_squares(sky, tmp_path):
    panorama = octagloss.bake(
        sky, layout="panorama", size=8, levels=2, output=tmp_path / "p", container="hdr"
    )
    assert [level.texels.shape for level in panorama.levels] == [(8, 16, 3), (4, 8, 3)]
    assert (tmp_path / "p/m0.hdr").is_file()
    octahedral = octagloss.bake(sky, layout="octahedral", size=8, levels=1)
    assert octahedral.levels[0].texels.shape == (8, 8, 3) and octahedral.levels[0].layout == "octahedral"


def test_outputs_are_kept_unless_forced(sky, tmp_path):
    path = tmp_path / "a.ktx2"
    octagloss.bake(sky, **SMALL, output=path)
    before = path.read_bytes()
    with pytest.raises(FileExistsError, match="a.ktx2: already exists; `force` replaces it"):
        octagloss.bake(sky, size=8, levels=1, output=path)
    assert path.read_bytes() == before
    octagloss.bake(sky, size=8, levels=1, output=path, force=True)
    assert path.read_bytes() != before
    with pytest.raises(FileExistsError):
        octagloss.bake(sky, size=8, levels=1).write(path)
    assert [p.name for p in tmp_path.iterdir()] == ["a.ktx2"]


def test_sunless_bakes_record_the_sun(program, sky, sky_file, tmp_path):
    program("bake", sky_file, "-o", "theirs.ktx2", "--extract-sun", *SMALL_ARGUMENTS)
    rest, _ = sky.extract_sun()
    octagloss.bake(rest, **SMALL, output=tmp_path / "ours.ktx2")
    assert (tmp_path / "ours.ktx2").read_bytes() == (tmp_path / "theirs.ktx2").read_bytes()


@pytest.mark.parametrize(
    "options, error, words",
    [
        ({"size": 0}, ValueError, "`size` is 0; it must be 1 to 16384"),
        ({"size": 8, "levels": 9}, ValueError, "too many for `size` 8; at most 4"),
        ({"size": 16000}, MemoryError, "`size`"),
        ({"levels": 0}, ValueError, "`levels` is 0; it must be 1 to 15"),
        ({"ladder": "rope"}, ValueError, "must be linear, filament"),
        ({"layout": "sphere"}, ValueError, "choose one of cube"),
        ({"layout": "panorama", "target": "three"}, ValueError, "target three needs cube"),
        ({"chain": "iron"}, ValueError, "sampled, solved"),
        ({"chain": "solved", "bounds": True}, ValueError, "`bounds`"),
        ({"target": "doom"}, ValueError, "three, filament, bevy"),
        ({"target": "three", "bounds": True}, ValueError, "no `target`"),
        ({"filter": "box", "bounds": True}, ValueError, "adaptive:E"),
        ({"lobe": "cosine", "levels": 2}, ValueError, "omit `levels`"),
        ({"irradiance": 0}, ValueError, "`irradiance` is 0; it must be 1 to 1024"),
        ({"skybox": 0}, ValueError, "1 to 16384"),
        ({"skybox": "sink"}, ValueError, "or source"),
        ({"sh_order": 7}, ValueError, "2 to 4"),
        ({"sh_window": "glass"}, ValueError, "`sh_window`"),
        ({"output": "a.png"}, ValueError, "set `container`"),
        ({"output": "no/such/a.ktx2"}, FileNotFoundError, "no/such"),
        ({"output": "a.ktx2", "container": "exr"}, ValueError, "omit the extension"),
        ({"output": "a.ktx2", "pixel": "f8"}, ValueError, "must be f16, f32"),
        ({"output": "a.ktx2", "name": "sky"}, ValueError, "for targets"),
        ({"output": "a.ktx2", "target": "three"}, ValueError, "omit the extension"),
        ({"output": "a", "target": "three", "name": "a/b"}, ValueError, "without folders"),
        ({"output": "a", "target": "babylon", "pixel": "f16"}, ValueError, "fixed format"),
        ({"output": "a", "target": "oem", "container": "dds"}, ValueError, "ktx2 or exr"),
        ({"output": "a.ktx2", "layout": "panorama"}, ValueError, "exr and hdr"),
        ({"output": "a.ktx2", "overflow": "flow"}, ValueError, "clamp, compress or error"),
        ({"container": "ktx2"}, ValueError, "`output`, which is missing"),
        ({"sizes": 8}, ValueError, "no option `sizes`"),
        ({"mirror": True}, ValueError, "no option `mirror`; Environment.from_file"),
        ({"scale": float("nan")}, ValueError, "no option `scale`"),
        ({"border": "wide"}, ValueError, "a whole number is needed"),
    ],
)
def test_wrong_arguments_are_named_and_nothing_is_written(lamp, tmp_path, monkeypatch, options, error, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=words):
        octagloss.bake(lamp, **{"size": 8, **options})
    assert list(tmp_path.iterdir()) == []


def test_light_beyond_the_pixels_is_a_warning(tmp_path):
    texels = np.full((8, 16, 3), 1e6, np.float32)
    bright = Environment.from_array(texels)
    with pytest.warns(UserWarning, match="exceed the range of f16 and were clamped"):
        octagloss.bake(bright, size=4, levels=1, output=tmp_path / "a.ktx2")
    with pytest.raises(ValueError, match="f16"):
        octagloss.bake(bright, size=4, levels=1, output=tmp_path / "b.ktx2", overflow="error")
    assert not (tmp_path / "b.ktx2").exists()


def test_the_dfg_table_is_that_of_the_command_line(program, tmp_path):
    program("dfg", "-o", "theirs.exr", "--size", "16", "--charlie", "--quiet")
    # A square image, half floats.
    theirs = Environment.from_file(tmp_path / "theirs.exr").texels
    ours = octagloss.dfg(16, charlie=True)
    assert ours.shape == (16, 16, 3) and ours.dtype == np.float32
    np.testing.assert_array_equal(ours.astype(np.float16), theirs)
    assert octagloss.dfg(8).shape == (8, 8, 2)
    multiple = octagloss.dfg(16, form="multiple-scattering")
    np.testing.assert_allclose(multiple[..., 1], ours[..., 0] + ours[..., 1], rtol=1e-5)
    for arguments, words in [({"size": 0}, "1 to 1024"), ({"form": "sum"}, "choose one of split-sum")]:
        with pytest.raises(ValueError, match=words):
            octagloss.dfg(**arguments)
