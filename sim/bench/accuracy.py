"""Whether markers are found and how exactly: random rendered frames, and photographs without any."""

from sim.bench.registry import at_least, at_most, measurement


@measurement("found_rate", "Markers found in random frames", "", target=at_least(0.98))
def found_rate(bench):
    """Part of the rendered markers that were found, in whatever order."""
    return bench.score.found_rate


@measurement("false_markers", "False markers in random frames", "", target=at_most(0))
def false_markers(bench):
    """Reported markers that are none of the rendered ones."""
    return bench.score.false


@measurement("wrong_order", "Found, but not with V1 first", "", target=at_most(0))
def wrong_order(bench):
    """Found markers whose first vertex is not V1."""
    return bench.score.wrong_order


@measurement("vertex_rms_px", "Vertices of found markers, rms", "px", target=at_most(0.05))
def vertex_rms_px(bench):
    """Root mean square distance of the vertices from the true ones."""
    return bench.score.rms_px


@measurement("vertex_p95_px", "Vertices of found markers, 95 % within", "px", target=at_most(0.1))
def vertex_p95_px(bench):
    """What 95 % of the vertices are within."""
    return bench.score.p95_px


@measurement("vertex_rms_whole_px", "The same in whole pixels, rms", "px", target=at_most(1.3))
def vertex_rms_whole_px(bench):
    """Root mean square distance of the vertices that were not refined."""
    return bench.whole_score.rms_px


@measurement("found_rate_hard", "Markers found with more blur and noise, less contrast", "", target=at_least(0.95))
def found_rate_hard(bench):
    """Part of the rendered markers that were found, in whatever order."""
    return bench.hard_score.found_rate


@measurement("vertex_rms_hard_px", "Their vertices, rms", "px", target=at_most(0.15))
def vertex_rms_hard_px(bench):
    """Root mean square distance of the vertices from the true ones."""
    return bench.hard_score.rms_px


@measurement("found_rate_light", "Markers found in any light, automatic threshold", "", target=at_least(0.98))
def found_rate_light(bench):
    """Black 20 to 90, white 120 to 240, a gradient of 60 grey levels in any direction; nominal blur and noise."""
    return bench.light_score.found_rate


@measurement("found_rate_light_hard", "The same with more blur and noise", "", target=at_least(0.95))
def found_rate_light_hard(bench):
    """Part of the rendered markers that were found."""
    return bench.hard_light_score.found_rate


@measurement("false_markers_light", "False markers in both", "", target=at_most(0))
def false_markers_light(bench):
    """Reported markers that are none of the rendered ones."""
    return bench.light_score.false + bench.hard_light_score.false


@measurement("false_markers_photographs", "False markers in 20 photographs", "", target=at_most(0))
def false_markers_photographs(bench):
    """Markers reported where there are none."""
    return bench.photograph_markers
