"""What NumPy makes of the served tables: the NPZ has the named arrays, and interpolating in it gives what /lookup gives.

The interpolation here is written from the manifest alone and shares no code with the service. Every comparison has a
negative control: a value that is off must be noticed.
"""

import hashlib
import io
import json
import math
import os
import sys
import urllib.request

import numpy as np

URL = os.environ["LTC_URL"]
QUERIES = 400
# Both sides compute in double precision, from the same numbers.
TOLERANCE = 1e-6
AXES = {
    "ggx-anisotropic": ["theta", "phi", "alpha", "lambda"],
    "ggx-anisotropic-closed-form": ["theta", "phi", "alpha", "lambda"],
    "ggx-isotropic": ["theta", "alpha"],
    # Its α begins above 0.
    "charlie-sheen": ["theta", "alpha"],
}
# The coordinate in which an axis's nodes are evenly spaced, by the manifest's name for it.
MAPPINGS = {
    "linear": lambda x: x,
    "sqrt": math.sqrt,
    "sqrt_one_minus_cos": lambda x: math.sqrt(1.0 - math.cos(x)),
    "half_tangent": lambda x: math.tan(0.5 * x),
    "grazing_half_tangent": lambda x: math.tan(0.5 * x) / (2.0 - math.tan(0.5 * x)),
}


def check(holds, fault):
    """Ends the script with one line unless `holds`."""
    if not holds:
        sys.exit(f"npz.py: {fault}")


def get(path):
    """Body and headers of a GET."""
    with urllib.request.urlopen(URL + path, timeout=60) as response:
        return response.read(), response.headers


def get_json(path):
    return json.loads(get(path)[0])


def post_json(path, value):
    request = urllib.request.Request(
        URL + path, json.dumps(value).encode(), {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=60) as response:
        return json.loads(response.read())


def cell(axis, value):
    """The lower node of the cell that holds `value`, and how far into the cell it is; outside the domain, its end."""
    mapping = MAPPINGS[axis["mapping"]]
    low, high = (mapping(x) for x in axis["domain"])
    position = (mapping(max(value, 0.0)) - low) / (high - low) * (axis["len"] - 1)
    position = min(max(position, 0.0), axis["len"] - 1.0)
    lower = min(int(position), axis["len"] - 2)
    return lower, position - lower


def interpolate(array, axes, values):
    """N-linear interpolation, one axis after the other."""
    for axis, value in zip(axes, values):
        lower, t = cell(axis, value)
        array = (1.0 - t) * array[lower] + t * array[lower + 1]
    return array


def ggx_smith(theta, phi, alpha_x, alpha_y):
    """The closed form ggx-smith as the manifest words it, for magnitude and Fresnel term."""
    x, y, c = math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), max(math.cos(theta), 0.0)
    along = (alpha_x * x) ** 2 + (alpha_y * y) ** 2
    across = (alpha_x * y) ** 2 + (alpha_y * x) ** 2
    m1 = max(c + math.sqrt(c * c + 7.5 * along + 0.035 * across), 1e-6)
    m2 = max(c + math.sqrt(c * c + 0.5 * along + 0.4 * across), 1e-6)
    g1, g2, v = 2.0 * c / m1, 2.0 * c / m2, max(0.0, 1.0 - 0.5 * m1)
    magnitude = -0.471 * g1 * (1.0 - g1) - 0.924 * g2 * (1.0 - g2) ** 2 * across
    magnitude += 0.032 * (alpha_x * alpha_x + alpha_y * alpha_y)
    return magnitude, v**4 * (0.869 + v * g1 * (0.118 + (1.0 - g1) * (-0.293 - 1.372 * across)))


def with_remainders(arrays):
    """The arrays with what the closed form leaves of magnitude and Fresnel term, if there is one."""
    if "closed_form" not in arrays:
        return arrays
    check(arrays["closed_form"].shape == () and arrays["closed_form"] == 1.0, "the closed form is not ggx-smith")
    nodes = [arrays[f"axis_{quantity}"] for quantity in AXES["ggx-anisotropic"]]
    form = np.vectorize(lambda theta, phi, alpha, ratio: ggx_smith(theta, phi, alpha, alpha * ratio))
    magnitude, fresnel = form(*np.meshgrid(*nodes, indexing="ij"))
    left = {"magnitude": arrays["magnitude"] - magnitude, "fresnel": arrays["fresnel"] - fresnel}
    return {**arrays, **left}


def fold(phi, alpha_x, alpha_y):
    """The azimuth from the axis of the larger width in the first quadrant, and the signed permutation back."""
    x, y = math.cos(phi), math.sin(phi)
    back = np.diag([math.copysign(1.0, x), math.copysign(1.0, y), 1.0])
    x, y = abs(x), abs(y)
    if alpha_x < alpha_y:
        x, y = y, x
        back = back @ np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    return math.atan2(y, x), back


def look_up(arrays, axes, query):
    """Matrix, magnitude and Fresnel term of a query, by NumPy; of a table with a closed form from `with_remainders`."""
    theta, phi = query["theta"], query["phi"]
    alpha_x, alpha_y = query["alpha_x"], query["alpha_y"]
    alpha = max(alpha_x, alpha_y)
    if len(axes) == 2:
        values = [theta, alpha]
        cos, sin = math.cos(phi), math.sin(phi)
        back = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    else:
        folded, back = fold(phi, alpha_x, alpha_y)
        values = [theta, folded, alpha, min(alpha_x, alpha_y) / alpha]
    m, magnitude, fresnel = (interpolate(arrays[name], axes, values) for name in ("m", "magnitude", "fresnel"))
    if "closed_form" in arrays:
        sums = zip(ggx_smith(theta, phi, alpha_x, alpha_y), (magnitude, fresnel))
        magnitude, fresnel = (min(max(form + left, 0.0), 1.0) for form, left in sums)
    return back @ m @ back.T, magnitude, fresnel


def draw(rng, isotropic):
    """Queries of the standard draw, either width the larger, any azimuth."""
    queries = []
    for _ in range(QUERIES):
        alpha = rng.uniform(0.01, 1.0) if rng.random() < 0.5 else rng.uniform(0.1, 1.0) ** 2
        other = alpha if isotropic else alpha * rng.uniform(0.05, 1.0)
        widths = (alpha, other) if rng.random() < 0.5 else (other, alpha)
        theta, phi = math.radians(rng.uniform(0.0, 86.0)), rng.uniform(-7.0, 14.0)
        queries.append({"theta": theta, "phi": phi, "alpha_x": widths[0], "alpha_y": widths[1]})
    return queries


def largest_difference(arrays, axes, queries, answers):
    """Between NumPy's lookups and the service's."""
    largest = 0.0
    for query, answer in zip(queries, answers):
        m, magnitude, fresnel = look_up(arrays, axes, query)
        served = np.array(answer["lobes"][0]["m"]).reshape(3, 3)
        largest = max(
            largest,
            np.abs(m - served).max(),
            abs(magnitude - answer["magnitude"]),
            abs(fresnel - answer["fresnel"]),
        )
    return largest


def check_arrays(name, arrays, axes):
    shape = tuple(axis["len"] for axis in axes)
    check([axis["quantity"] for axis in axes] == AXES[name], f"{name} has the axes {axes}")
    for array, expected in (("m", (*shape, 3, 3)), ("magnitude", shape), ("fresnel", shape)):
        check(array in arrays, f"{name} has no array {array}, but {sorted(arrays)}")
        found = arrays[array]
        check(found.shape == expected, f"{name}: {array} has shape {found.shape}, not {expected}")
        check(found.dtype == np.float64 and np.isfinite(found).all(), f"{name}: {array} is not finite in f64")
    check((np.linalg.det(arrays["m"]) > 0.0).all(), f"{name} has an entry with det M <= 0")
    for axis in axes:
        nodes, mapping = arrays[f"axis_{axis['quantity']}"], MAPPINGS[axis["mapping"]]
        check(nodes.shape == (axis["len"],), f"{name}: axis_{axis['quantity']} has shape {nodes.shape}")
        check([nodes[0], nodes[-1]] == axis["domain"], f"{name}: {axis} begins or ends elsewhere")
        steps = np.diff([mapping(x) for x in nodes])
        even = np.allclose(steps, steps.mean(), rtol=1e-6, atol=0.0)
        check(even, f"{name}: {axis['quantity']} is not evenly spaced by {axis['mapping']}")


def check_digest(name, manifest, payload, headers):
    digest = "sha256:" + hashlib.sha256(payload).hexdigest()
    check(digest == manifest["digest"], f"{name}: the payload is {digest}, the manifest says {manifest['digest']}")
    check(manifest["digest"] in headers.get("ETag", ""), f"{name}: the ETag is {headers.get('ETag')}")
    by_digest, headers = get(f"/v1/tables/{name}/versions/{digest}/data?format=npz")
    check(by_digest == payload, f"{name}: other bytes by digest")
    check("immutable" in headers["Cache-Control"], f"{name}: by digest not immutable")
    path = os.path.join(os.environ["LTC_TABLES"], name, str(manifest["version"]), "table.npz")
    with open(path, "rb") as file:
        check(file.read() == payload, f"{name}: other bytes than {path}")
    damaged = bytes([payload[0] ^ 1]) + payload[1:]
    check("sha256:" + hashlib.sha256(damaged).hexdigest() != digest, "damage is not noticed")


def check_table(name):
    version = f"/v1/tables/{name}/versions/latest"
    manifest = get_json(version)
    payload, headers = get(f"{version}/data?format=npz")
    check_digest(name, manifest, payload, headers)
    arrays = dict(np.load(io.BytesIO(payload), allow_pickle=False))
    axes = manifest["axes"]
    check_arrays(name, arrays, axes)
    entries, arrays = arrays, with_remainders(arrays)

    queries = draw(np.random.default_rng(17), len(axes) == 2)
    answers = post_json(f"{version}/lookup", queries)
    check(len(answers) == QUERIES, f"{name}: {len(answers)} answers to {QUERIES} queries")
    difference = largest_difference(arrays, axes, queries, answers)
    check(difference <= TOLERANCE, f"{name}: interpolation is {difference:.2e} off /lookup")
    for query, answer in list(zip(queries, answers))[:10]:
        text = "&".join(f"{key}={value!r}" for key, value in query.items())
        check(get_json(f"{version}/lookup?{text}") == answer, f"{name}: GET and POST differ at {query}")

    # The controls: an array that is off by 10^-5, and a query whose widths are exchanged.
    for array in ("m", "magnitude", "fresnel"):
        wrong = dict(arrays)
        wrong[array] = arrays[array] + 1e-5
        off = largest_difference(wrong, axes, queries, answers)
        check(off > TOLERANCE, f"{name}: a wrong {array} is not noticed")
    if "closed_form" in entries:
        without = {key: value for key, value in entries.items() if key != "closed_form"}
        off = largest_difference(without, axes, queries, answers)
        check(off > TOLERANCE, f"{name}: a closed form that is left out is not noticed")
    turned = [query | {"phi": query["phi"] + 0.01} for query in queries]
    off = largest_difference(arrays, axes, turned, answers)
    check(off > TOLERANCE, f"{name}: a wrong azimuth is not noticed")
    print(f"{name}: NumPy and /lookup differ by up to {difference:.1e} over {QUERIES} queries")


for table in AXES:
    check_table(table)
