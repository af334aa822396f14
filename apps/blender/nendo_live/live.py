"""What the add-on does at the screen's rate: one object, one step, and one timer that calls it."""
import time
import traceback

import bpy

from . import compat, link, scene, segment, shaping, takes

STEP_S = 1.0 / 60.0
LIST_S = 1.0
_BUILD_S = 0.008  # of a step, for the objects of a take


class Live:
    """The connection of this Blender to a run. step() does not wait, and raises nothing."""

    def __init__(self):
        self.runs = []  # names of those that can be connected to
        self.link = self.objects = self.take = self.shaping = None
        self.message = "Not connected"
        self.makes_objects = True
        self.frame = None  # the newest that was shown
        self._met, self._shown = None, None  # an epoch and the hands that were there; an epoch and a number of shape changes
        self._building = None
        self._listed_at = 0.0

    # Connections

    def connect(self, name, source=""):
        """Follows this run from the next step on. `source` is the object that it shapes."""
        self.disconnect()
        self.link = link.Link(name, label=source and f"the run for {source}")
        self.objects, self.frame = scene.Objects(name, source), None
        self._met = self._shown = None
        self.message = self.link.state

    def disconnect(self):
        """Ends a take and a run that shapes a model. The objects stay."""
        self.end_take()
        self._finish_building()
        self.end_shaping()
        if self.link:
            self.link.close()
            self.link = None
            self.message = "Not connected"

    def list_runs(self):
        self.runs = segment.names_of_runs()
        self._listed_at = time.monotonic()

    # The step

    def step(self):
        """Reads the newest tick, and shows it."""
        try:
            self._step()
        except Exception as error:  # a timer that raises ends for good, and the user sees nothing
            traceback.print_exc()
            self._fail(f"Disconnected, because of an error: {error}")

    def _fail(self, message):
        for part in (self.disconnect, self._forget):
            try:
                part()
            except Exception:
                traceback.print_exc()
        self.message = message

    def _forget(self):
        self.link = self.take = self.shaping = self._building = None

    def _step(self):
        if time.monotonic() - self._listed_at > LIST_S and self.link is None:
            self.list_runs()
        if self._building is not None:
            self._build()
        if self.link is None:
            return
        if compat.is_rendering():
            self.message = "Paused while Blender renders"
            return
        frame = self.link.poll()
        self.message = self.link.state
        self._watch_run()
        if frame is None:
            return
        self._meet(frame)
        self.objects.show_hands(frame)
        self._show_shape(frame)
        self.frame = frame
        if self.take is not None:
            self._record(frame)

    def _watch_run(self):
        """Reports why a run that shapes a model has ended before it published."""
        if self.shaping is None or self.link.epoch > 0:
            return
        code = self.shaping.run.exit_code()
        if code is not None:
            why = self.shaping.run.last_line()
            self.disconnect()
            self.message = f"nendo ended with {code}: {why}"
        else:
            self.message = f"Shaping {self.shaping.source} begins"

    def _meet(self, frame):
        """Another model, or a hand for the first time, needs objects."""
        epoch, hands = self._met or (0, (False, False))
        is_new_content = epoch != self.link.epoch
        wanted = (self.link.epoch, tuple(one or other for one, other in zip(hands, frame.present)))
        if wanted == self._met:
            return
        if is_new_content:
            self.end_take()
            self._finish_building()  # a take copies the model, which is replaced below
        if self.makes_objects and not self.make_objects():
            return
        self._met, self._shown = wanted, None
        if self.makes_objects:
            compat.push_undo("Nendo objects")

    def make_objects(self):
        """Makes what is missing. False, with the reason in `message`, if that is not possible now."""
        frame, floats = self.link.current()
        if frame is None:
            self.message = "There is no tick of the run yet"
            return False
        content, placement, template = self.link.content, None, None
        if self.shaping is not None and self._met is None:  # later the user may have moved it, and another model has other polygons
            placement, template = self.shaping.placement(content, frame), self.shaping.template()
        try:
            self.objects.make(content, frame, template, placement)
        except scene.CannotMake as error:
            self.message = str(error)
            return False
        self.objects.show_hands(frame)
        self.objects.show_shape(floats, content, frame)
        return True

    def _show_shape(self, frame):
        wanted = (self.link.epoch, frame.shape_changes)
        if self._shown == wanted or self.link.content.vertices == 0:
            return
        floats = self.link.shape(frame)
        if floats is not None and self.objects.show_shape(floats, self.link.content, frame):
            self._shown = wanted

    # Takes

    def begin_take(self, shape_as):
        """Records from the next step on. Returns what prevents it, or an empty string."""
        if self.link is None or self.link.content is None:
            return "Connect to a run first"
        if self._building is not None:
            return "Wait until the previous take is made"
        path = takes.cache_path(self.link.name) if shape_as == takes.CACHE else None
        if shape_as == takes.CACHE and path is None:
            return "Save the .blend first: the shape is recorded into a file beside it. Or record it as shape keys"
        view = bpy.context.scene
        rate_hz = view.render.fps / view.render.fps_base
        self.take = takes.Take(self.objects, self.link.epoch, rate_hz, view.frame_current, shape_as, path)
        self._points = (None, None)
        return ""

    def _record(self, frame):
        """Takes the hands of all ticks since the previous step that the run still has, so that a busy interface loses few; and the newest
        shape, because a run keeps few shapes."""
        take = self.take
        for each in self.link.frames(take.last_number) if take.last_number else [frame]:
            take.add_frame(each)
        if take.shape_as == takes.NO_SHAPE or self.link.content.vertices == 0:
            return
        key = (self.link.epoch, frame.shape_changes)
        if self._points[0] != key:
            floats = self.link.shape(frame)
            if floats is None:
                return
            self._points = (key, self.objects.points(floats, self.link.content, frame).copy())
        take.add_shape(frame.woke_ns, self._points[1])

    def end_take(self):
        """Ends the recording. The following steps make its objects."""
        take, self.take = self.take, None
        if take is None:
            return
        if take.is_empty():
            take.discard()
            return
        self._building = take.build()

    def _build(self):
        until = time.monotonic() + _BUILD_S
        while self._building is not None and time.monotonic() < until:
            self._build_on()

    def _build_on(self):
        try:
            next(self._building)
        except StopIteration:
            self._building = None
            compat.push_undo("Nendo take")
        except ReferenceError:  # an undo meanwhile removed its objects
            self._building = None
        except Exception:
            self._building = None
            raise

    def _finish_building(self):
        while self._building is not None:
            self._build_on()

    def is_building(self):
        return self._building is not None

    # A model that is shaped

    def shape(self, source, program, options):
        """Starts a run that shapes this object. Returns what prevents it, or an empty string."""
        try:
            started = shaping.Shaping(source, program, options)
        except (shaping.CannotShape, ValueError, OSError) as error:
            return str(error)
        self.connect(started.name, started.source)
        self.shaping = started
        return ""

    def end_shaping(self):
        if self.shaping is None:
            return
        ended, self.shaping = self.shaping, None
        ended.end()
        self.objects.remove()


live = Live()


def _redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()


_drawn = None


def tick():
    """The timer."""
    global _drawn
    live.step()
    shown = (live.message, tuple(live.runs), live.link and round(live.link.rate_hz), live.is_building(),
             live.take and live.take.length)
    if shown != _drawn:
        _drawn = shown
        _redraw()
    return STEP_S if live.link or live.is_building() else LIST_S


def wake():
    """Calls the timer soon, and then at the screen's rate."""
    if bpy.app.background:
        return  # timers do not run there
    sleep()
    bpy.app.timers.register(tick, persistent=True)


def sleep():
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)


@bpy.app.handlers.persistent
def before_load(*_):
    """Another file has other objects."""
    live.disconnect()


def register():
    bpy.app.handlers.load_pre.append(before_load)
    wake()


def unregister():
    sleep()
    if before_load in bpy.app.handlers.load_pre:
        bpy.app.handlers.load_pre.remove(before_load)
    live.disconnect()
