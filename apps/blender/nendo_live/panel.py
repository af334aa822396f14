"""The panel in the sidebar of the 3-D view (N, tab Nendo), its buttons, and the preferences."""
import textwrap

import bpy
from bpy.props import BoolProperty, EnumProperty, PointerProperty, StringProperty

from . import live as follow
from . import shaping, takes


_PIXELS_PER_LETTER = 8.0


def live():
    return follow.live


def write(context, layout, text):
    """A label cuts off what does not fit, so long lines are several."""
    letters = context.region.width / (_PIXELS_PER_LETTER * context.preferences.system.ui_scale)
    column = layout.column(align=True)
    for line in textwrap.wrap(text, max(16, int(letters))):
        column.label(text=line)


class NendoPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(name="Program", default="nendo", subtype="FILE_PATH",
                            description="The program nendo: its name, or its path")
    left: StringProperty(name="Left glove", description="GLOVE of the left hand, as `nendo devices` lists it, such as sim:sculpt")
    right: StringProperty(name="Right glove", description="GLOVE of the right hand, as `nendo devices` lists it")
    left_wrist: StringProperty(name="Left tracker", description="TRACKER that moves the left hand; empty: none")
    right_wrist: StringProperty(name="Right tracker", description="TRACKER that moves the right hand; empty: none")
    more: StringProperty(name="More options", description="Of `nendo run`, such as --mode type2 --symmetry")
    web: BoolProperty(name="Controls in a browser", default=True,
                      description="Lets a browser on this machine grab, release, undo and change settings of the run (--web 0)")

    def draw(self, context):
        column = self.layout.column()
        column.label(text="Shape Model starts `nendo run` with these. Empty gloves: all that nendo finds, or simulated hands")
        for name in ("program", "left", "right", "left_wrist", "right_wrist", "more", "web"):
            column.prop(self, name)

    def options(self):
        return {name: getattr(self, name) for name in ("left", "right", "left_wrist", "right_wrist", "more", "web")}


def _set_makes_objects(self, _context):
    live().makes_objects = self.makes_objects


class NendoSettings(bpy.types.PropertyGroup):
    makes_objects: BoolProperty(name="Objects at once", default=True, update=_set_makes_objects,
                                description="Makes the model and an armature for each hand when a run begins")
    shape_as: EnumProperty(name="Shape", default=takes.SHAPE_KEYS, description="How a take keeps the shape", items=[
        (takes.SHAPE_KEYS, "Shape keys", f"One shape key per frame in which the shape changes, at most {takes.MAX_SHAPE_KEYS}"),
        (takes.CACHE, "Cache file", "A PC2 file beside the saved .blend, for long takes"),
        (takes.NO_SHAPE, "Hands only", "Only the armatures")])


class Button(bpy.types.Operator):
    """Reports what prevents the action, in one line."""
    bl_options = {"REGISTER"}

    def finish(self, problem):
        follow.wake()
        if problem:
            self.report({"ERROR"}, problem)
            return {"CANCELLED"}
        return {"FINISHED"}


class NENDO_OT_connect(Button):
    bl_idname, bl_label = "nendo.connect", "Connect"
    bl_description = "Follows this run"
    name: StringProperty(name="Name", description="NAME of `nendo run --to shm:NAME`")

    def execute(self, context):
        live().makes_objects = context.scene.nendo_live.makes_objects
        live().connect(self.name)
        return self.finish("")


class NENDO_OT_disconnect(Button):
    bl_idname, bl_label = "nendo.disconnect", "Disconnect"
    bl_description = "Stops following the run. Its objects stay"

    @classmethod
    def poll(cls, _context):
        return live().link is not None and live().shaping is None

    def execute(self, context):
        live().disconnect()
        return self.finish("")


class NENDO_OT_make_objects(Button):
    bl_idname, bl_label = "nendo.make_objects", "Make Objects"
    bl_description = "Makes the model and the armatures of the hands, if they are missing"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, _context):
        return live().link is not None

    def execute(self, context):
        return self.finish("" if live().make_objects() else live().message)


class NENDO_OT_record(Button):
    bl_idname, bl_label = "nendo.record", "Record"
    bl_description = "Records both hands and the shape from the current frame on, at the scene's rate"

    @classmethod
    def poll(cls, _context):
        return live().link is not None and live().take is None

    def execute(self, context):
        return self.finish(live().begin_take(context.scene.nendo_live.shape_as))


class NENDO_OT_end_record(Button):
    bl_idname, bl_label = "nendo.end_record", "Stop Recording"
    bl_description = "Ends the recording, and makes a take of it: a collection with its own armatures and model"

    @classmethod
    def poll(cls, _context):
        return live().take is not None

    def execute(self, context):
        live().end_take()
        return self.finish("")


class NENDO_OT_shape(Button):
    bl_idname, bl_label = "nendo.shape", "Shape Model"
    bl_description = "Starts `nendo run` with the active mesh. Shape keys and modifiers are not applied"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH" and context.mode == "OBJECT" and live().shaping is None

    def execute(self, context):
        preferences = context.preferences.addons[__package__].preferences
        live().makes_objects = True
        return self.finish(live().shape(context.object, preferences.program, preferences.options()))


class _BringBack(Button):
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return live().shaping is not None and live().link.epoch > 0 and context.mode == "OBJECT"

    def execute(self, context):
        try:
            self.bring(live().shaping, live().link)
        except shaping.CannotShape as error:
            return self.finish(str(error))
        return self.finish("")


class NENDO_OT_bring_key(_BringBack):
    bl_idname, bl_label = "nendo.bring_key", "Bring Back as Shape Key"
    bl_description = "Adds the current shape to the original mesh as a shape key"

    def bring(self, shaped, link):
        self.report({"INFO"}, f"{shaped.source} has the shape key {shaped.bring_back_as_key(link)}")


class NENDO_OT_bring_mesh(_BringBack):
    bl_idname, bl_label = "nendo.bring_mesh", "Bring Back as Mesh"
    bl_description = "Makes another object with the current shape; the original stays hidden"

    def bring(self, shaped, link):
        self.report({"INFO"}, f"{shaped.bring_back_as_mesh(link).name}: the original is hidden (Alt H shows it)")


class NENDO_OT_end_shaping(Button):
    bl_idname, bl_label = "nendo.end_shaping", "End Run"
    bl_description = "Ends the run. What you have not brought back is lost"

    @classmethod
    def poll(cls, _context):
        return live().shaping is not None

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        live().disconnect()
        return self.finish("")


class NENDO_PT_live(bpy.types.Panel):
    bl_idname, bl_label, bl_category = "NENDO_PT_live", "Nendo Live", "Nendo"
    bl_space_type, bl_region_type = "VIEW_3D", "UI"

    def draw(self, context):
        now, layout = live(), self.layout
        if now.link is None:
            self._draw_runs(context, now, layout)
        else:
            self._draw_connection(context, now, layout)
        row = layout.row()
        row.enabled = now.shaping is None
        row.prop(context.scene.nendo_live, "makes_objects")

    @staticmethod
    def _draw_runs(context, now, layout):
        write(context, layout, now.message)
        for name in now.runs:
            layout.operator("nendo.connect", text=f"Connect to {name}", icon="LINKED").name = name
        if not now.runs:
            write(context, layout, "No run publishes on this machine. Start one in a terminal: nendo run --to shm:clay")

    @staticmethod
    def _draw_connection(context, now, layout):
        write(context, layout, now.message)
        content = now.link.content
        if content is not None:
            write(context, layout, f"{now.link.rate_hz:.0f} ticks per second")
            write(context, layout, f"{content.vertices:,} vertices")
        if now.shaping is None:
            layout.operator("nendo.disconnect", icon="UNLINKED")
        layout.operator("nendo.make_objects", icon="ADD")


class NENDO_PT_take(bpy.types.Panel):
    bl_idname, bl_label, bl_category = "NENDO_PT_take", "Take", "Nendo"
    bl_space_type, bl_region_type = "VIEW_3D", "UI"

    @classmethod
    def poll(cls, _context):
        return live().link is not None

    def draw(self, context):
        now, layout = live(), self.layout
        if now.take is not None:
            layout.operator("nendo.end_record", icon="SNAP_FACE")
            layout.label(text=f"{now.take.length} frames")
            if now.take.note:
                write(context, layout, now.take.note)
            return
        layout.prop(context.scene.nendo_live, "shape_as")
        layout.operator("nendo.record", icon="REC")
        if now.is_building():
            layout.label(text="The take is being made")


class NENDO_PT_shape(bpy.types.Panel):
    bl_idname, bl_label, bl_category = "NENDO_PT_shape", "Shape a Model", "Nendo"
    bl_space_type, bl_region_type = "VIEW_3D", "UI"

    def draw(self, context):
        now, layout = live(), self.layout
        if now.shaping is None:
            active = context.object
            named = active is not None and active.type == "MESH"
            text = f"Shape {active.name}" if named else "Select a mesh to shape it"
            layout.operator("nendo.shape", text=text, icon="SCULPTMODE_HLT")
            return
        layout.label(text=f"Shaping {now.shaping.source}")
        address = now.shaping.run.address()
        if address:
            layout.operator("wm.url_open", text="Controls in a Browser", icon="URL").url = address
        layout.operator("nendo.bring_key", icon="SHAPEKEY_DATA")
        layout.operator("nendo.bring_mesh", icon="MESH_DATA")
        layout.operator("nendo.end_shaping", icon="CANCEL")


CLASSES = (NendoPreferences, NendoSettings, NENDO_OT_connect, NENDO_OT_disconnect, NENDO_OT_make_objects, NENDO_OT_record,
           NENDO_OT_end_record, NENDO_OT_shape, NENDO_OT_bring_key, NENDO_OT_bring_mesh, NENDO_OT_end_shaping, NENDO_PT_live,
           NENDO_PT_take, NENDO_PT_shape)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.nendo_live = PointerProperty(type=NendoSettings)


def unregister():
    del bpy.types.Scene.nendo_live
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
