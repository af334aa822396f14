#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <thread>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nendo/base/text.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/sculpting/live_loop.hpp>

#include "python/frames.hpp"
#include "python/gloves.hpp"
#include "python/meshes.hpp"

namespace nendo::python {
namespace {

constexpr std::chrono::milliseconds between_looks{2};

/// A running loop. A thread of its own prepares undos and takes frames, also while Python is busy
/// or waits for input, as at its prompt. Thread-safe.
class Session {
public:
  explicit Session(sculpting::LiveLoop begun)
      : live_(std::move(begun)), keeper_([this] { keep(); }) {}
  ~Session() {
    const WithoutGil released;
    stop_keeper();
    const sculpting::LiveLoop last(std::move(live_)); // which stops here
  }

  std::optional<FrameCopy> frame() {
    return without_gil(mutex_, [this]() -> std::optional<FrameCopy> {
      if (live_.frame().ticks_run == 0) return std::nullopt;
      return copy_of(live_.frame());
    });
  }
  /// Waits for a frame after the last one that it returned.
  FrameCopy next() {
    std::optional<FrameCopy> newest;
    wait_for(std::numeric_limits<double>::infinity(), [&](HostTime until) {
      for (;;) {
        {
          const std::lock_guard<std::mutex> alone(mutex_);
          const flow::Frame& frame = live_.frame();
          if (frame.ticks_run > seen_) newest = copy_of(frame);
          seen_ = std::max(seen_, frame.ticks_run);
          if (newest || finished_ || live_.has_ended()) return true;
        }
        if (HostClock::now() >= until) return false;
        std::this_thread::sleep_for(between_looks);
      }
    });
    if (!newest) throw py::stop_iteration();
    return *newest;
  }
  py::array vertices() {
    const deform::Points points = without_gil(mutex_, [this]() -> deform::Points {
      if (finished_) return finished_->mesh->vertices;
      return live_.vertices().colwise() + live_.model().offset;
    });
    return array_of(points);
  }
  void ask(const flow::Command& command) {
    check(without_gil(mutex_, [&]() -> Result<void> {
      if (finished_) return Error{Errc::failed, "the session has finished"};
      return live_.ask(command);
    }));
  }
  flow::LoopSettings settings() {
    return without_gil(mutex_, [this] { return live_.settings(); });
  }
  PyMesh finish() {
    without_gil([this] { stop_keeper(); });
    return without_gil(mutex_, [this] {
      if (!finished_) {
        deform::Mesh mesh = live_.finish();
        deform::count_from(Eigen::Vector3d::Zero(), mesh); // as the caller's model
        finished_.emplace(std::move(mesh));
      }
      return *finished_;
    });
  }
  py::dict stats() {
    if (!without_gil(mutex_, [this] { return finished_.has_value(); }))
      raise({Errc::failed, "the counts are known after finish()"});
    const flow::LoopStats& stats = live_.stats(); // which nothing changes any more
    py::dict counts;
    counts["ticks"] = stats.ticks;
    counts["missed"] = stats.missed;
    counts["overruns"] = stats.overruns;
    counts["samples"] = py::make_tuple(stats.samples[0], stats.samples[1]);
    counts["undos"] = stats.undos;
    counts["work_p99_s"] = to_seconds(stats.work.percentile(0.99));
    return counts;
  }
  py::list gloves() const {
    py::list all;
    for (const sculpting::OpenHand& hand : live_.hands())
      all.append(hand.glove->info());
    return all;
  }
  std::vector<std::string> notes() const { return live_.notes(); }
  py::array faces() const { return faces_of(live_.model()); }

private:
  void keep() {
    while (!is_stopped_) {
      {
        const std::lock_guard<std::mutex> alone(mutex_);
        live_.update();
      }
      std::this_thread::sleep_for(between_looks);
    }
  }
  void stop_keeper() {
    is_stopped_ = true;
    const std::lock_guard<std::mutex> alone(joining_);
    if (keeper_.joinable()) keeper_.join();
  }

  std::mutex mutex_, joining_;
  sculpting::LiveLoop live_;
  std::optional<PyMesh> finished_;
  std::uint64_t seen_ = 0;
  std::atomic<bool> is_stopped_{false};
  std::thread keeper_;
};

std::unique_ptr<Session> begin(const py::object& model, const std::string& left,
                               const std::string& right, const std::string& user,
                               const std::string& calibration, const std::string& mode,
                               std::optional<double> model_size_m, std::optional<double> radius_m,
                               double rate_hz, unsigned priority) {
  sculpting::LiveOptions options;
  options.left = left;
  options.right = right;
  options.calibration.user = user;
  options.calibration.calibration = calibration;
  options.mode = choice_of(mode, "mode", flow::setting::mode.choices(), flow::mode_named);
  options.model_size_m = model_size_m;
  options.radius_m = radius_m;
  options.pace.rate_hz = rate_hz;
  options.realtime.priority = priority;
  deform::Mesh mesh =
      py::isinstance<PyMesh>(model)
          ? *model.cast<const PyMesh&>().mesh
          : read_near_zero(argument_as<std::filesystem::path>(model, "model", "a Mesh or a path"));
  auto live = value_of(without_gil([&] {
    deform::count_from(deform::usual_offset(mesh), mesh);
    return sculpting::LiveLoop::begin(std::move(mesh), options);
  }));
  return std::make_unique<Session>(std::move(live));
}

py::object to_python(double number) {
  return py::float_(number);
}
py::object to_python(bool is_on) {
  return py::bool_(is_on);
}
py::object to_python(std::string_view name) {
  return to_str(name);
}
py::object to_python(const std::array<double, 5>& fingers) {
  return py::cast(fingers);
}

py::dict dict_of(const flow::LoopSettings& settings) {
  py::dict all;
  flow::for_each_setting([&](const auto& setting) {
    all[to_str(setting.name)] = to_python(flow::reported_value(setting, settings));
  });
  return all;
}

/// Returns a value for flow::set_from_text().
std::string value_text(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value) || !py::isinstance<py::sequence>(value))
    return py::str(value).cast<std::string>();
  std::string text;
  for (const py::handle item : value.cast<py::sequence>())
    text += (text.empty() ? "" : ",") + value_text(item);
  return text;
}

void change(Session& session, const py::kwargs& wanted) {
  flow::LoopSettings settings = session.settings();
  const py::dict known = dict_of(settings);
  for (const auto& [name, value] : wanted) {
    if (!known.contains(name))
      throw py::type_error("there is no such setting; see Session.settings");
    const auto set = flow::set_from_text(settings, name.cast<std::string>(), value_text(value));
    if (!set) throw py::value_error(set.error().message);
  }
  session.ask(flow::ChangeSettings{settings});
}

/// In the order of flow::Request, whose own names have spaces.
constexpr std::array<std::string_view, flow::requests.size()> request_names{
    "grab", "release", "commit", "undo", "redo", "reset", "regrab"};

void request(Session& session, const std::string& name) {
  session.ask(choice_of(name, "request", "grab, release, commit, undo, redo, reset or regrab",
                        [](const std::string& wanted) {
                          return enumerator_named<flow::Request>(request_names, wanted);
                        }));
}

void move_wrist(Session& session, const std::string& side, const py::object& pose) {
  const auto move =
      flow::WristMove::to(*side_of(side), motion_of(view_of(pose, "pose", {4, 4}).data, "pose"));
  if (!move.is_usable()) throw py::value_error("pose: " + std::string(flow::WristMove::refusal));
  session.ask(move);
}

} // namespace

void add_session(py::module_& module) {
  py::class_<Session> session(
      module, "Session",
      "Gloves that shape a model, as in `nendo run`. The loop has a thread of its own, "
      "which Python never delays. `model` is a Mesh or a file. `left` and `right` are "
      "gloves as in open(); without both, those of this machine, or simulated hands. "
      "`mode` is type1, type2, clay or parts; `priority` 1 to 97 asks for real-time "
      "rights. Blocks for some seconds. Raises Error. Iteration yields the newest "
      "Frame, until recordings that drive the hands end. Any thread may use it.");
  session
      .def(py::init(&begin), py::arg("model"), py::kw_only(), py::arg("left") = "",
           py::arg("right") = "", py::arg("user") = "", py::arg("calibration") = "",
           py::arg("mode") = "type1", py::arg("model_size_m") = py::none(),
           py::arg("radius_m") = py::none(), py::arg("rate_hz") = 90.0, py::arg("priority") = 0U)
      .def("frame", &Session::frame, "Returns the newest Frame; None before the first tick.")
      .def_property_readonly("vertices", &Session::vertices,
                             "(n, 3): the newest shape, in the model's units.")
      .def_property_readonly("faces", &Session::faces, "(t, 3) uint32: the model's triangles.")
      .def_property_readonly("gloves", &Session::gloves, "A list of GloveInfo, left hand first.")
      .def_property_readonly("notes", &Session::notes, "Messages for the user, one line each.")
      .def_property_readonly(
          "settings", [](Session& own) { return dict_of(own.settings()); },
          "The settings, last requested: {name: value}.")
      .def("change", &change,
           "Changes settings by their names, such as change(mode=\"type2\", "
           "radius_m=0.05), from the loop's next tick on. Raises Error.")
      .def("ask", &request, py::arg("request"),
           "Asks for \"grab\", \"release\", \"commit\", \"undo\", \"redo\", \"reset\" or "
           "\"regrab\" at the next "
           "tick. Raises Error if too many requests wait.")
      .def("move_wrist", &move_wrist, py::arg("side"), py::arg("pose"),
           "Moves the end of a hand's forearm to `pose` (4, 4), on the stage, in metres.")
      .def("finish", &Session::finish,
           "Stops the loop and the gloves, and returns the shaped Mesh. May block for a second.")
      .def_property_readonly("stats", &Session::stats,
                             "A dict after finish(): ticks, missed, overruns, samples, undos, "
                             "work_p99_s.")
      .def(
          "close", [](Session& own) { own.finish(); }, "As finish().")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Session& own, const py::args&) { own.finish(); })
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &Session::next);
  // pybind11 shows the object to no function after it is made.
  const py::object construct = session.attr("__init__");
  const auto doc = construct.attr("__doc__").cast<std::string>();
  session.attr("__init__") = py::cpp_function(
      [construct](const py::object& self, const py::args& arguments, const py::kwargs& named) {
        construct(self, *arguments, **named);
        close_at_exit(self);
      },
      py::is_method(session), doc.c_str());
}

} // namespace nendo::python
