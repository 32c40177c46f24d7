"""What the paper prints (section 5), and rows that hold it against results.json."""

__all__ = [
    "TABLE_2",
    "TABLE_3",
    "TABLE_4",
    "TABLE_5",
    "axis_rows",
    "path_rows",
    "pose_rows",
    "rate_rows",
    "resource_rows",
]

TABLE_2 = {
    "x": (5.57, 1, 2.06),
    "y": (4.5, 0, 1.95),
    "z": (3.4, 0, 0.9),
    "roll": (1.2, 0, 0.7),
    "yaw": (4.7, 0.1, 1.8),
    "pitch": (4.7, 0.1, 1.8),
}
"""Axis -> greatest, least and mean error, cm and degrees."""

TABLE_3 = {
    "4 target points": (3.249, 8.7845, 2.3101),
    "20 target points": (3.3537, 8.8294, 2.1606),
    "50 target points": (3.4167, 8.7393, 2.1728),
    "100 target points": (3.1275, 8.9024, 2.2154),
    "the paper, 4 points": (2.1924, 2.3621, 1.0951),
}
"""Method -> errors of x, y and of the rotation. The paper names no units."""

TABLE_4 = (("Acevedo-Avila et al. 2016", "Cyclone III", 50.0, 110.0), ("the paper", "Cyclone IV E", 50.0, 162.0))

TABLE_5 = {
    "le": ("logic elements", 10814),
    "ff": ("registers", 6683),
    "memory_bits": ("memory bits", 1703417),
    "mult9": ("9-bit multiplier elements", 11),
    "m9k": ("M9K blocks", None),
}
"""Key of synth.json -> what it is, and the paper's number."""


def _number(value, digits=2):
    return "-" if value is None else f"{value:,.{digits}f}"


def axis_rows(axes):
    """Table 2: axis, unit, then greatest, least and mean error by the paper, by classic and by centred POSIT."""
    rows = []
    for axis, entry in axes.items():
        found = [entry[form]["error"][name] for form in ("classic", "centred") for name in ("max", "min", "mean")]
        rows.append([entry["title"], entry["unit"], *(f"{v:g}" for v in TABLE_2[axis]), *map(_number, found)])
    return rows


def path_rows(path):
    """Table 3: method, mean errors of x, y and the rotation."""
    rows = [[name, *(f"{value:g}" for value in values)] for name, values in TABLE_3.items()]
    for form, name in (("classic", "ours, classic POSIT, 4 points"), ("centred", "ours, centred POSIT, 4 points")):
        error = path[form]["error"]
        rows.append([name, *(_number(error[key]["mean"]) for key in ("x", "y", "heading"))])
    return rows


def pose_rows(printed, found):
    """Poses as the paper prints them, beside ours: element, exact and approximate of the paper, and of ours."""
    names = [f"R{row}{column}" for row in range(3) for column in range(3)] + ["X mm", "Y mm", "Z mm"]

    def flat(pose):
        return [pose[row][column] for row in range(3) for column in range(3)] + [pose[row][3] for row in range(3)]

    columns = [flat(pose) for pose in (*printed.values(), *(found[name] for name in printed))]
    return [[name, *(f"{value:.3f}" for value in row)] for name, *row in zip(names, *columns, strict=True)]


def rate_rows(rate):
    """Table 4: system, device, MHz, frames a second."""
    rows = [[name, device, f"{mhz:g}", f"{fps:.1f}"] for name, device, mhz, fps in TABLE_4]
    rows.append(["RasterPose, at the paper's clock", "any", "50", f"{rate['fps_50_mhz']:.1f}"])
    if rate["fmax_mhz"]:
        estimate = [f"{rate['fmax_mhz']:.1f}", f"{rate['fps_fmax']:.1f}"]
        rows.append(["RasterPose, pixel pipeline, estimated clock", "ECP5, speed grade 6", *estimate])
    return rows


def resource_rows(resources):
    """Table 5: resource, the paper's number and the estimate of ours; None without estimates."""
    total = ((resources or {}).get("cyclone4e") or {}).get("total")
    if not total:
        return None
    return [
        [title, "-" if paper is None else f"{paper:,}", _number(total.get(key), 0)]
        for key, (title, paper) in TABLE_5.items()
    ]
