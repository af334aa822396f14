"""All that differs between versions of Blender. Blender 3.4 (Debian 12) and 4.3 (Debian 13) are tested; slotted actions, which are
those of 4.4 and later, are written from Blender's documentation."""
import contextlib

import bpy


def set_polygons(mesh, sizes, starts, corners):
    """Fills an empty mesh that has vertices. Since 3.6, a polygon's size follows from where the next one starts."""
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(starts))
    mesh.polygons.foreach_set("loop_start", starts)
    if not bpy.types.MeshPolygon.bl_rna.properties["loop_total"].is_readonly:
        mesh.polygons.foreach_set("loop_total", sizes)


def animate(owner, name):
    """Gives this ID a new action; returns the action, and a function (data path, index, group) that makes an F-curve in it."""
    action = bpy.data.actions.new(name)
    animation = owner.animation_data_create()
    animation.action = action
    if hasattr(action, "slots"):
        slot = action.slots.new(id_type=owner.id_type, name=owner.name)
        animation.action_slot = slot
        curves = action.layers.new("Layer").strips.new(type="KEYFRAME").channelbag(slot, ensure=True).fcurves
        return action, lambda path, index, group: curves.new(path, index=index)
    return action, lambda path, index, group: action.fcurves.new(path, index=index, action_group=group)


def in_window():
    """A context with a window, in which operators work when a timer calls them."""
    windows = bpy.context.window_manager.windows
    if bpy.context.window is not None or not windows:
        return contextlib.nullcontext()
    return bpy.context.temp_override(window=windows[0])


def push_undo(name):
    """Makes an undo step after a timer has made objects. Otherwise the user's next undo would remove it."""
    with in_window():
        if bpy.ops.ed.undo_push.poll():
            bpy.ops.ed.undo_push(message=name)


def is_rendering():
    return bpy.app.is_job_running("RENDER")
