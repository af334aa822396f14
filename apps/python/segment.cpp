#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo_publish.h>

#include "python/frames.hpp"

namespace nendo::python {
namespace {

constexpr std::chrono::milliseconds between_records{1};
constexpr int tries = 1000; ///< a reader is too late only if the writer is faster than a copy

/// Another program's run, in shared memory. The header is copied once, and checked, so that a
/// writer who changes it cannot make this reader leave the memory.
class Segment {
public:
  Segment(UniqueFd file, const char* base, std::uint64_t bytes, const nendo_publish_header& header)
      : file_(std::move(file)), base_(base), bytes_(bytes), header_(header) {}
  ~Segment() { ::munmap(const_cast<char*>(base_), bytes_); }
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  static std::unique_ptr<Segment> attach(const std::string& name);

  std::uint64_t newest() const noexcept { return nendo_publish_newest(base_); }
  /// Returns whether the run has ended, or was killed: while it lives, it holds a lock.
  bool has_ended() const noexcept {
    struct flock lock = {};
    lock.l_type = F_RDLCK;
    lock.l_whence = SEEK_SET;
    return nendo_publish_state(base_) == NENDO_PUBLISH_ENDED ||
           (::fcntl(file_.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type == F_UNLCK);
  }

  /// Returns the frame of record `number`, or nullopt if the writer has overwritten it.
  std::optional<FrameCopy> frame(std::uint64_t number) const {
    nendo_publish_record record;
    nendo_publish_states states{};
    const std::uint64_t slot = number % header_.record_slots;
    if (!copy(header_.records_offset + slot * header_.record_stride, number, record))
      return std::nullopt;
    const bool has_angles =
        header_.states_offset != 0 &&
        copy(header_.states_offset + slot * header_.states_stride, number, states);
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
      std::vector<float> floats(3 * std::size_t{header_.vertices});
      const std::uint64_t at =
          header_.shapes_offset + number % header_.shape_slots * header_.shape_stride;
      if (!copy_setup(setup) || !copy_behind(at, sizeof(nendo_publish_shape), number, floats) ||
          !nendo_publish_still_holds(stage(header_.setup_offset), setup.generation))
        return std::nullopt;
      const Eigen::Map<const Eigen::Matrix3Xf> from(floats.data(), 3, header_.vertices);
      const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3d>(setup.origin) +
                                     Eigen::Map<const Eigen::Vector3d>(setup.offset);
      return deform::Points((setup.unit * from.cast<double>()).colwise() + origin);
    });
  }
  /// Returns the corners of the triangles.
  std::vector<std::uint32_t> triangles() const {
    for (int attempt = 0; attempt < tries; ++attempt) {
      nendo_publish_setup setup;
      std::vector<std::uint32_t> corners(3 * std::size_t{header_.triangles});
      if (!copy_setup(setup)) continue;
      nendo_publish_copy(corners.data(), base_ + header_.triangles_offset, 4 * corners.size());
      if (!nendo_publish_still_holds(stage(header_.setup_offset), setup.generation)) continue;
      if (std::all_of(corners.begin(), corners.end(),
                      [this](std::uint32_t corner) { return corner < header_.vertices; }))
        return corners;
      raise({Errc::bad_input, "the segment has a triangle without a vertex"});
    }
    raise({Errc::failed, "the segment's setup is not complete"});
  }
  const nendo_publish_header& header() const noexcept { return header_; }

private:
  const std::uint64_t* stage(std::uint64_t offset) const noexcept {
    return reinterpret_cast<const std::uint64_t*>(base_ + offset);
  }
  /// Copies content `number` at this offset. False: it is not there, or no longer.
  template <class Content>
  bool copy(std::uint64_t offset, std::uint64_t number, Content& content) const noexcept {
    if (number == 0 || !nendo_publish_holds(stage(offset), number)) return false;
    nendo_publish_copy(&content, base_ + offset, sizeof content);
    return nendo_publish_still_holds(stage(offset), number) != 0;
  }
  bool copy_behind(std::uint64_t offset, std::size_t skipped, std::uint64_t number,
                   std::vector<float>& floats) const noexcept {
    if (number == 0 || !nendo_publish_holds(stage(offset), number)) return false;
    nendo_publish_copy(floats.data(), base_ + offset + skipped, 4 * floats.size());
    return nendo_publish_still_holds(stage(offset), number) != 0;
  }
  bool copy_setup(nendo_publish_setup& setup) const noexcept {
    nendo_publish_copy(&setup, base_ + header_.setup_offset, sizeof setup);
    return setup.generation != 0 && copy(header_.setup_offset, setup.generation, setup);
  }
  /// Returns what `read` returns for the newest record.
  template <class Content, class Read>
  Content newest_of(Read read) const {
    for (int attempt = 0; attempt < tries; ++attempt)
      if (std::optional<Content> content = read(newest())) return *std::move(content);
    raise({Errc::failed, newest() == 0 ? "the run has not published a record yet"
                                       : "the newest record is not complete"});
  }
  static FrameCopy copy_of(const nendo_publish_record& record, const nendo_publish_states* states);

  UniqueFd file_;
  const char* base_;
  std::uint64_t bytes_;
  nendo_publish_header header_;
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
  const std::string path = "/dev/shm/nendo-" + name;
  check_readable(path);
  UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status = {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0)
    raise({Errc::failed, path + ": " + std::strerror(errno)});
  const Error refused{Errc::bad_input, path + ": is no segment of version 1"};
  const auto bytes = static_cast<std::uint64_t>(status.st_size);
  if (!S_ISREG(status.st_mode) || bytes < sizeof(nendo_publish_header)) raise(refused);
  void* const base = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file.get(), 0);
  if (base == MAP_FAILED) raise({Errc::failed, path + ": " + std::strerror(errno)});
  nendo_publish_header header;
  nendo_publish_copy(&header, base, sizeof header);
  auto segment =
      std::make_unique<Segment>(std::move(file), static_cast<const char*>(base), bytes, header);
  if (!nendo_publish_is_usable(&header, bytes)) raise(refused);
  return segment;
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
