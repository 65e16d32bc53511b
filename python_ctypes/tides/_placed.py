"""Gaussians moved by an affine map: their shapes, and the directions from which their colours are seen.
lib/scene/gaussians_place.c does the same in C."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .scene import Gaussians

_OPAQUE = 1 - 2.0**-24  # greatest float32 opacity below 1: it and its complement 2^-24 have finite logits


# -- spherical harmonics ---------------------------------------------------------------------------------------------------
def _band(directions: np.ndarray, degree: int) -> np.ndarray:
    """Band `degree` of INRIA's basis (real, with the Condon-Shortley phase) in unit directions (n x 3): m from -l to l."""
    x, y, z = directions.T
    made = np.empty((len(directions), 2 * degree + 1))
    cosine, sine, start = np.ones_like(x), np.zeros_like(x), 1.0  # cos, sin of m azimuth, times sin(polar)^m; (2 m - 1)!!
    for m in range(degree + 1):
        before, value = np.zeros_like(z), np.full_like(z, start)
        for k in range(m + 1, degree + 1):
            before, value = value, ((2 * k - 1) * z * value - (k + m - 1) * before) / (k - m)
        factor = (2 * degree + 1) / (4 * np.pi) * (2 if m else 1) / np.prod(np.arange(degree - m + 1, degree + m + 1))
        value = (-1) ** m * np.sqrt(factor) * value
        made[:, degree - m], made[:, degree + m] = value * sine, value * cosine
        cosine, sine, start = cosine * x - sine * y, cosine * y + sine * x, start * (2 * m + 1)
    return made


def turn_harmonics(sh: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Coefficients (n x k x 3) of colours that look along `turn` d as these look along d. `turn` (3 x 3) may mirror."""
    made, golden = sh.astype(np.float64), np.pi * (3 - 5**0.5)
    i = np.arange(64)  # directions, spread evenly: more than band 4's 9 functions need
    z = 1 - (2 * i + 1) / len(i)
    around = np.stack([np.sqrt(1 - z * z) * np.cos(golden * i), np.sqrt(1 - z * z) * np.sin(golden * i), z], 1)
    for degree in range(1, round(sh.shape[1] ** 0.5)):
        matrix = np.linalg.lstsq(_band(around, degree), _band(around @ turn, degree), rcond=None)[0]
        whole = np.round(matrix)
        matrix = np.where(np.abs(matrix - whole) < 1e-12, whole, matrix)  # half turns only change signs
        rows = slice(degree**2, (degree + 1) ** 2)
        made[:, rows] = np.einsum("jk,nkc->njc", matrix, made[:, rows])
    return made


# -- transforms ------------------------------------------------------------------------------------------------------------
def _matrices(quaternion: np.ndarray) -> np.ndarray:
    """Rotations (n x 3 x 3) of quaternions wxyz of any length."""
    w, x, y, z = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).T
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z)]
    rows += [2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
    return np.stack(rows, 1).reshape(-1, 3, 3)


def quaternions(matrix: np.ndarray) -> np.ndarray:
    """Quaternions wxyz (n x 4) of rotations (n x 3 x 3), by the largest component."""
    m = matrix
    t = np.stack([1 + m[:, 0, 0] * a + m[:, 1, 1] * b + m[:, 2, 2] * c for a, b, c in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))])
    yz, zx, xy = (m[:, j, i] - m[:, i, j] for i, j in ((1, 2), (2, 0), (0, 1)))
    YZ, ZX, XY = (m[:, j, i] + m[:, i, j] for i, j in ((1, 2), (2, 0), (0, 1)))
    rows = np.array([[t[0], yz, zx, xy], [yz, t[1], XY, ZX], [zx, XY, t[2], YZ], [xy, ZX, YZ, t[3]]])
    largest = np.argmax(t, axis=0)
    made = rows[largest, :, np.arange(len(m))]
    return made / np.linalg.norm(made, axis=1, keepdims=True)


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Products of quaternions wxyz: a (4) times b (n x 4)."""
    w, v, s, u = a[0], a[1:], b[:, :1], b[:, 1:]
    return np.concatenate([w * s - (u @ v)[:, None], w * u + s * v + np.cross(v, u)], 1)


@dataclass
class Map:
    """p -> linear p + shift. linear = turn stretch, where turn (3 x 3) rotates and may mirror. `scale` is the stretch if it is
    equal along all axes, else None."""

    linear: np.ndarray
    shift: np.ndarray

    def __post_init__(self) -> None:
        u, size, v = np.linalg.svd(self.linear)
        self.turn = u @ v
        self.scale = float(np.cbrt(np.prod(size))) if size[0] - size[2] <= 1e-6 * size[0] else None  # float32's, in a matrix
        self.mirrors = np.linalg.det(self.turn) < 0
        self.flattens = size[2] <= 1e-12 * size[0]
        self.rests = np.array_equal(self.linear, np.eye(3)) and not self.shift.any()

    @property
    def rotation(self) -> np.ndarray:
        """Quaternion of the turn. If it mirrors, of its opposite, which gives an ellipsoid the same shape."""
        return quaternions((-self.turn if self.mirrors else self.turn)[None])[0]


@dataclass
class Splats:
    """A prim's Gaussians at a time, in double; scales are linear, and opacities from 0 to 1."""

    mean: np.ndarray
    scale: np.ndarray
    quaternion: np.ndarray
    opacity: np.ndarray
    sh: np.ndarray

    def moved(self, by: Map) -> "Splats":
        if by.rests:
            return self
        mean, sh = self.mean @ by.linear.T + by.shift, turn_harmonics(self.sh, by.turn)
        if by.scale is not None:
            return Splats(mean, by.scale * self.scale, _product(by.rotation, self.quaternion), self.opacity, sh)
        axes, scale, _ = np.linalg.svd(by.linear @ _matrices(self.quaternion) * self.scale[:, None, :])  # the ellipsoids' axes
        axes[np.linalg.det(axes) < 0] *= -1
        return Splats(mean, scale, quaternions(axes), self.opacity, sh)

    @property
    def log_scale(self) -> np.ndarray:
        return np.log(np.maximum(self.scale, np.finfo(np.float32).tiny))

    @property
    def opacity_logit(self) -> np.ndarray:
        opacity = np.clip(self.opacity, 1 - _OPAQUE, _OPAQUE)
        return np.log(opacity / (1 - opacity))

    def gaussians(self, transfer: str, gamma: float) -> Gaussians:
        mean = self.mean if (self.mean != self.mean.astype(np.float32)).any() else self.mean.astype(np.float32)
        return Gaussians(mean, self.log_scale, self.quaternion, self.opacity_logit, self.sh, "unknown", transfer, gamma)
