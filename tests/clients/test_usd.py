"""tides.usd against OpenUSD itself: scenes written by usd-core's API read to the same numbers, wherever prims are placed, and
written scenes read back. Harmonics are compared with scipy's."""

import subprocess
import sys

import numpy as np
import pytest
import readers
import tides

readers.import_client("pxr")
import tides.usd  # noqa: E402
from pxr import Gf, Sdf, Usd, UsdGeom, UsdVol, Vt  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402
from scipy.special import sph_harm_y  # noqa: E402

N = 40
ROW = {"positions": 3, "orientations": 4, "scales": 3, "opacities": None}


def numbers(seed, degree, n=N):
    """Of n particles, as USD has them; quaternions wxyz."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(n, 4))
    return {
        "positions": rng.normal(size=(n, 3)),
        "orientations": q / np.linalg.norm(q, axis=1, keepdims=True),
        "scales": np.exp(rng.normal(-3, 0.7, (n, 3))),
        "opacities": rng.uniform(0.02, 0.98, n),
        "harmonics": rng.normal(0, 0.3, (n, (degree + 1) ** 2, 3)),
    }


def fill(stage, path, values, half=False, code=Usd.TimeCode.Default(), names=None):
    """A prim of those values by the schema's own functions; the values as they were rounded."""
    splat, h, kind = UsdVol.ParticleField3DGaussianSplat.Define(stage, path), "h" * half, np.float16 if half else np.float32
    rounded = {name: value.astype(kind).astype(np.float64) for name, value in values.items()}
    degree = round(values["harmonics"].shape[1] ** 0.5) - 1
    vector, number = (Vt.Vec3hArray, Vt.HalfArray) if half else (Vt.Vec3fArray, Vt.FloatArray)
    rows = {name: value.astype(kind) for name, value in values.items()}
    given = {
        "Positions": vector.FromNumpy(rows["positions"]),
        "Orientations": [(Gf.Quath if half else Gf.Quatf)(*map(float, one)) for one in rows["orientations"]],
        "Scales": vector.FromNumpy(rows["scales"]),
        "Opacities": number.FromNumpy(rows["opacities"]),
        "RadianceSphericalHarmonicsCoefficients": vector.FromNumpy(np.ascontiguousarray(rows["harmonics"].reshape(-1, 3))),
    }
    for name, value in given.items():
        if names is None or name in names:
            getattr(splat, f"Create{name}{h}Attr")().Set(value, code)
    splat.CreateRadianceSphericalHarmonicsDegreeAttr().Set(degree)
    return splat, rounded


def check(gaussians, values, tolerance=3e-7):
    """Equal to float32's rounding, quaternions to sign and length."""

    def near(got, wanted, name):
        assert np.allclose(got, wanted, rtol=tolerance, atol=tolerance), name

    near(gaussians.mean, values["positions"], "positions")
    near(np.exp(gaussians.log_scale.astype(np.float64)) / values["scales"], 1, "scales")
    near(1 / (1 + np.exp(-gaussians.opacity_logit.astype(np.float64))), values["opacities"], "opacities")
    near(gaussians.sh, values["harmonics"], "harmonics")
    a, b = (one / np.linalg.norm(one, axis=1, keepdims=True) for one in (gaussians.quaternion.astype(np.float64), values["orientations"]))
    near(np.abs((a * b).sum(1)), 1, "orientations")


def covariances(gaussians):
    q, scale = gaussians.quaternion.astype(np.float64), np.exp(gaussians.log_scale.astype(np.float64))
    m = Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_matrix() * scale[:, None, :]
    return m @ m.transpose(0, 2, 1)


def colours(sh, directions):
    """Of coefficients (n x k x 3) in directions (d x 3), by scipy's harmonics: INRIA's basis is the real one of those."""
    x, y, z = directions.T
    polar, around, basis = np.arccos(np.clip(z, -1, 1)), np.arctan2(y, x), []
    for degree in range(round(sh.shape[1] ** 0.5)):
        for m in range(-degree, degree + 1):
            value = sph_harm_y(degree, abs(m), polar, around)
            basis.append(value.real if m == 0 else np.sqrt(2) * (value.real if m > 0 else value.imag))
    return np.einsum("kd,nkc->ndc", np.array(basis), sh.astype(np.float64))


# -- numbers ---------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("half", [False, True], ids=["float", "half"])
@pytest.mark.parametrize("ending", ["usda", "usdc"])
def test_the_numbers_of_usd_core(tmp_path, half, ending):
    file = str(tmp_path / f"a.{ending}")
    stage = Usd.Stage.CreateNew(file)
    made = [fill(stage, f"/a{degree}", numbers(degree, degree), half)[1] for degree in range(5)]
    stage.Save()
    scene = tides.usd.read(file)
    assert [one.name for one in map(scene.__getitem__, range(5))] == [f"/a{degree}" for degree in range(5)]
    for index, values in enumerate(made):
        one = scene[index]
        assert one.trajectory is None and one.motion is None and one.scale == 1
        assert one.gaussians.mean.dtype == np.float32 and (one.gaussians.mean == values["positions"].astype(np.float32)).all()
        assert (one.gaussians.sh == values["harmonics"].astype(np.float32)).all()
        check(one.gaussians, values, 1e-3 if half else 3e-7)  # a half's quaternion isn't of length 1


def test_floats_win_over_halves(tmp_path):
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    fill(stage, "/a", numbers(1, 1), half=True)
    _, values = fill(stage, "/a", numbers(2, 1))
    stage.GetPrimAtPath("/a").GetAttribute("scales").Set(Vt.Vec3fArray())  # nothing in it: the halves are meant
    stage.Save()
    scale = numbers(1, 1)["scales"].astype(np.float16).astype(np.float64)
    check(tides.usd.read(tmp_path / "a.usda")[0].gaussians, {**values, "scales": scale})


def test_what_lacks_and_what_is_too_long(tmp_path):
    file = str(tmp_path / "a.usda")
    stage = Usd.Stage.CreateNew(file)
    splat, values = fill(stage, "/a", numbers(3, 0), names={"Positions"})
    splat.CreateScalesAttr().Set([(1, 2, 3)] * (N + 1))
    splat.CreateOpacitiesAttr().Set([0.5] * (N - 1))
    stage.Save()
    with pytest.warns(UserWarning, match="scales has 41 rows.*cut") as told:
        one = tides.usd.read(file)[0].gaussians
    told = "\n".join(str(each.message) for each in told)
    assert "opacities has 39 rows" in told and "grey" in told
    check(one, {**values, "orientations": np.tile([1.0, 0, 0, 0], (N, 1)), "scales": np.tile([1.0, 2, 3], (N, 1)),
                "opacities": np.ones(N), "harmonics": np.zeros((N, 1, 3))}, 2e-7)


# -- places ----------------------------------------------------------------------------------------------------------------
MAPS = {
    "turned": lambda form: (form.AddTranslateOp().Set((1, -2, 3)), form.AddRotateXYZOp().Set((20, -110, 45))),
    "scaled": lambda form: (form.AddRotateXYZOp().Set((10, 20, 30)), form.AddScaleOp().Set((2.5, 2.5, 2.5))),
    "stretched": lambda form: (form.AddRotateXYZOp().Set((10, 20, 30)), form.AddScaleOp().Set((2, 0.5, 1))),
    "mirrored": lambda form: (form.AddRotateXYZOp().Set((10, 20, 30)), form.AddScaleOp().Set((-2, 2, 2))),
}


@pytest.mark.parametrize("how", MAPS)
@pytest.mark.parametrize("degree", [0, 2, 4])
def test_parents_transforms(tmp_path, how, degree):
    file = str(tmp_path / "a.usda")
    stage = Usd.Stage.CreateNew(file)
    MAPS[how](UsdGeom.Xform.Define(stage, "/up"))
    UsdGeom.Xform.Define(stage, "/up/middle").AddTranslateOp().Set((5, 6, 7))
    splat, values = fill(stage, "/up/middle/a", numbers(5, degree))
    splat.AddRotateZOp().Set(33)
    stage.Save()
    if how == "stretched" and degree:
        with pytest.warns(UserWarning, match="stretched"):
            got = tides.usd.read(file)[0].gaussians
    else:
        got = tides.usd.read(file)[0].gaussians
    matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(splat.GetPrim()))
    a, shift = matrix[:3, :3].T, matrix[3, :3]
    assert np.allclose(got.mean, values["positions"] @ a.T + shift, atol=1e-6)
    local = tides.Gaussians(values["positions"], np.log(values["scales"]), values["orientations"], np.zeros(N), values["harmonics"])
    assert np.allclose(covariances(got), a @ covariances(local) @ a.T, rtol=1e-5, atol=1e-7)
    if how != "stretched":  # what is seen along a d is what was seen along d
        d = np.random.default_rng(9).normal(size=(60, 3))
        d /= np.linalg.norm(d, axis=1, keepdims=True)
        seen = d @ a.T
        seen /= np.linalg.norm(seen, axis=1, keepdims=True)
        assert np.allclose(colours(got.sh, seen), colours(values["harmonics"], d), atol=2e-6)


def test_what_stage_and_prims_say(tmp_path):
    file = str(tmp_path / "a.usdc")
    stage = Usd.Stage.CreateNew(file)
    UsdGeom.SetStageUpAxis(stage, "Z")
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    for name in ("shown", "hidden", "stand_in"):
        fill(stage, f"/{name}/a", numbers(1, 0))
    UsdGeom.Imageable(UsdGeom.Scope.Define(stage, "/hidden")).MakeInvisible()
    UsdGeom.Imageable(UsdGeom.Scope.Define(stage, "/stand_in")).CreatePurposeAttr().Set("proxy")
    for index in range(2):  # two copies of one thing
        copy = UsdGeom.Xform.Define(stage, f"/copy{index}")
        copy.AddTranslateOp().Set((10 * index, 0, 0))
        copy.GetPrim().GetReferences().AddInternalReference("/shown")
        copy.GetPrim().SetInstanceable(True)
    stage.Save()
    scene = tides.usd.read(file)
    assert [scene[i].name for i in range(len(scene))] == ["/shown/a", "/copy0/a", "/copy1/a"]
    assert np.allclose(scene[2].gaussians.mean, scene[0].gaussians.mean + [10, 0, 0], atol=1e-6)
    assert scene.up == (0, 0, 1) and tides.usd.metres_per_unit(file) == 0.01
    assert len(tides.usd.read(file, part="/copy1")) == 1
    with pytest.raises(tides.errors.BadFile, match="at or below /nowhere"):
        tides.usd.read(file, part="/nowhere")


@pytest.mark.parametrize("name, wanted", [("lin_rec709_scene", ("linear", 0)), ("srgb_rec709_scene", ("srgb", 0)), ("", ("srgb", 0)),
                                          ("g22_rec709_scene", ("gamma", 2.2)), ("raw", ("srgb", 0))])
@pytest.mark.parametrize("where", ["attribute", "above"])
def test_colour_spaces(tmp_path, name, wanted, where):
    file = str(tmp_path / "a.usda")
    stage = Usd.Stage.CreateNew(file)
    splat, _ = fill(stage, "/up/a", numbers(1, 1))
    if name and where == "attribute":
        splat.GetRadianceSphericalHarmonicsCoefficientsAttr().SetColorSpace(name)
    elif name:
        Usd.ColorSpaceAPI.Apply(stage.DefinePrim("/up", "Xform")).CreateColorSpaceNameAttr().Set(name)
    stage.Save()
    one = tides.usd.read(file)[0].gaussians
    assert (one.transfer, one.gamma) == wanted
    assert tides.usd.read(file, transfer="linear").transfer == "linear"


# -- time ------------------------------------------------------------------------------------------------------------------
def test_a_turning_parent_is_a_trajectory(tmp_path):
    file = str(tmp_path / "a.usda")
    stage = Usd.Stage.CreateNew(file)
    stage.SetTimeCodesPerSecond(25)
    stage.SetStartTimeCode(1001)
    stage.SetEndTimeCode(1061)
    form = UsdGeom.Xform.Define(stage, "/up")
    turn, scale = form.AddRotateYOp(), form.AddScaleOp()
    scale.Set((0.5, 0.5, 0.5))
    turn.Set(0, 1011)
    turn.Set(720, 1051)  # two turns between two samples: USD joins angles by a line
    splat, values = fill(stage, "/up/a", numbers(1, 1))
    splat.AddTranslateOp().Set((3, 0, 0))
    stage.Save()
    one = tides.usd.read(file)[0]
    assert one.motion is None and np.allclose(one.trajectory.range, (0, 60 / 25)) and np.isclose(one.scale, 0.5)
    check(one.gaussians, values)
    for code in np.linspace(1001, 1061, 61):
        pose = one.trajectory.at((code - 1001) / 25)
        matrix = np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(splat.GetPrim()))
        assert np.allclose(one.scale * pose.rotation, matrix[:3, :3].T, atol=1e-6) and np.allclose(pose.position, matrix[3, :3], atol=1e-6)
    assert np.abs(one.trajectory.at(5.5 / 25).position - one.trajectory.at(0).position).max() < 1e-3  # held
    between = one.trajectory.at(20.5 / 25)
    matrix = np.array(UsdGeom.XformCache(1021.5).GetLocalToWorldTransform(splat.GetPrim()))
    assert np.allclose(0.5 * between.rotation, matrix[:3, :3].T, atol=1e-3)


def test_sampled_arrays_are_keyframes(tmp_path):
    file = str(tmp_path / "a.usdc")
    stage = Usd.Stage.CreateNew(file)
    UsdGeom.Xform.Define(stage, "/up").AddRotateXOp().Set(90)
    frames = {}
    for code in (0, 6, 12, 24):
        _, frames[code] = fill(stage, "/up/a", numbers(code, 1), code=code)
    fill(stage, "/still", numbers(7, 2))
    stage.Save()
    scene = tides.usd.read(file)
    assert scene[0].motion == "keyframes" and scene[0].duration_s == 1 and scene[1].motion is None and scene.range == (0, 1)
    a = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    for code, values in frames.items():
        got = scene.gaussians_at(0, code / 24)
        assert np.allclose(got.mean, values["positions"] @ a.T, atol=1e-5)
        assert np.allclose(np.exp(got.log_scale), values["scales"], rtol=1e-5)
        assert np.allclose(1 / (1 + np.exp(-got.opacity_logit)), values["opacities"], atol=1e-6)
        d = np.eye(3)
        assert np.allclose(colours(got.sh, d @ a.T), colours(values["harmonics"], d), atol=1e-5)


def test_keyframes_that_begin_late_hold_still(tmp_path):
    file = str(tmp_path / "a.usdc")
    stage = Usd.Stage.CreateNew(file)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(240)
    first, last = (fill(stage, "/a", numbers(code, 1), code=code)[1] for code in (100, 130))
    stage.Save()
    scene = tides.usd.read(file)
    assert scene[0].duration_s == 10
    for time, values in ((0, first), (2, first), (99 / 24, first), (100 / 24, first), (130 / 24, last), (131 / 24, last), (7, last), (10, last)):
        check(scene.gaussians_at(0, time), values, 3e-6)


def test_a_growing_thing_is_keyframes(tmp_path):
    file = str(tmp_path / "a.usda")
    stage = Usd.Stage.CreateNew(file)
    splat, values = fill(stage, "/a", numbers(1, 0))
    scale = splat.AddScaleOp()
    scale.Set((1, 1, 1), 0)
    scale.Set((3, 3, 3), 24)
    stage.Save()
    scene = tides.usd.read(file)
    for code in range(25):
        grown = 1 + 2 * code / 24
        got = scene.gaussians_at(0, code / 24)
        assert np.allclose(got.mean, grown * values["positions"], atol=1e-5)
        assert np.allclose(np.exp(got.log_scale), grown * values["scales"], rtol=1e-5)


def test_what_vanishes_is_said(tmp_path):
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    for name, first in (("a", "inherited"), ("b", "invisible")):
        fill(stage, f"/{name}/splats", numbers(1, 0))
        seen = UsdGeom.Xform.Define(stage, f"/{name}").GetVisibilityAttr()
        seen.Set(first, 0)
        seen.Set("invisible" if first == "inherited" else "inherited", 5)
    stage.Save()
    with pytest.warns(UserWarning, match="appears or vanishes"):
        scene = tides.usd.read(tmp_path / "a.usda")
    assert [scene[i].name for i in range(len(scene))] == ["/a/splats"]


def test_refused(tmp_path):
    file = str(tmp_path / "a.usda")

    def refused(make, kind, words):
        stage = Usd.Stage.CreateInMemory()
        splat, _ = fill(stage, "/a/b", numbers(1, 0))
        make(stage, splat)
        stage.Export(file)
        with pytest.raises(kind, match=words):
            tides.usd.read(file)

    def stretches(_, splat):
        scale = splat.AddScaleOp()
        scale.Set((1, 1, 1), 0)
        scale.Set((1, 2, 1), 9)

    def comes(_, splat):
        splat.GetPositionsAttr().Set([(0, 0, 0)] * N, 0)
        splat.GetPositionsAttr().Set([(0, 0, 0)] * 3, 9)

    bad, unsupported = tides.errors.BadFile, tides.errors.Unsupported
    refused(lambda stage, _: stage.SetDefaultPrim(UsdGeom.PointInstancer.Define(stage, "/a").GetPrim()), unsupported, "PointInstancer")
    refused(stretches, unsupported, "stretched by a transform that changes")
    refused(comes, unsupported, "3 to 40 particles")
    refused(lambda _, splat: splat.GetOpacitiesAttr().Set([1.5] * N), bad, "opacities of particle 0")
    refused(lambda _, splat: splat.GetScalesAttr().Set([(1, -1, 1)] * N), bad, "scales of particle 0")
    refused(lambda _, splat: splat.AddScaleOp().Set((1, 0, 1)), bad, "flattens")
    refused(lambda stage, _: stage.RemovePrim("/a/b"), bad, "no prim is a visible")
    (tmp_path / "bad.usda").write_text("#usda 1.0\ndef nonsense {{{\n")
    (tmp_path / "cut.usdc").write_bytes(b"PXR-USDC" + bytes(20))
    for name in ("bad.usda", "cut.usdc"):
        with pytest.raises(bad, match=name):
            tides.usd.read(tmp_path / name)
    with pytest.raises(FileNotFoundError, match="none.usda"):
        tides.usd.read(tmp_path / "none.usda")


# -- back ------------------------------------------------------------------------------------------------------------------
def gaussians_of(values, **rest):
    logit = np.log(values["opacities"] / (1 - values["opacities"]))
    return tides.Gaussians(values["positions"], np.log(values["scales"]), values["orientations"], logit, values["harmonics"], **rest)


@pytest.mark.parametrize("ending", ["usd", "usda", "usdc", "usdz"])
@pytest.mark.parametrize("half", [False, True], ids=["float", "half"])
def test_what_is_written_reads_back(tmp_path, ending, half):
    scene, file = tides.Scene(), tmp_path / f"a.{ending}"
    for degree in range(5):
        scene.add(gaussians_of(numbers(degree, degree), transfer="gamma", gamma=2.2), name="a thing")
    scene.up = (0, 0, 1)
    tides.usd.write(file, scene, metres_per_unit=0.5, half=half)
    again = tides.usd.read(file)
    assert len(again) == 5 and len({again[i].name for i in range(5)}) == 5
    assert again.up == (0, 0, 1) and again.transfer == "gamma" and tides.usd.metres_per_unit(file) == 0.5
    for degree in range(5):
        check(again[degree].gaussians, numbers(degree, degree), 2e-3 if half else 5e-7)
        assert again[degree].gaussians.gamma == 2.2
    stage = Usd.Stage.Open(str(file))
    prim = stage.GetPrimAtPath("/World/a_thing")
    assert prim.IsA(UsdVol.ParticleField3DGaussianSplat) and not [one for one in prim.GetAuthoredAttributes() if one.IsCustom()]
    assert [one.name for one in tmp_path.iterdir()] == [file.name]


def test_up_and_far_means(tmp_path):
    scene, values = tides.Scene(), numbers(4, 2)
    far = np.array([4.1e6, 2e5, -3e6])
    scene.add(gaussians_of({**values, "positions": 0.01 * values["positions"] + far}), name="far")
    scene.up = (0, -1, 0)
    tides.usd.write(tmp_path / "a.usdc", scene)
    got = tides.usd.read(tmp_path / "a.usdc")
    assert got.up == (0, 1, 0)
    stage = Usd.Stage.Open(str(tmp_path / "a.usdc"))
    turn = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(stage.GetPrimAtPath("/World")))[:3, :3]
    assert np.allclose((0, -1, 0) @ turn, (0, 1, 0))
    assert np.abs(got[0].gaussians.mean - (0.01 * values["positions"] + far) @ turn).max() < 1e-8 * np.abs(far).max()
    assert np.abs(got[0].gaussians.mean - np.median(got[0].gaussians.mean, 0)).max() < 0.1


def test_what_moves_reads_back(tmp_path):
    scene, key = tides.Scene(), [numbers(seed, 1) for seed in (1, 2, 3)]
    path = tides.Trajectory.orbit(radius=4, angular_speed=2, start=0, stop=1)
    scene.add(gaussians_of(numbers(9, 1)), path, 1.5, "rigid")
    stack = {name: np.array([one[name] for one in key]) for name in key[0]}
    logit = np.log(stack["opacities"] / (1 - stack["opacities"]))
    motion = tides.Motion.keyframes([0, 0.5, 1], stack["positions"], stack["orientations"], np.log(stack["scales"]), logit, stack["harmonics"])
    scene.add(gaussians_of(key[0]), None, 1.0, "moving", motion)
    tides.usd.write(tmp_path / "a.usdc", scene, fps=24)
    again = tides.usd.read(tmp_path / "a.usdc")
    assert again[0].trajectory is not None and np.isclose(again[0].scale, 1.5) and again[1].motion == "keyframes"
    for time in np.arange(25) / 24:
        a, b = path.at(time), again[0].trajectory.at(time)
        assert np.allclose(a.rotation, b.rotation, atol=1e-6) and np.allclose(a.position, b.position, atol=1e-9)
        a, b = scene.gaussians_at(1, time), again.gaussians_at(1, time)
        assert np.allclose(a.mean, b.mean, atol=1e-5) and np.allclose(covariances(a), covariances(b), atol=1e-6)
        assert np.allclose(a.sh, b.sh, atol=1e-5)


def test_the_command(tmp_path):
    def run(*arguments):
        done = subprocess.run([sys.executable, "-m", "tides.usd", *map(str, arguments)], capture_output=True, text=True)
        assert "Traceback" not in done.stderr
        return done.returncode, done.stdout, done.stderr

    scene = tides.Scene()
    scene.add(gaussians_of(numbers(1, 1)), name="a")
    scene.save(tmp_path / "a.ply")
    assert run(tmp_path / "a.ply", tmp_path / "b.usda", "--metres-per-unit", 0.25) == (0, f"{tmp_path}/b.usda: 1 objects, 40 Gaussians, colours linear\n", "")
    code, out, error = run(tmp_path / "b.usda", tmp_path / "c.h5")
    assert code == 0 and "scene.metres_per_unit=0.25" in out and not error
    check(tides.Scene(tmp_path / "c.h5")[0].gaussians, numbers(1, 1))
    assert run("-q", tmp_path / "b.usda", tmp_path / "d.h5", "--transfer", "srgb")[:2] == (0, "")
    assert tides.Scene(tmp_path / "d.h5").transfer == "srgb"
    for arguments, words in (((tmp_path / "none.usda", tmp_path / "x.h5"), "none.usda"), ((tmp_path / "a.ply", tmp_path / "x.foo"), "saved as"),
                             ((tmp_path / "b.usda", tmp_path / "b.usda"), "b.usda"), ((tmp_path / "a.ply", "gone/b.usda"), "gone")):
        code, out, error = run(*arguments)
        assert code == 1 and words in error and len(error.splitlines()) == 1, error
