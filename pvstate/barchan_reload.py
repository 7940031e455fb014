"""A macro of ParaView: reads the list of frames of every open series anew, and goes to the last frame. For a run that is still going.

Macros > Import new macro..., once; then its button after each look. In pvpython: import barchan_reload, then barchan_reload.reload_series().
"""
from paraview import simple


def reload_series():
    """Reloads every series (.pvd) that is open and shows its last frame. Returns the times (s) that there are now."""
    for source in simple.GetSources().values():
        if source.GetXMLName() == "PVDReader":
            simple.ReloadFiles(source)
            source.UpdatePipelineInformation()
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = list(simple.GetTimeKeeper().TimestepValues)
    if times:
        scene.AnimationTime = times[-1]
        for view in simple.GetViews():
            view.ViewTime = times[-1]
    simple.RenderAllViews()
    return times


if __name__ in ("__main__", "__vtkconsole__"):
    reload_series()
