#include <algorithm>
#include <memory>
#include <thread>
#include <vector>

#include "publish/mapped_segment.hpp"
#include "python/frames.hpp"

namespace nendo::python {
namespace {

constexpr std::chrono::milliseconds between_records{1};
constexpr int tries = 1000; ///< a reader is too late only if the writer is faster than a copy

/// Another program's run, in shared memory.
class Segment {
public:
  explicit Segment(publish::MappedSegment mapped)
      : mapped_(std::move(mapped)), contents_(mapped_.contents()) {}

  static std::unique_ptr<Segment> attach(const std::string& name);

  std::uint64_t newest() const noexcept { return contents_.newest(); }
  bool has_ended() const noexcept { return mapped_.has_ended(); }

  /// Returns the frame of record `number`, or nullopt if the writer has overwritten it.
  std::optional<FrameCopy> frame(std::uint64_t number) const {
    nendo_publish_record record;
    nendo_publish_states states{};
    if (!contents_.copy(contents_.record_at(number), number, record)) return std::nullopt;
    const bool has_angles =
        contents_.has_states() && contents_.copy(contents_.states_at(number), number, states);
    return copy_of(record, has_angles ? &states : nullptr);
  }
  FrameCopy newest_frame() const {
    return newest_of<FrameCopy>([this](std::uint64_t number) { return frame(number); });
  }
  /// Returns a frame after the last one that it returned.
  FrameCopy next() {
    std::optional<FrameCopy> found;
    wait_for(std::numeric_limits<double>::infinity(), [&](HostTime until) {
      for (;;) {
        const bool is_last = has_ended();
        const std::uint64_t number = newest();
        if (number > seen_) found = frame(number);
        if (found) seen_ = number;
        if (found || (is_last && number <= seen_)) return true;
        if (HostClock::now() >= until) return is_last; // the last record stays damaged
        std::this_thread::sleep_for(between_records);
      }
    });
    if (!found) throw py::stop_iteration();
    return *found;
  }

  deform::Points vertices() const {
    return newest_of<deform::Points>([this](std::uint64_t number) -> std::optional<deform::Points> {
      nendo_publish_setup setup;
      std::vector<float> floats(3 * std::size_t{header().vertices});
      const std::uint64_t at = contents_.shape_at(number);
      if (!contents_.copy_setup(setup) ||
          !contents_.copy(at, number, at + sizeof(nendo_publish_shape), floats.data(),
                          4 * floats.size()) ||
          !contents_.copy_of_setup(setup.generation, at, nullptr, 0)) // it is still the same
        return std::nullopt;
      const Eigen::Map<const Eigen::Matrix3Xf> from(floats.data(), 3, header().vertices);
      const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3d>(setup.origin) +
                                     Eigen::Map<const Eigen::Vector3d>(setup.offset);
      return deform::Points((setup.unit * from.cast<double>()).colwise() + origin);
    });
  }
  /// Returns the corners of the triangles.
  std::vector<std::uint32_t> triangles() const {
    for (int attempt = 0; attempt < tries; ++attempt) {
      nendo_publish_setup setup;
      std::vector<std::uint32_t> corners(3 * std::size_t{header().triangles});
      if (!contents_.copy_setup(setup) ||
          !contents_.copy_of_setup(setup.generation, header().triangles_offset, corners.data(),
                                   4 * corners.size()))
        continue;
      if (std::all_of(corners.begin(), corners.end(),
                      [this](std::uint32_t corner) { return corner < header().vertices; }))
        return corners;
      raise({Errc::bad_input, "the segment has a triangle without a vertex"});
    }
    raise({Errc::failed, "the segment's setup is not complete"});
  }
  const nendo_publish_header& header() const noexcept { return contents_.header(); }

private:
  /// Returns what `read` returns for the newest record.
  template <class Content, class Read>
  Content newest_of(Read read) const {
    for (int attempt = 0; attempt < tries; ++attempt)
      if (std::optional<Content> content = read(newest())) return *std::move(content);
    raise({Errc::failed, newest() == 0 ? "the run has not published a record yet"
                                       : "the newest record is not complete"});
  }
  static FrameCopy copy_of(const nendo_publish_record& record, const nendo_publish_states* states);

  publish::MappedSegment mapped_;
  const publish::CheckedSegment& contents_;
  std::uint64_t seen_ = 0;
};

FrameCopy Segment::copy_of(const nendo_publish_record& record, const nendo_publish_states* states) {
  FrameCopy copy;
  copy.number = record.number;
  copy.time_s = static_cast<double>(record.woke_ns) / 1e9;
  copy.held = (record.flags & NENDO_PUBLISH_HELD) != 0;
  copy.units_per_metre = record.units_per_metre;
  for (std::size_t side = 0; side < 2; ++side) {
    const nendo_publish_hand& hand = record.hands[side];
    copy.present[side] = (hand.flags & NENDO_PUBLISH_PRESENT) != 0;
    copy.silent[side] = (hand.flags & NENDO_PUBLISH_SILENT) != 0;
    if (!copy.present[side]) continue;
    double* out = copy.hands.data() + side * numbers_per_hand;
    for (const nendo_publish_joint& joint : hand.joints) {
      out = std::copy_n(joint.position, 3, out);
      out = std::copy_n(joint.orientation, 4, out);
    }
    if (states != nullptr)
      std::copy_n(states->hands[side].angles, hand::angle_count,
                  copy.angles.data() + side * hand::angle_count);
  }
  return copy;
}

std::unique_ptr<Segment> Segment::attach(const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos)
    throw py::value_error("name: use NAME of `nendo run --to shm:NAME`");
  const std::string path = publish::segment_path(name);
  check_readable(path);
  auto mapped = publish::MappedSegment::open(path);
  if (!mapped) raise(mapped.error());
  if (!*mapped) raise({Errc::failed, path + ": there is no such file"});
  return std::make_unique<Segment>(**std::move(mapped));
}

py::array array_of_hands(const Segment& own) {
  return array_of(own.newest_frame().hands.data(), hands_shape);
}
py::array array_of_angles(const Segment& own) {
  if (own.header().states_offset == 0)
    raise({Errc::failed, "the run is older than version 1.2 of the segment, and shows no angles"});
  return array_of(own.newest_frame().angles.data(), angles_shape);
}

} // namespace

void add_segment(py::module_& module) {
  py::class_<Segment>(
      module, "Segment",
      "A run of `nendo run --to shm:NAME`, from attach(). It reads shared memory, and "
      "never delays the run. Iteration yields the newest Frame, until the run ends; a "
      "run whose model changes continues in a new segment of the same name. "
      "Arrays are copies. One thread at a time.")
      .def("frame", &Segment::newest_frame,
           "Returns the newest Frame. Raises Error before the first.")
      .def("hands", &array_of_hands, "Returns (2, 26, 7), as Frame.hands.")
      .def("angles", &array_of_angles, "Returns (2, 23), as Frame.angles. Raises Error before 1.2.")
      .def(
          "vertices", [](const Segment& own) { return array_of(own.vertices()); },
          "Returns the newest shape, (n, 3) in the model's units.")
      .def_property_readonly(
          "faces",
          [](const Segment& own) {
            const std::vector<std::uint32_t> corners = own.triangles();
            return array_of(corners.data(), {static_cast<py::ssize_t>(corners.size() / 3), 3});
          },
          "(t, 3) uint32: the model's triangles.")
      .def_property_readonly(
          "version",
          [](const Segment& own) { return py::make_tuple(own.header().major, own.header().minor); },
          "The version of the format, such as (1, 2).")
      .def_property_readonly("has_ended", &Segment::has_ended,
                             "Whether the run has ended, or was killed.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &Segment::next);
  module.def(
      "attach", &Segment::attach, py::arg("name"),
      "Attaches to a run of `nendo run --to shm:NAME` of this user, or of a group that may read "
      "it. Raises NotFoundError, AccessError, Error.");
}

} // namespace nendo::python
