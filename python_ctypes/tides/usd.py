"""OpenUSD scenes: Gaussians of ParticleField3DGaussianSplat, which Isaac Sim, Houdini and Arnold write (OpenUSD 26.03).

    import tides.usd
    scene = tides.usd.read("scene.usdc")                        # .usd, .usda, .usdc, .usdz
    tides.usd.write("out.usdz", scene)

    python -m tides.usd scene.usdc scene.h5                     # and back: python -m tides.usd scene.h5 scene.usdz

The scene has the stage's axes and units: `scene.up` is its upAxis, `metres_per_unit(file)` what scene.metres_per_unit wants.
Second 0 is the stage's startTimeCode, or its first time sample where it has none. It needs the usd-core package: pip install
tides[usd].
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

try:
    from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdUtils, Vt
except ImportError as missing:
    raise ImportError("tides.usd needs the usd-core package: pip install tides[usd]") from missing

from ._placed import Map, Splats, quaternions
from ._warn import warn
from .errors import BadFile, TidesError, Unsupported
from .files import check_apart, check_writable
from .motion import Motion
from .scene import Gaussians, Scene, SceneObject
from .trajectory import Trajectory

_TYPE = "ParticleField3DGaussianSplat"
_ENDINGS = (".usd", ".usda", ".usdc", ".usdz")
_DEGREE, _HARMONICS = "radiance:sphericalHarmonicsDegree", "radiance:sphericalHarmonicsCoefficients"
_MOST_DEGREE = 4
_CODES_PER_SECOND = 24.0  # of written stages: USD's default


# -- a prim's arrays -------------------------------------------------------------------------------------------------------
def _place(prim: Any) -> str:
    """File and path of a prim, for messages."""
    return f"{prim.GetStage().GetRootLayer().realPath}: {prim.GetPath()}"


def _branch(prim: Any) -> Iterator[Any]:
    """A prim and all prims above it."""
    while prim and not prim.IsPseudoRoot():
        yield prim
        prim = prim.GetParent()


def _attribute(prim: Any, name: str) -> Any:
    """The float form of an array if it has values at its first time, else the half form."""
    for attribute in (prim.GetAttribute(name), prim.GetAttribute(name + "h")):
        if attribute and len(attribute.Get(Usd.TimeCode.EarliestTime()) or ()):
            return attribute
    return None


def _values(prim: Any, name: str, code: float, count: int, missing: Any) -> np.ndarray:
    """An array of `count` rows at a time. By OpenUSD's rules a longer one is cut, and a shorter or absent one becomes
    `missing`."""
    attribute = _attribute(prim, name)
    value = attribute.Get(code) if attribute else None
    rows = 0 if value is None else len(value)
    if rows != count and rows:
        warn(f"{_place(prim)}: {name} has {rows} rows, where its positions ask for {count}: {'cut' if rows > count else 'ignored'}")
    if rows < count:
        return np.broadcast_to(np.asarray(missing, np.float64), (count, *np.shape(missing))).copy()
    made = np.asarray(value, np.float64)[:count]
    return made[:, [3, 0, 1, 2]] if name == "orientations" else made  # USD stores a quaternion's real part last


def _harmonics(prim: Any, code: float, count: int) -> np.ndarray:
    attribute = prim.GetAttribute(_DEGREE)
    degree = attribute.Get() if attribute else 0
    if degree is None or degree < 0:
        raise BadFile(f"{_place(prim)}: {_DEGREE} is {degree}: must be 0 or more")
    if not _attribute(prim, _HARMONICS):
        warn(f"{_place(prim)}: has no {_HARMONICS}: its Gaussians are grey")
        degree = 0
    k = (degree + 1) ** 2
    sh = _values(prim, _HARMONICS, code, count * k, np.zeros(3)).reshape(count, k, 3)
    if degree > _MOST_DEGREE:
        warn(f"{_place(prim)}: harmonics of degree {degree} are read up to {_MOST_DEGREE}")
    return sh[:, : (min(degree, _MOST_DEGREE) + 1) ** 2]


def _splats(prim: Any, code: float) -> Splats:
    attribute = _attribute(prim, "positions")
    mean = np.asarray((attribute.Get(code) if attribute else None) or (), np.float64).reshape(-1, 3)
    if not len(mean):
        raise BadFile(f"{_place(prim)}: has no positions")
    rest = [_values(prim, *one) for one in (("scales", code, len(mean), np.ones(3)), ("orientations", code, len(mean), np.eye(4)[0]))]
    made = Splats(mean, *rest, _values(prim, "opacities", code, len(mean), 1.0), _harmonics(prim, code, len(mean)))
    for name, bad in (("scales", made.scale < 0), ("opacities", (made.opacity < 0) | (made.opacity > 1))):
        if bad.any():
            row = int(np.argwhere(bad)[0][0])
            raise BadFile(f"{_place(prim)}: {name} of particle {row} can't be: {getattr(made, 'scale' if name == 'scales' else 'opacity')[row]}")
    return made


def _transfer(prim: Any) -> tuple[str, float, bool]:
    """The transfer from colours to light, from the colour space of the coefficients, of the prim or of those above it; default
    srgb. Also whether the file tells it."""
    attribute = _attribute(prim, _HARMONICS) or prim.GetAttribute(_HARMONICS)
    name = attribute.GetColorSpace() if attribute else ""
    name = str(name or Usd.ColorSpaceAPI.ComputeColorSpaceName(prim, Usd.ColorSpaceCache()) or "")
    kind, _, primaries = name.partition("_")
    if kind in ("", "raw", "data", "identity", "unknown"):
        return "srgb", 0.0, False
    if not primaries.startswith("rec709"):
        warn(f"{_place(prim)}: colours of {name} keep their numbers: no primaries but Rec. 709's are known here")
    if kind in ("lin", "srgb"):
        return ("linear" if kind == "lin" else "srgb"), 0.0, True
    if kind[:1] == "g" and kind[1:].isdigit():
        return "gamma", int(kind[1:]) / 10, True
    raise Unsupported(f"{_place(prim)}: its colour space {name} is none that is known here: read(transfer=) says what it is")


def _map(prim: Any, code: float) -> Map:
    """The map from a prim's own space to the stage's."""
    matrix = np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(prim))  # row vectors: p' = p matrix
    made = Map(matrix[:3, :3].T.copy(), matrix[3, :3].copy())
    if not np.isfinite(matrix).all() or made.flattens:
        raise BadFile(f"{_place(prim)}: its transform flattens it, or isn't finite")
    return made


# -- time ------------------------------------------------------------------------------------------------------------------
@dataclass
class _Clock:
    """First and last time code of a stage's samples, and time codes per second."""

    first: float
    last: float
    per_second: float

    @classmethod
    def of(cls, stage: Any, samples: Iterable[float]) -> "_Clock":
        codes = list(samples)
        if stage.HasAuthoredMetadata("startTimeCode"):
            codes = [max(one, stage.GetStartTimeCode()) for one in codes] + [stage.GetStartTimeCode()]
        if stage.HasAuthoredMetadata("endTimeCode") and codes:
            codes.append(max(stage.GetEndTimeCode(), codes[0]))
        return cls(min(codes, default=0.0), max(codes, default=0.0), stage.GetTimeCodesPerSecond())

    def times(self, codes: list[float]) -> np.ndarray:
        return (np.array(codes) - self.first) / self.per_second

    def codes(self, samples: Iterable[float], every: float | None = None) -> list[float]:
        """The time codes at which a changing value is read: the `samples` within the clock, and the clock's ends, since values
        are held before the first and after the last sample. `every`: distance of additional codes, for changes that USD doesn't
        interpolate linearly (turns about axes)."""
        inside = sorted(one for one in samples if self.first <= one <= self.last)
        held = [inside[0] - 1, inside[-1] + 1] if inside else []
        more = np.arange(self.first, self.last, every).tolist() if every else []
        return sorted({self.first, self.last, *inside, *more, *(one for one in held if self.first < one < self.last)})

    def holds(self, samples: list[float]) -> bool:
        """Whether values are constant before the first or after the last of `samples`."""
        return self.first < samples[0] or samples[-1] < self.last


def _array_samples(prim: Any) -> list[float]:
    arrays = [_attribute(prim, name) for name in ("positions", "orientations", "scales", "opacities", _HARMONICS)]
    return sorted({code for one in arrays if one and one.GetNumTimeSamples() > 1 for code in one.GetTimeSamples()})


def _xform_samples(prim: Any) -> list[float]:
    forms = [UsdGeom.Xformable(one) for one in _branch(prim) if one.IsA(UsdGeom.Xformable)]
    return sorted({code for form in forms for code in form.GetTimeSamples()})


# -- reading ---------------------------------------------------------------------------------------------------------------
def _rigid(maps: list[Map]) -> bool:
    """Whether the maps differ only by turns and shifts, with one scale for all times."""
    scale = maps[0].scale
    return scale is not None and all(one.scale and abs(one.scale - scale) <= 1e-6 * scale and not one.mirrors for one in maps)


def _path(maps: list[Map], times: np.ndarray) -> Trajectory:
    return Trajectory(times, np.array([one.shift for one in maps]), np.array([one.rotation for one in maps]))


def _keyframes(frames: list[Splats], times: np.ndarray, holds: bool, place: str) -> Motion:
    """A motion of keyframes. `holds`: by curves that are constant between equal frames; splines with rates aren't."""
    counts = sorted({len(one.mean) for one in frames})
    if len(counts) > 1:
        raise Unsupported(f"{place}: has {counts[0]} to {counts[-1]} particles over time: Gaussians neither come nor go here")
    arrays = {name: np.array([getattr(one, name) for one in frames]) for name in ("mean", "quaternion", "log_scale", "opacity_logit", "sh")}
    for name in ("log_scale", "opacity_logit", "sh"):
        if (arrays[name] == arrays[name][0]).all():
            arrays[name] = None
    return Motion.keyframes(times, **arrays, catmull_rom=holds)


def _add(scene: Scene, prim: Any, clock: _Clock, transfer: tuple[str, float]) -> None:
    name, xforms, arrays = str(prim.GetPath()), _xform_samples(prim), _array_samples(prim)
    codes = clock.codes(xforms, 1.0) if len(xforms) > 1 else [clock.first]
    maps = [_map(prim, code) for code in codes]
    still = all(np.array_equal(one.linear, maps[0].linear) and np.array_equal(one.shift, maps[0].shift) for one in maps)
    rigid = not still and _rigid(maps)
    if maps[0].scale is None and _splats(prim, clock.first).sh.shape[1] > 1:
        warn(f"{_place(prim)}: is stretched: its colours follow the rotation alone")
    path, scale = (_path(maps, clock.times(codes)), maps[0].scale) if rigid else (None, 1.0)
    if not still and not rigid:
        if any(one.scale is None for one in maps):
            raise Unsupported(f"{_place(prim)}: is stretched by a transform that changes over time: bake it into the particles")
        arrays = sorted({*arrays, *codes})
    frames = clock.codes(arrays) if len(arrays) > 1 else [clock.first]
    splats = [_splats(prim, code) if rigid else _splats(prim, code).moved(maps[0] if still else _map(prim, code)) for code in frames]
    motion = _keyframes(splats, clock.times(frames), clock.holds(arrays), _place(prim)) if len(frames) > 1 else None
    scene.add(splats[0].gaussians(*transfer), path, scale or 1.0, name, motion)


def _shown(prim: Any) -> bool:
    """Whether a splat prim is drawn: it isn't hidden, a stand-in, or a prototype of an instancer."""
    if prim.GetTypeName() != _TYPE:
        return False
    for one in _branch(prim):
        if one.IsA(UsdGeom.PointInstancer):
            raise Unsupported(f"{_place(prim)}: is what {one.GetPath()} repeats (PointInstancer): make copies of it in USD first")
    what, first = UsdGeom.Imageable(prim), Usd.TimeCode.EarliestTime()
    if any(one.IsA(UsdGeom.Imageable) and UsdGeom.Imageable(one).GetVisibilityAttr().ValueMightBeTimeVarying() for one in _branch(prim)):
        warn(f"{_place(prim)}: appears or vanishes over time: it is taken as it is at first")
    return what.ComputeVisibility(first) != UsdGeom.Tokens.invisible and what.ComputePurpose() not in ("proxy", "guide")


def _open(file: str | os.PathLike[str]) -> Any:
    if not os.path.exists(file):
        raise FileNotFoundError(f"{os.fspath(file)}: can't be opened: there is no such file")
    if not Usd.SchemaRegistry().FindConcretePrimDefinition(_TYPE):
        raise ImportError(f"usd-core {'.'.join(map(str, Usd.GetVersion()))} doesn't know {_TYPE}: pip install 'usd-core>=26.3'")
    try:
        return Usd.Stage.Open(os.fspath(file))
    except Tf.ErrorException as why:
        raise BadFile(f"{os.fspath(file)}: OpenUSD can't read it: {str(why).strip().splitlines()[-1].strip()}") from None


def metres_per_unit(file: str | os.PathLike[str]) -> float:
    """The stage's metersPerUnit, for scene.metres_per_unit; 0 if it has none (USD's default is 0.01)."""
    stage = _open(file)
    return UsdGeom.GetStageMetersPerUnit(stage) if UsdGeom.StageHasAuthoredMetersPerUnit(stage) else 0.0


def read(file: str | os.PathLike[str], transfer: str | None = None, gamma: float = 0.0, part: str | None = None) -> Scene:
    """The scene of a USD file: each visible ParticleField3DGaussianSplat is an object, named by its path, with the transforms
    above it. Where only those change over time, and rigidly, it follows a Trajectory through each frame; other time samples are
    keyframes. Both are joined by a C2 cubic spline, where USD joins by lines (keyframes that begin late or end early: by Catmull
    and Rom's, which hold still before and after). `part`: only the prims there and below. Colours code light as the file's
    colour space says (srgb if it says none), or as `transfer` says ("linear", "srgb", "gamma" with its exponent)."""
    stage = _open(file)
    prims = [one for one in stage.Traverse(Usd.TraverseInstanceProxies()) if _shown(one)]
    if part is not None:
        prims = [one for one in prims if one.GetPath().HasPrefix(Sdf.Path(part))]
    if not prims:
        where = f"nothing at or below {part}" if part else "no prim"
        raise BadFile(f"{os.fspath(file)}: {where} is a visible {_TYPE}: meshes have no Gaussians (train splats on pictures of them)")
    scene = Scene()
    clock = _Clock.of(stage, [code for one in prims for code in (*_array_samples(one), *_xform_samples(one))])
    for prim in prims:
        _add(scene, prim, clock, (transfer, gamma) if transfer else _transfer(prim)[:2])
    if stage.HasAuthoredMetadata("upAxis"):
        scene.up = (0, 0, 1) if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else (0, 1, 0)
    return scene


# -- writing ---------------------------------------------------------------------------------------------------------------
_SPACES = {("linear", 0.0): "lin_rec709_scene", ("srgb", 0.0): "srgb_rec709_scene"}
_SPACES |= {("gamma", g): f"g{10 * g:.0f}_rec709_scene" for g in (1.8, 2.2, 2.4)}  # all that OpenUSD names


def _put(prim: Any, code: Any, half: bool, **arrays: np.ndarray) -> None:
    """Writes arrays of a prim at a time, in float or half."""
    kinds = {"positions": "Point3", "scales": "Float3", "orientations": "Quat", "opacities": "Float", _HARMONICS: "Float3"}
    halves = {"Float3": "Half3", "Float": "Half"}
    for name, value in arrays.items():
        kind = kinds[name]
        kind = halves.get(kind, kind + "h") if half else kind + ("" if kind.startswith("Float") else "f")
        attribute = prim.CreateAttribute(name + "h" * half, getattr(Sdf.ValueTypeNames, kind + "Array"), custom=False)
        value = np.ascontiguousarray(value, np.float16 if half else np.float32)
        if not np.isfinite(value).all():
            raise ValueError(f"{prim.GetPath()}: {name} is beyond what {'half' if half else 'float'} holds")
        letter = "h" if half else "f"
        shape = f"Quat{letter}" if name == "orientations" else f"Vec3{letter}" if value.ndim > 1 else "Half" if half else "Float"
        attribute.Set(getattr(Vt, shape + "Array").FromNumpy(value), code)


def _put_gaussians(prim: Any, code: Any, half: bool, one: Gaussians, origin: np.ndarray) -> None:
    quaternion = one.quaternion.astype(np.float64)
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    mean, scale = one.mean - origin, np.exp(one.log_scale.astype(np.float64))
    opacity = 1 / (1 + np.exp(-one.opacity_logit.astype(np.float64)))
    _put(prim, code, half, positions=mean, scales=scale, orientations=quaternion[:, [1, 2, 3, 0]], opacities=opacity)
    _put(prim, code, half, **{_HARMONICS: one.sh.reshape(-1, 3)})
    reach = 3 * scale.max(1, keepdims=True)  # drawn extent of a Gaussian
    extent = np.array([(mean - reach).min(0), (mean + reach).max(0)], np.float32)
    prim.GetAttribute("extent").Set(Vt.Vec3fArray.FromNumpy(extent), code)


def _frames(start: float, stop: float, more: Iterable[float], fps: float) -> list[float]:
    """Times [s] from 0 on at which a moving object is written."""
    start = max(start, 0.0)
    return sorted({start, stop, *(one for one in more if start <= one <= stop), *(np.arange(np.ceil(start * fps), stop * fps) / fps).tolist()})


def _place_object(prim: Any, one: SceneObject, origin: np.ndarray, fps: float) -> float:
    """Writes an object's trajectory and scale as the prim's transform; returns its last time [s]."""
    form, path, last = UsdGeom.Xformable(prim), one.trajectory, 0.0
    if path is not None:
        shift, turn = form.AddTranslateOp(), form.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
        still = path.is_static
        times = [0.0] if still else _frames(*path.range, path.samples["time"].tolist(), fps)
        for time in times:
            pose, code = path.at(time), Usd.TimeCode.Default() if still else Usd.TimeCode(time * fps)
            q = quaternions(pose.rotation[None])[0]
            shift.Set(Gf.Vec3d(*pose.position), code)
            turn.Set(Gf.Quatd(*map(float, q)), code)
        last = times[-1]
    if one.scale != 1:
        form.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(one.scale))
    if origin.any():
        form.AddTranslateOp(opSuffix="origin").Set(Gf.Vec3d(*origin))
    return last


def _write_object(stage: Any, name: str, scene: Scene, index: int, half: bool, fps: float) -> float:
    one = scene[index]
    prim = stage.DefinePrim(name, _TYPE)
    space = _SPACES.get((one.gaussians.transfer, round(one.gaussians.gamma, 9)))
    if space is None:
        raise Unsupported(f"{one.name}: OpenUSD names no colour space of a gamma of {one.gaussians.gamma:g}: 1.8, 2.2 and 2.4 alone")
    prim.CreateAttribute(_DEGREE, Sdf.ValueTypeNames.Int, False, Sdf.VariabilityUniform).Set(one.gaussians.sh_degree)
    wide = one.gaussians.mean.dtype == np.float64  # positions are floats: the transform gets the rest
    origin = np.round(np.median(one.gaussians.mean, axis=0)) if wide else np.zeros(3)
    last = _place_object(prim, one, origin, fps)
    if one.motion is None:
        _put_gaussians(prim, Usd.TimeCode.Default(), half, one.gaussians, origin)
    else:
        times = _frames(0.0, one.duration_s, (), fps)
        for time in times:
            _put_gaussians(prim, Usd.TimeCode(time * fps), half, scene.gaussians_at(index, time), origin)
        last = max(last, times[-1])
    prim.GetAttribute(_HARMONICS + "h" * half).SetColorSpace(space)
    return last


def _stand(stage: Any, scene: Scene) -> Any:
    """The prim above all objects. It turns up to an axis that a stage can name."""
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    if scene.up is None:
        return world
    up = np.array(scene.up) / np.linalg.norm(scene.up)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z if up[2] == 1 else UsdGeom.Tokens.y)
    if up[1] != 1 and up[2] != 1:
        turn = Gf.Rotation(Gf.Vec3d(*up), Gf.Vec3d(0, 1, 0))
        world.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(turn.GetQuat())
    return world


def _fill(stage: Any, scene: Scene, units: float, half: bool, fps: float) -> None:
    world, taken, last = _stand(stage, scene), set(), 0.0
    if units:
        UsdGeom.SetStageMetersPerUnit(stage, units)
    for index in range(len(scene)):
        name = stem = Tf.MakeValidIdentifier(os.path.basename(scene[index].name) or f"object_{index}")
        while name in taken:
            name = f"{stem}_{len(taken) + 1}"
        taken.add(name)
        last = max(last, _write_object(stage, str(world.GetPath().AppendChild(name)), scene, index, half, fps))
    if last:
        stage.SetTimeCodesPerSecond(fps)
        stage.SetFramesPerSecond(fps)
        stage.SetStartTimeCode(0)
        stage.SetEndTimeCode(last * fps)


def write(file: str | os.PathLike[str], scene: Scene, metres_per_unit: float = 0.0, half: bool = False, fps: float = _CODES_PER_SECOND) -> None:
    """Writes a scene as .usda, .usdc, .usd or .usdz, with a prim below /World for each object, in float or `half`. Motion is
    written at `fps` frames per second from second 0 on, which other programs join by lines: a trajectory as a transform, a
    motion as arrays. If up is neither y nor z, the scene is turned so that it is y. `metres_per_unit` 0: unknown, and not
    written."""
    file = os.fspath(file)
    name, ending = os.path.basename(file), os.path.splitext(file)[1]
    if ending not in _ENDINGS:
        raise ValueError(f"{file}: a USD scene's name ends in {', '.join(_ENDINGS)}")
    if not len(scene) or not fps > 0 or not metres_per_unit >= 0:
        raise ValueError(f"{file}: {'the scene is empty' if not len(scene) else 'fps must be above 0, metres_per_unit 0 or more'}")
    check_apart(scene._files, [file])
    check_writable(file, streams=False)
    if scene.trained != "unknown":
        warn(f"{file}: has no place for how the scene was trained ({scene.trained})")
    with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(file)), prefix=f".{name}.") as folder:
        made = os.path.join(folder, "scene.usdc" if ending == ".usdz" else name)
        stage = Usd.Stage.CreateNew(made)
        _fill(stage, scene, metres_per_unit, half, fps)
        stage.Save()
        if ending == ".usdz":
            plain, made = made, os.path.join(folder, name)
            if not UsdUtils.CreateNewUsdzPackage(plain, made):
                raise OSError(f"{file}: OpenUSD can't pack it")
        os.replace(made, file)


# -- python -m tides.usd ---------------------------------------------------------------------------------------------------
def _is_usd(file: str) -> bool:
    return os.path.splitext(file)[1] in _ENDINGS


def _convert(given: argparse.Namespace) -> str:
    """Reads and writes; returns messages."""
    check_apart([given.input], [given.output])
    transfer = "gamma" if given.gamma else given.transfer
    if _is_usd(given.input):
        scene = read(given.input, transfer, given.gamma, given.part)
    elif transfer or given.part:
        raise ValueError("--transfer, --gamma and --part are for reading USD")
    else:
        scene = Scene(given.input)
    units = given.metres_per_unit or (metres_per_unit(given.input) if _is_usd(given.input) else 0.0)
    if _is_usd(given.output):
        write(given.output, scene, units, given.half, given.fps)
    else:
        scene.save(given.output)
    said = f"{given.output}: {len(scene)} objects, {scene.count} Gaussians, colours {scene.transfer}"
    if scene.up:
        said += ", up {:g} {:g} {:g}".format(*scene.up)
    return said + (f"; give its runs scene.metres_per_unit={units:g}" if units and not _is_usd(given.output) else "")


def main(arguments: list[str] | None = None) -> int:
    """`python -m tides.usd IN OUT`: converts USD to any scene file that TIDES writes, and any that it reads to USD."""
    parser = argparse.ArgumentParser("python -m tides.usd", description=main.__doc__)
    parser.add_argument("input", metavar="IN")
    parser.add_argument("output", metavar="OUT")
    parser.add_argument("--part", help="only the prims at this path and below")
    parser.add_argument("--transfer", choices=["linear", "srgb"], help="what colours are of light, in place of what the file says")
    parser.add_argument("--gamma", type=float, default=0.0, help="the same: a gamma of this exponent")
    parser.add_argument("--metres-per-unit", type=float, default=0.0, help="of what is written as USD")
    parser.add_argument("--half", action="store_true", help="write arrays of half precision")
    parser.add_argument("--fps", type=float, default=_CODES_PER_SECOND, help="frames a second of what moves, as it is written")
    parser.add_argument("-q", "--quiet", action="store_true")
    given = parser.parse_args(arguments)
    try:
        said = _convert(given)
    except (TidesError, OSError, ValueError, ImportError, Tf.ErrorException) as why:
        print(f"tides.usd: {str(why).strip().splitlines()[0]}", file=sys.stderr)
        return 1
    if not given.quiet:
        print(said)
    return 0


if __name__ == "__main__":
    sys.exit(main())
