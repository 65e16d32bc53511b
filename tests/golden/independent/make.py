#!/usr/bin/env python3
"""Makes image.txt, lenses.txt, crossings.txt and baselines.txt: results of TIDES's equations by other means, in double
precision, so that a clone without outside data still compares with something that shares no line with the library
(../test_independent.c).

usage: make.py     writes beside itself; needs numpy. Numbers are drawn by splitmix64, not by numpy, so that they stay the same.

image       20 Gaussians that move by polynomials, projected and composited as docs/DESIGN.md 3.1 and docs/soft_order.md say.
            Weights of the soft order are integrated numerically from their definition, not by the library's recursion; rates
            are complex steps of the whole image, not duals.
lenses      the same through a radtan and an equidistant lens, from their definitions; Jacobians are differences of
            these, not formulas.
crossings   events of cubics by the eigenvalues of companion matrices (numpy.roots), not by brackets.
baselines   ESIM, v2e, DVS-Voltmeter and IEBCS without their noise, and LDATI of whole voxels, written from their papers'
            equations pixel by pixel.
"""
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


class Numbers:
    """splitmix64"""

    def __init__(self, seed):
        self.state = seed

    def uniform(self, low, high, *shape):
        count = int(np.prod(shape)) if shape else 1
        values = []
        for _ in range(count):
            self.state = (self.state + 0x9E3779B97F4A7C15) & (2**64 - 1)
            z = self.state
            z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & (2**64 - 1)
            z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & (2**64 - 1)
            values.append(low + (high - low) * ((z ^ (z >> 31)) >> 11) * 2.0**-53)
        return np.array(values).reshape(shape) if shape else values[0]


def floats(array):
    """What a float holds of it: the library's scenes are in single precision."""
    return np.asarray(array, np.float32).astype(float)


def row(*parts):
    return " ".join(repr(float(v)) for part in parts for v in np.ravel(part)) + "\n"


# -- image -------------------------------------------------------------------------------------------------------------

WIDTH, HEIGHT, FX, FY, CX, CY = 24, 16, 26.0, 25.0, 12.4, 7.7
DILATION, ALPHA_MAX, LOG_EPS, SOFT_DEPTH = 0.3, 0.99, 1e-3, 1e-4
TAPER = (0.1 / 255, 1.0 / 255)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BACKGROUND = np.array([0.1, 0.2, 0.3])
EYE = np.array([0.0, 0.0, -4.0])
TIME = 0.3
SH_0, SH_1 = 0.28209479177387814, 0.4886025119029199


def draw_gaussians(count):
    n = Numbers(13)
    g = {
        "mean": n.uniform(-1, 1, count, 3) * [1.4, 0.9, 0.7],
        "log_scale": n.uniform(-2.2, -0.9, count, 3),
        "quaternion": n.uniform(-1, 1, count, 4) + [1.2, 0, 0, 0],
        "logit": n.uniform(-1.5, 1.2, count),
        "sh": n.uniform(-0.25, 0.25, count, 4, 3) + np.array([0.6, 0, 0, 0])[:, None],
        "centre": n.uniform(0, 1, count),
        "log_width": n.uniform(-0.5, 1.5, count),
        "c": n.uniform(-0.7, 0.7, count, 3, 3),
        "quaternion_dot": n.uniform(-0.8, 0.8, count, 4),
    }
    for k in range(0, count, 4):  # some share their depth but for parts of soft_depth, and their place nearly
        g["mean"][k + 1] = g["mean"][k] + [0.1, -0.05, 2e-4 * (k + 1) / count]
        for name in ("centre", "c"):
            g[name][k + 1] = g[name][k]
    return {name: floats(value) for name, value in g.items()}


def rotation(q):
    w, x, y, z = q / np.sqrt(q @ q)  # no conjugation: complex steps want analytic functions
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def clip(value, low, high):
    return np.where(value.real < low, low, np.where(value.real > high, high, value))


def pinhole(a, b):
    return a, b


def radtan(a, b, k1=-0.31, k2=0.12, p1=2e-3, p2=-3e-3, k3=-0.02):
    r2 = a * a + b * b
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    return (
        a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a * a),
        b * radial + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b,
    )


def equidistant(a, b, k1=-0.04, k2=0.01, k3=-0.003, k4=0.0005):
    r = np.sqrt(a * a + b * b)
    theta = np.arctan(r)
    bent = theta * (1 + k1 * theta**2 + k2 * theta**4 + k3 * theta**6 + k4 * theta**8)
    return a * bent / r, b * bent / r


def slopes_of(lens, a, b):
    """The matrix of lens's derivatives at (a, b), by central differences of the eighth order (complex steps stay within)."""
    h, weights = 0.01, (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    columns = []
    for da, db in ((h, 0), (0, h)):
        ways = [
            np.array(lens(a + k * da, b + k * db)) - np.array(lens(a - k * da, b - k * db)) for k in range(1, len(weights) + 1)
        ]
        columns.append(sum(weight * way for weight, way in zip(weights, ways)) / h)
    return np.array(columns).T


def splat(g, k, time, lens):
    """Depth, colour's luminance, and alpha at every pixel of Gaussian k, with the polynomial model of tides/motion.h."""
    dt = time - g["centre"][k]
    mean = g["mean"][k] + g["c"][k][0] * dt + g["c"][k][1] * dt**2 + g["c"][k][2] * dt**3
    opacity = np.exp(-((dt / np.exp(g["log_width"][k])) ** 2)) / (1 + np.exp(-g["logit"][k]))
    factor = rotation(g["quaternion"][k] + g["quaternion_dot"][k] * dt) * np.exp(g["log_scale"][k])
    seen = mean - EYE
    x, y, z = seen
    # The Jacobian's slopes end 0.3 tan(fov/2) beyond the borders; INRIA's borders are those of a centred image.
    limits = 1.3 * 0.5 * WIDTH / FX, 1.3 * 0.5 * HEIGHT / FY
    slope_x, slope_y = clip(x / z, -limits[0], limits[0]), clip(y / z, -limits[1], limits[1])
    jacobian = np.array([[1 / z, 0 * z, -slope_x / z], [0 * z, 1 / z, -slope_y / z]])
    if lens is not pinhole:
        jacobian = slopes_of(lens, slope_x, slope_y) @ jacobian
    jacobian = np.diag([FX, FY]) @ jacobian
    bent_x, bent_y = lens(x / z, y / z)
    flat = jacobian @ factor
    covariance = flat @ flat.T + DILATION * np.eye(2)
    det = covariance[0, 0] * covariance[1, 1] - covariance[0, 1] ** 2
    dx = np.arange(WIDTH)[None, :] + 0.5 - (FX * bent_x + CX)
    dy = np.arange(HEIGHT)[:, None] + 0.5 - (FY * bent_y + CY)
    form = (covariance[1, 1] * dx**2 - 2 * covariance[0, 1] * dx * dy + covariance[0, 0] * dy**2) / det
    alpha = opacity * np.exp(-0.5 * form)
    s = clip((alpha - TAPER[0]) / (TAPER[1] - TAPER[0]), 0, 1)
    tau = clip(alpha, 0, ALPHA_MAX) * s**3 * (10 + s * (6 * s - 15))
    direction = seen / np.sqrt(seen @ seen)
    basis = np.array([SH_0 + 0 * z, -SH_1 * direction[1], SH_1 * direction[2], -SH_1 * direction[0]])
    colour = 0.5 + basis @ g["sh"][k]
    return z, np.where(colour.real < 0, 0, colour) @ LUMINANCE, tau


PANELS = (0, 0.5, 1, 2, 4, 8, 16, 32, 60)
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(20)


def image(g, time, lens=pinhole):
    """log(Y + eps) at `time`, which may be complex."""
    splats = sorted((splat(g, k, time, lens) for k in range(len(g["mean"]))), key=lambda made: made[0].real)
    s = [np.log(z) / SOFT_DEPTH for z, _, _ in splats]
    a = [-np.log(1 - tau) for _, _, tau in splats]
    Y = np.zeros((HEIGHT, WIDTH), complex)

    def behind(r, first, upto):
        """T at the depth s[first] + r, where those before `upto` have begun."""
        taken = 0
        for j in range(upto):
            taken = taken + a[j] * (1 - np.exp(-(s[first] - s[j] + r)))
        return np.exp(-taken)

    for i in range(len(s)):  # from where splat i begins to where the next does
        length = s[i + 1] - s[i] if i + 1 < len(s) else np.inf
        ends = [p for p in PANELS if p < length.real] + ([length] if length.real < PANELS[-1] else [])
        for low, high in zip(ends, ends[1:]):
            for point, weight in zip(POINTS, WEIGHTS):
                r = low + (high - low) * (1 + point) / 2
                light = behind(r, i, i + 1) * (weight * (high - low) / 2)
                for j in range(i + 1):
                    Y = Y + splats[j][1] * a[j] * np.exp(-(s[i] - s[j] + r)) * light
    Y = Y + np.exp(-sum(a)) * (BACKGROUND @ LUMINANCE)
    return np.log(Y + LOG_EPS)


def write_image():
    g = draw_gaussians(20)
    step = 1e-30
    made = image(g, TIME + 1j * step)
    with (HERE / "image.txt").open("w") as out:
        out.write(f"# made by make.py: {len(g['mean'])} Gaussians, then L and L_dot of {WIDTH}x{HEIGHT} px\n")
        out.write(row(len(g["mean"]), WIDTH, HEIGHT, FX, FY, CX, CY, TIME, BACKGROUND))
        for k in range(len(g["mean"])):
            out.write(row(*(g[name][k] for name in g)))
        for L, L_dot in zip(made.real.ravel(), made.imag.ravel() / step):
            out.write(row(L, L_dot))


def write_lenses():
    g = draw_gaussians(20)
    step = 1e-30
    with (HERE / "lenses.txt").open("w") as out:
        out.write("# made by make.py: k1 k2 k3 k4 p1 p2 of a radtan and an equidistant lens, L and L_dot of image.txt's scene\n")
        for lens, numbers in (
            (radtan, (-0.31, 0.12, -0.02, 0, 2e-3, -3e-3)),
            (equidistant, (-0.04, 0.01, -0.003, 0.0005, 0, 0)),
        ):
            made = image(g, TIME + 1j * step, lens)
            out.write(row(numbers))
            for L, L_dot in zip(made.real.ravel(), made.imag.ravel() / step):
                out.write(row(L, L_dot))


# -- crossings ---------------------------------------------------------------------------------------------------------


def events_of_cubic(p, on, off):
    """(s, polarity) on [0, 1] of the polynomial p (highest power first); the reference begins at p(0)."""
    events, reference, last, slope = [], p[3], 0.0, np.polyder(p)
    while True:
        first = None
        for polarity, level in ((1, reference + on), (-1, reference - off)):
            for root in np.roots(p - [0, 0, 0, level]):
                if abs(root.imag) < 1e-9 and last + 1e-9 < root.real <= 1 and np.polyval(slope, root.real) * polarity > 0:
                    if first is None or root.real < first[0]:
                        first = (root.real, polarity)
        if first is None:
            return events
        events.append(first)
        last, reference = first[0], reference + (on if first[1] > 0 else -off)


def write_crossings():
    n = Numbers(17)
    with (HERE / "crossings.txt").open("w") as out:
        out.write("# made by make.py: h S0 S0_dot S1 S1_dot C+ C- count, then s and polarity of each event\n")
        for _ in range(60):
            h, (S0, S1), on, off = n.uniform(0.5, 2), n.uniform(-1, 1, 2), n.uniform(0.05, 0.3), n.uniform(0.05, 0.3)
            d0, d1 = n.uniform(-6, 6, 2)
            hermite = np.array([2 * S0 - 2 * S1 + h * (d0 + d1), 3 * (S1 - S0) - h * (2 * d0 + d1), h * d0, S0])
            events = events_of_cubic(hermite, on, off)
            out.write(row(h, S0, d0, S1, d1, on, off, len(events), [v for event in events for v in event]))


# -- baselines ---------------------------------------------------------------------------------------------------------

TIMES = np.array([0.0, 0.004, 0.009, 0.0135, 0.02])  # [s]
W, H = 6, 5


def straight_lines(L, on, off):
    """ESIM, and TIDES's sensor on frames: the logarithm goes straight from frame to frame."""
    for y, x in np.ndindex(H, W):
        reference = L[0, y, x]
        for k in range(1, len(TIMES)):
            a, b = L[k - 1, y, x], L[k, y, x]
            while b >= reference + on or b <= reference - off:
                polarity = 1 if b > a else -1
                reference += on if polarity > 0 else -off
                yield TIMES[k - 1] + (TIMES[k] - TIMES[k - 1]) * (reference - a) / (b - a), x, y, polarity


def v2e(Y, threshold, cutoff_hz):
    """Hu, Liu, Delbruck 2021: counts by floor, and one grid of sub-times for the whole frame."""
    DN = 255 * Y
    level = np.where(DN <= 20, DN * np.log(20) / 20, np.log(np.maximum(DN, 1e-9)))
    seen, reference = level[0].copy(), level[0].copy()
    for k in range(1, len(TIMES)):
        dt = TIMES[k] - TIMES[k - 1]
        share = np.minimum(1, (DN[k] + 20) / 275 * dt * 2 * np.pi * cutoff_hz) if cutoff_hz else 1
        seen = (1 - share) * seen + share * level[k]
        counts = np.floor(np.abs(seen - reference) / threshold)
        polarity = np.sign(seen - reference)
        for y, x in np.ndindex(H, W):
            for j in range(1, int(counts[y, x]) + 1):
                yield TIMES[k - 1] + dt * j / counts.max(), x, y, int(polarity[y, x])
        reference += polarity * counts * threshold


def voltmeter(Y, k1, k2, k4, k5):
    """Lin et al. 2022 without its Brownian motion: a voltage that drifts between frames, and fires at 1 and -1."""
    DN = 255 * Y
    for y, x in np.ndindex(H, W):
        voltage = 0.0
        for k in range(1, len(TIMES)):
            at, stop = 1e6 * TIMES[k - 1], 1e6 * TIMES[k]
            middle = (DN[k - 1, y, x] + DN[k, y, x]) / 2
            drift = k1 * (DN[k, y, x] - DN[k - 1, y, x]) / (stop - at) / (middle + k2) + k4 + k5 * middle
            while True:
                rest = (np.sign(drift) - voltage) / drift
                if at + rest > stop:
                    voltage += drift * (stop - at)
                    break
                at, voltage = at + rest, 0.0
                yield 1e-6 * at, x, y, int(np.sign(drift))


def iebcs(Y, threshold, latency_us, refractory_us, tau_us, scale):
    """Joubert et al. 2021 without jitter and noise: each frame is a step that the pixel follows; whole microseconds."""
    for y, x in np.ndindex(H, W):
        v = reference = np.log(scale * Y[0, y, x] + 1)
        ready = np.inf
        for k in range(1, len(TIMES)):
            at, stop = round(1e6 * TIMES[k - 1]), round(1e6 * TIMES[k])
            goal, tau = np.log(scale * Y[k, y, x] + 1), 1e3 * tau_us / (scale * Y[k, y, x] + 1)

            def follow(until):
                return v + (goal - v) * (1 - np.exp(-(until - at) / tau))

            while True:
                if ready < stop:
                    v = reference = follow(ready)
                    at, ready = ready, np.inf
                polarity = 1 if goal > reference else -1
                if np.isfinite(ready) or abs(follow(stop) - reference) <= threshold:
                    break
                part = (reference + polarity * threshold - v) / (goal - v)
                fired = at + int(min(max(latency_us - tau * np.log(1 - part), 0), 10000))
                yield 1e-6 * fired, x, y, polarity
                ready = fired + refractory_us
            v = follow(stop)


def ldati(fps):
    """Zhang et al. 2024: a whole voxel alone is an event at its plane's time."""
    for number in range(40):
        plane, y, x = number * 2 % 9, number // W % H, number % W
        if number % 3 == 0 and number < W * H:
            yield np.floor(1e6 * plane / (9 * fps)) * 1e-6, x, y, 1 if number % 2 else -1


def write_baselines():
    Y = Numbers(19).uniform(0.02, 1, len(TIMES), H, W)
    logarithm = np.log(Y + 0.001)
    made = {
        "tides": straight_lines(logarithm, 0.3, 0.25),
        "esim": straight_lines(logarithm, 0.35, 0.2),
        "v2e": v2e(Y, 0.2, 0),
        "v2e-filtered": v2e(Y, 0.2, 60),
        "dvs-voltmeter": voltmeter(Y, 5.265, 20, 1e-7, 5e-9),
        "iebcs": iebcs(Y, 0.4, 100, 300, 400, 1e4),
        "ldati": ldati(30),
    }
    with (HERE / "baselines.txt").open("w") as out:
        out.write("# made by make.py: frames, width, height; times [s]; Y; then methods: a count, and t [s] x y polarity\n")
        out.write(row(len(TIMES), W, H) + row(TIMES) + row(Y))
        for name, events in made.items():
            events = sorted(events, key=lambda e: (e[2], e[1], e[0]))
            out.write(f"# {name}\n{len(events)}\n" + "".join(row(*e) for e in events))


if __name__ == "__main__":
    write_image()
    write_lenses()
    write_crossings()
    write_baselines()
