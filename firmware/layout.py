"""The firmware's structures as numpy types: what its settings are patched with, and what its memory is read as."""

import numpy as np

__all__ = ["ESTIMATE", "FRAME_REPORT", "MARKER_REPORT", "OPTIONS", "POSE", "SETTINGS", "settings_bytes"]

#: struct pose_options of pose/pose.h
OPTIONS = np.dtype(
    [
        ("fx", "<f4"),
        ("fy", "<f4"),
        ("cx", "<f4"),
        ("cy", "<f4"),
        ("side_mm", "<f4"),
        ("polish_steps", "<i4"),
        ("max_iterations", "<i4"),
        ("stop_error", "<f4"),
        ("diagonal_px", "<f4"),
    ]
)

#: struct settings of sensor/settings.h
SETTINGS = np.dtype(
    [
        ("pose", OPTIONS),
        ("k1", "<f4"),
        ("k2", "<f4"),
        ("p1", "<f4"),
        ("p2", "<f4"),
        ("uart_divisor", "<u4"),
        ("tick_clocks", "<u4"),
        ("watchdog_clocks", "<u4"),
        ("display_ticks", "<u4"),
        ("status_ticks", "<u4"),
        ("covariance", "<u4"),
    ]
)

#: struct pose
POSE = np.dtype([("r", "<f4", (3, 3)), ("t_mm", "<f4", 3), ("rms_px", "<f4")])

#: struct pose_estimate
ESTIMATE = np.dtype([("error", "<i4"), ("has_other", "<i4"), ("iterations", "<i4"), ("pose", POSE), ("other", POSE)])

#: struct marker_report of sensor/report.h
MARKER_REPORT = np.dtype(
    [
        ("vertices_px", "<f4", (4, 2)),
        ("quality", "<u4"),
        ("estimate", ESTIMATE),
        ("quaternion", "<f4", 4),
        ("ambiguity", "<f4"),
        ("clocks", "<u4"),
    ]
)

#: struct frame_report, without its markers
FRAME_REPORT = np.dtype(
    [
        ("sequence", "<u4"),
        ("frame", "<u4"),
        ("first_pixel", "<u4"),
        ("last_pixel", "<u4"),
        ("markers", "<u4"),
        ("skipped", "<u4"),
    ]
)


def settings_bytes(image, **values):
    """Settings of an image with other values, for ``image.patched("settings", ...)``.

    ``values`` are fields of :data:`SETTINGS`, and of its ``pose``. Raises KeyError for another name.
    """
    place = image.symbols["settings"]
    content = image.words.view(np.uint8)[place.address : place.address + place.size]
    settings = np.frombuffer(content.tobytes(), SETTINGS).copy()
    for name, value in values.items():
        if name in SETTINGS.names:
            settings[name] = value
        elif name in OPTIONS.names:
            settings["pose"][name] = value
        else:
            raise KeyError(name)
    return settings.tobytes()
