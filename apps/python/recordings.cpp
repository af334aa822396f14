#include <array>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/offset.hpp>
#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_tools.hpp>

#include "python/device.hpp"
#include "python/frames.hpp"
#include "python/gloves.hpp"
#include "python/meshes.hpp"

namespace nendo::python {
namespace {

struct TickRow {
  std::uint64_t number;
  double scheduled_s, woke_s;
};

/// Reads the model that the loop had, in one of the ways in which `nendo run` can have read it.
deform::Mesh recorded_model(const recording::LoopSetup& loop) {
  using deform::UpAxis;
  check_readable(loop.mesh);
  for (const deform::ReadOptions& options : {deform::ReadOptions{UpAxis::y, true},
                                             {UpAxis::z, true},
                                             {UpAxis::y, false},
                                             {UpAxis::z, false}}) {
    auto model = value_of(without_gil([&] { return deform::read_model(loop.mesh, options); }));
    deform::count_from(deform::usual_offset(model.mesh), model.mesh);
    if (recording::sum_of(model.mesh.vertices) == loop.mesh_sum) return std::move(model.mesh);
  }
  raise({Errc::bad_input, loop.mesh + ": is not as it was when it was recorded; pass `model`"});
}

/// Runs a recorded loop again, tick by tick. One thread at a time.
class Replay {
public:
  Replay(recording::TakeReader reader, const deform::Mesh& model)
      : offset_(model.offset), reader_(std::move(reader)),
        replay_(value_of(
            without_gil([&] { return recording::LoopReplay::make(reader_.setup(), model); }))) {}

  /// Returns false at the end of the recording.
  bool next() {
    const bool has_run = without_gil(mutex_, [this] {
      while (const auto entry = reader_.next()) {
        if (!replay_->feed(*entry)) continue;
        replay_->loop().frames().update();
        return true;
      }
      return false;
    });
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return has_run;
  }
  FrameCopy frame() {
    return without_gil(mutex_, [this] { return copy_of(front()); });
  }
  py::array vertices() {
    deform::Points points;
    without_gil(mutex_, [&] {
      replay_->loop().changes().layout(front().model).unpack(front().shape, points);
      points.colwise() += offset_;
    });
    return array_of(points);
  }
  bool is_exact() {
    return without_gil(mutex_, [this] { return replay_->is_exact(); });
  }

private:
  const flow::Frame& front() { return replay_->loop().frames().front(); }

  std::mutex mutex_;
  Eigen::Vector3d offset_;
  recording::TakeReader reader_;
  std::unique_ptr<recording::LoopReplay> replay_;
};

/// A recording's file. Each function reads it again.
class Recording {
public:
  explicit Recording(std::filesystem::path file) : path(std::move(file)), setup(open().setup()) {}

  recording::TakeReader open() const {
    check_readable(path);
    return value_of(without_gil([this] { return recording::TakeReader::open(path); }));
  }
  /// Returns what `pick` returns for each entry, where it returns anything.
  template <class Row, class Pick>
  std::vector<Row> rows(Pick pick) const {
    auto reader = open();
    return without_gil([&] {
      std::vector<Row> all;
      while (const auto entry = reader.next())
        if (const std::optional<Row> row = pick(*entry)) all.push_back(*row);
      return all;
    });
  }
  const recording::LoopSetup& loop() const {
    if (!setup.loop) raise({Errc::bad_input, path.string() + ": no loop was recorded"});
    return *setup.loop;
  }
  std::unique_ptr<Replay> replay(const PyMesh* model) const {
    deform::Mesh mesh = model != nullptr ? *model->mesh : recorded_model(loop());
    deform::count_from(deform::usual_offset(mesh), mesh);
    for (const auto& origin : loop().origins)
      mesh = value_of(without_gil([&] { return flow::rebuild(mesh, *origin); }));
    return std::make_unique<Replay>(open(), mesh);
  }

  const std::filesystem::path path;
  const recording::Setup setup;
};

py::array samples(const Recording& own, std::size_t glove) {
  if (glove >= own.setup.gloves.size()) throw py::index_error("glove: there is no such glove");
  return array_of(own.rows<GloveSample>([glove](const recording::Entry& entry) {
    const auto* const one = std::get_if<recording::RecordedSample>(&entry);
    return one != nullptr && one->glove == glove ? std::optional(one->sample) : std::nullopt;
  }));
}

py::array poses(const Recording& own, const std::string& side) {
  const Side wanted = *side_of(side);
  return array_of(own.rows<PoseSample>([wanted](const recording::Entry& entry) {
    const auto* const one = std::get_if<recording::RecordedPose>(&entry);
    return one != nullptr && one->side == wanted ? std::optional(one->pose) : std::nullopt;
  }));
}

py::array ticks(const Recording& own) {
  return array_of(own.rows<TickRow>([](const recording::Entry& entry) {
    const auto* const tick = std::get_if<flow::LoggedTick>(&entry);
    return tick == nullptr ? std::nullopt
                           : std::optional(TickRow{tick->number, seconds_of(tick->scheduled),
                                                   seconds_of(tick->woke)});
  }));
}

CalibrationFile calibration(const Recording& own, std::size_t glove) {
  if (glove >= own.setup.gloves.size() || glove >= own.setup.hands.size())
    throw py::index_error("glove: there is no such glove");
  const driver::GloveInfo& info = own.setup.gloves[glove];
  const hand::WearerHand& worn = own.setup.hands[glove].wearer.of(info.side);
  CalibrationFile file;
  file.wearer.user = own.setup.wearer;
  file.wearer.glove_model = info.model;
  file.wearer.counts = info.counts;
  file.wearer.side = info.side;
  file.wearer.method = "recorded";
  file.wearer.size = worn.size;
  file.wearer.calibration = worn.calibration;
  file.wearer.left_out = worn.left_out;
  return file;
}

py::array hands(const Recording& own, const PyMesh* model) {
  const auto replay = own.replay(model);
  std::vector<double> all;
  py::ssize_t count = 0;
  for (; replay->next(); ++count) {
    const FrameCopy frame = replay->frame();
    all.insert(all.end(), frame.hands.begin(), frame.hands.end());
  }
  return array_of(all.data(), {count, 2, hand::joint_count, numbers_per_joint});
}

py::dict setup(const Recording& own) {
  py::dict made;
  made["program"] = to_str(own.setup.program);
  made["wearer"] = to_str(own.setup.wearer);
  made["begun_utc_s"] = to_seconds(own.setup.begun.time_since_epoch());
  made["begun_s"] = seconds_of(own.setup.begun_host);
  if (!own.setup.loop) return made;
  made["model"] = to_str(own.setup.loop->mesh);
  made["rate_hz"] = own.setup.loop->options.rate_hz;
  made["units_per_metre"] = own.setup.loop->placement.units_per_metre;
  made["mode"] = to_str(name_of(own.setup.loop->options.sculptor.mode));
  return made;
}

py::dict summary(const Recording& own) {
  const auto made = value_of(without_gil([&] { return recording::summarise(own.path); }));
  py::dict counts;
  counts["duration_s"] = to_seconds(made.duration());
  counts["ticks"] = made.ticks;
  counts["missed"] = made.missed;
  counts["gaps"] = made.gaps;
  counts["damages"] = made.damage_count;
  counts["is_whole"] = made.is_whole();
  counts["has_ended"] = made.ending.has_value();
  return counts;
}

} // namespace

void add_recordings(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(TickRow, number, scheduled_s, woke_s);
  module.attr("tick_dtype") = py::dtype::of<TickRow>();
  py::class_<Replay>(
      module, "Replay",
      "Runs a recorded loop again, without a clock: iteration yields a Frame for each "
      "tick. Releases the GIL; threads use it in turn.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__",
           [](Replay& own) {
             if (!own.next()) throw py::stop_iteration();
             return own.frame();
           })
      .def_property_readonly("vertices", &Replay::vertices,
                             "(n, 3): the shape of the last frame, in model units.")
      .def_property_readonly(
          "is_exact", &Replay::is_exact,
          "Whether no entry was missing so far, so that the shape is that of then.");

  py::class_<Recording>(
      module, "Recording",
      "A recording (.nendo). Each function reads the file again, without the GIL. "
      "Times are seconds of the recording machine's time.monotonic(). Raises Error, "
      "NotFoundError. Any thread may use it.")
      .def(py::init<std::filesystem::path>(), py::arg("path"))
      .def_property_readonly(
          "gloves", [](const Recording& own) { return own.setup.gloves; }, "A list of GloveInfo.")
      .def_property_readonly("setup", &setup,
                             "A dict: program, wearer, begun_utc_s, begun_s; and of a loop: model, "
                             "rate_hz, units_per_metre, mode.")
      .def("summary", &summary,
           "Returns a dict: duration_s, ticks, missed, gaps, damages, is_whole, has_ended.")
      .def("samples", &samples, py::arg("glove") = 0,
           "Returns the samples of a glove, by its index in `gloves`: (n,) of sample_dtype.")
      .def("poses", &poses, py::arg("side") = "right",
           "Returns the poses of the tracker of that wrist: (n,) of pose_dtype.")
      .def("ticks", &ticks, "Returns the ticks of the loop: (t,) of tick_dtype.")
      .def("calibration", &calibration, py::arg("glove") = 0,
           "Returns the Calibration that the glove had.")
      .def("replay", &Recording::replay, py::arg("model") = py::none(),
           "Returns a Replay. `model` is the Mesh on which the hands worked; without it, its file "
           "is "
           "read again.")
      .def("hands", &hands, py::arg("model") = py::none(),
           "Replays the loop, and returns the hands of all ticks: (t, 2, 26, 7), as Frame.hands.");
}

} // namespace nendo::python
