"""Nendo Live: the hands and the shape of a run of Nendo in Blender, while they move. apps/blender/README.md explains its use.

segment, link, mapping, ply, keys and process need nothing of Blender, and are tested without it."""

bl_info = {  # for Blender before 4.2; blender_manifest.toml is for later versions
    "name": "Nendo Live",
    "author": "Nendo maintainers",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "3D View, sidebar (N), tab Nendo",
    "description": "Shows data gloves' hands and the shape that they sculpt, as armatures and a mesh",
    "category": "Animation",
}


def register():
    from . import live, panel
    panel.register()
    live.register()


def unregister():
    from . import live, panel
    live.unregister()
    panel.unregister()
