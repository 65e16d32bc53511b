"""Random event streams at a format's limits: columns t [us], x, y [px], p (0, 1) in order of t, y, x, p."""

import numpy as np

COLUMNS = "txyp"

# Where a clock ends or a format begins to count differently [us]: the low bits of EVT 2 and 3, the bytes of Event Stream
# (127 us and multiples), DSEC's milliseconds, EVT 3's 24 bits.
LIMITS = (2**6, 127, 2 * 127, 100 * 127, 1000, 2**12, 2**16, 2**23, 2**24, 5 * 2**24)
# Half of DAT's clock, which is the longest that its readers can bridge; 32 bits; around EVT 2's 34 bits; two turns of it.
LONG = (2**30, 2**30, 2**31 - 1, 2**31 - 1, 2**32 + 1, 2**34 - 1, 2**34 + 1, 2**35)


def in_order(t, x, y, p):
    order = np.lexsort((p, x, y, t))
    return {name: column[order].astype(np.int64) for name, column in zip(COLUMNS, (t, x, y, p))}


def silences(random, longest):
    """Each limit, one less and one more, three times; no silence is longer than `longest` [us]."""
    lengths = [limit + change for limit in LIMITS for change in (-1, 0, 1) for _ in range(3)] + list(LONG)
    return random.permutation([length for length in lengths if length <= longest])


def gaps_of_a_burst(random, count):
    """From all events in one microsecond to one in 300 us."""
    mean = random.choice([0, 0.01, 0.3, 3, 300])
    return random.geometric(1 / (1 + mean), count) - 1


def make_stream(seed, count, width, height, longest):
    """Bursts of random rates with silences between them; some events in the corners, some twice in one pixel and tick."""
    random = np.random.default_rng(seed)
    between = silences(random, longest)
    bounds = np.sort(random.choice(np.arange(1, count), len(between), replace=False))
    gaps = np.concatenate([gaps_of_a_burst(random, size) for size in np.diff([0, *bounds, count])])
    gaps[bounds] = between
    x, y, p = random.integers(0, width, count), random.integers(0, height, count), random.integers(0, 2, count)
    corners = random.random(count) < 0.02
    x = np.where(corners, random.choice([0, width - 1], count), x)
    y = np.where(corners, random.choice([0, height - 1], count), y)
    again = 1 + np.flatnonzero((random.random(count - 1) < 0.01) & (gaps[1:] == 0))
    x[again], y[again] = x[again - 1], y[again - 1]
    return in_order(np.cumsum(gaps), x, y, p)


def make_corners(width, height, start=0):
    """Both polarities in each corner, one after the other and all at once."""
    x, y, p = (grid.ravel() for grid in np.meshgrid([0, width - 1], [0, height - 1], [0, 1]))
    return in_order(start + np.concatenate([np.arange(8), np.full(8, 10)]), *(np.tile(column, 2) for column in (x, y, p)))


def make_one(width, height):
    return in_order(*(np.array([value]) for value in (12345678, width - 1, height - 1, 1)))


def make_none():
    return in_order(*np.zeros((4, 0), np.int64))
