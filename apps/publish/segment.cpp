#include "publish/segment.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/base/shared_name.hpp>
#include <nendo/base/system_error.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/hand/hand_body.hpp>

#include "publish/target.hpp"

namespace nendo::publish {

namespace {

constexpr const char* another_name = "choose another name: shm:NAME";

struct flock whole_file(short type) noexcept {
  struct flock lock{};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

// A lock for writing can be had only by who may write, which no reader may: none of them can make
// a dead writer look alive.
bool has_writer(int file) noexcept {
  struct flock lock = whole_file(F_RDLCK);
  return ::fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool is_segment(int file) noexcept {
  std::array<char, 8> magic{};
  return ::pread(file, magic.data(), magic.size(), 0) == static_cast<ssize_t>(magic.size()) &&
         std::memcmp(magic.data(), NENDO_PUBLISH_MAGIC, magic.size()) == 0;
}

// No link is followed, and a pipe is not waited for.
UniqueFd look_at(const std::string& path) noexcept {
  return UniqueFd(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
}

Error taken(const std::string& path) {
  return {Errc::failed,
          path + ": another run publishes there; end it or " + std::string(another_name)};
}

// Takes the right to give `path` to another file: two runs that both find a dead one's there must
// not both remove it, for the second would remove the first's. A lock on that file would not do,
// because readers may hold locks for reading on it. Errors: as SharedMemory::announce().
Result<void> take_name(NameLock& lock, const std::string& path) {
  switch (lock.take()) {
  case NameLock::Outcome::taken:
    return {};
  case NameLock::Outcome::held:
    return taken(path);
  case NameLock::Outcome::failed:
    break;
  }
  return system_error(lock.path(), "cannot be made", another_name);
}

// Removes a dead run's segment; anything else stays.
Result<void> remove_stale(const std::string& path) {
  const UniqueFd old = look_at(path);
  if (!old.is_open()) {
    if (errno == ENOENT) return {};
    return system_error(path, "cannot be looked at", another_name);
  }
  struct stat status{};
  if (::fstat(old.get(), &status) != 0 || status.st_uid != ::geteuid())
    return Error{Errc::no_permission, path + ": belongs to another user; " + another_name};
  if (has_writer(old.get())) return taken(path);
  if (!is_segment(old.get()))
    return Error{Errc::failed, path + ": is not Nendo's; remove it or " + another_name};
  if (::unlink(path.c_str()) != 0 && errno != ENOENT)
    return system_error(path, "cannot be removed", another_name);
  return {};
}

} // namespace

Result<SharedMemory> SharedMemory::create(const std::string& name, std::size_t bytes,
                                          const std::optional<unsigned>& group) {
  const std::string path = "/dev/shm/nendo-" + name;
  UniqueFd file(::open("/dev/shm", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (!file.is_open())
    return system_error(path, "cannot be made", "is /dev/shm there, and may you write to it?");
  SharedMemory made(path, std::move(file), bytes);
  if (const auto laid = made.lay_out(group); !laid) return laid.error();
  return made;
}

Result<void> SharedMemory::lay_out(const std::optional<unsigned>& group) {
  struct flock lock = whole_file(F_WRLCK);
  if (::fcntl(file_.get(), F_OFD_SETLK, &lock) != 0)
    return system_error(path_, "cannot be locked", another_name);
  // Otherwise a full /dev/shm would be found out by the first tick that writes there, by a signal.
  if (const int error = ::posix_fallocate(file_.get(), 0, static_cast<off_t>(bytes_)); error != 0) {
    errno = error;
    return system_error(path_, "has no space for " + std::to_string((bytes_ >> 20U) + 1) + " MiB",
                        "mount -o remount,size=... /dev/shm, or a smaller model");
  }
  memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0);
  if (memory_ == MAP_FAILED) {
    memory_ = nullptr;
    return system_error(path_, "cannot be mapped", "a smaller model");
  }
  locked_ = ::mlock(memory_, bytes_) == 0;
  std::memset(memory_, 0, bytes_); // each page is touched before the first tick
  if (group && ::fchown(file_.get(), static_cast<uid_t>(-1), static_cast<gid_t>(*group)) != 0)
    return system_error(path_, "cannot be given to the group", "be a member of it (usermod -aG)");
  if (::fchmod(file_.get(), group ? 0440 : 0400) != 0)
    return system_error(path_, "cannot be made readable", another_name);
  return {};
}

Result<void> SharedMemory::announce() {
  NameLock lock("/dev/shm/." + path_.substr(path_.rfind('/') + 1) + ".lock");
  if (const auto locked = take_name(lock, path_); !locked) return locked.error();
  if (const auto removed = remove_stale(path_); !removed) return removed.error();
  const std::string here = "/proc/self/fd/" + std::to_string(file_.get());
  named_ = ::linkat(AT_FDCWD, here.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW) == 0;
  if (!named_) return system_error(path_, "cannot be made", another_name);
  return {};
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : path_(std::move(other.path_)), file_(std::move(other.file_)),
      memory_(std::exchange(other.memory_, nullptr)), bytes_(other.bytes_), locked_(other.locked_),
      named_(std::exchange(other.named_, false)) {}

SharedMemory::~SharedMemory() {
  if (memory_ != nullptr) ::munmap(memory_, bytes_);
  if (!named_) return;
  const UniqueFd there = look_at(path_);
  if (there.is_open() && is_same_file(there.get(), file_.get())) ::unlink(path_.c_str());
}

namespace {

constexpr std::size_t shape_head_words = sizeof(nendo_publish_shape) / 8;

} // namespace

std::size_t shape_slot_words(std::size_t vertices) noexcept {
  return shape_head_words + (3 * vertices + 1) / 2;
}

ShapeRing::ShapeRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words,
                     std::size_t vertices)
    : memory_(memory), slot_words_(slot_words), vertices_(vertices),
      stamps_(slots, Stamps(deform::block_count_of(vertices), 0)) {
  assert(slots > 1 && slot_words >= shape_slot_words(vertices));
}

// Vertices are three floats, and two vertices share a word: they are stored as floats.
void ShapeRing::write_block(const deform::BlockShape& shape, std::size_t block,
                            AtomicWord* slot) noexcept {
  using AtomicFloat = std::atomic<std::uint32_t>;
  static_assert(AtomicFloat::is_always_lock_free && sizeof(AtomicFloat) == sizeof(float));
  auto* const floats = reinterpret_cast<AtomicFloat*>(slot + shape_head_words);
  const deform::VertexBlock& from = shape[block];
  const std::size_t first = block * deform::block_size;
  const std::size_t count = std::min(deform::block_size, vertices_ - first);
  const std::uint32_t* const order = layout_->order().data() + first;
  for (std::size_t at = 0; at < count; ++at) {
    AtomicFloat* const to = floats + 3 * std::size_t{order[at]};
    to[0].store(std::bit_cast<std::uint32_t>(from.x[at]), std::memory_order_relaxed);
    to[1].store(std::bit_cast<std::uint32_t>(from.y[at]), std::memory_order_relaxed);
    to[2].store(std::bit_cast<std::uint32_t>(from.z[at]), std::memory_order_relaxed);
  }
}

void ShapeRing::write(std::uint64_t number, const deform::BlockShape& shape) noexcept {
  Stamps& here = stamps_[number % stamps_.size()];
  const Stamps& before = stamps_[(number - 1) % stamps_.size()];
  assert(layout_ != nullptr && shape.block_count() == here.size());
  AtomicWord* const slot = memory_ + number % stamps_.size() * slot_words_;
  auto& stage = *reinterpret_cast<SeqLock<>*>(slot);
  stage.open(number);
  bool changed = false;
  for (std::size_t block = 0; block < here.size(); ++block) {
    const std::uint64_t stamp = shape.stamp(block);
    changed = changed || stamp != before[block];
    if (stamp == here[block]) continue;
    write_block(shape, block, slot);
    here[block] = stamp;
  }
  if (changed) ++changes_;
  slot[1].store(number, std::memory_order_relaxed);
  slot[2].store(changes_, std::memory_order_relaxed);
  stage.close(number);
}

namespace {

constexpr std::uint64_t max_record_bytes = std::uint64_t{16} << 20;

std::uint64_t triangles_of(const deform::Mesh& mesh) noexcept {
  std::uint64_t triangles = 0;
  deform::for_each_triangle(mesh, [&](const auto&) { ++triangles; });
  return triangles;
}

std::vector<float> floats_of(const deform::BlockShape& shape, const deform::BlockLayout& layout) {
  std::vector<float> floats(3 * layout.vertex_count());
  for (std::size_t at = 0; at < layout.vertex_count(); ++at)
    Eigen::Vector3f::Map(&floats[3 * std::size_t{layout.order()[at]}]) =
        deform::vertex_at(shape, at);
  return floats;
}

template <class T>
void store_all(const std::vector<T>& values, AtomicWord* to) {
  static_assert(sizeof(T) == 4);
  std::vector<std::uint64_t> words((values.size() + 1) / 2);
  if (!values.empty()) std::memcpy(words.data(), values.data(), sizeof(T) * values.size());
  store_words(words, to);
}

template <class T>
std::array<std::uint64_t, sizeof(T) / 8> words_of(const T& value) noexcept {
  return std::bit_cast<std::array<std::uint64_t, sizeof(T) / 8>>(value);
}

std::int64_t now_ns(clockid_t clock) noexcept {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

constexpr std::size_t newest_word = offsetof(nendo_publish_header, newest) / 8;
constexpr std::size_t heartbeat_word = offsetof(nendo_publish_header, heartbeat_ns) / 8;
constexpr std::size_t state_word = offsetof(nendo_publish_header, state) / 8;

using PublishedRadii = std::array<std::array<float, hand::joint_count>, 2>; ///< metres

PublishedRadii radii_of(const LoopOutline& outline) {
  PublishedRadii radii{};
  for (std::size_t side = 0; side < 2; ++side) {
    if (!outline.skeletons[side]) continue;
    const hand::JointRadii radii_m = hand::joint_radii_m(*outline.skeletons[side]);
    std::transform(radii_m.begin(), radii_m.end(), radii[side].begin(),
                   [](double radius_m) { return static_cast<float>(radius_m); });
  }
  return radii;
}

// The radii of joints follow the setup. Its stage also guards them.
constexpr std::size_t radii_offset = sizeof(nendo_publish_header) + sizeof(nendo_publish_setup);

// The word that `state` shares with a reserved number.
std::uint64_t state_words(std::uint32_t state) noexcept {
  return std::bit_cast<std::uint64_t>(std::array<std::uint32_t, 2>{state, 0});
}

} // namespace

nendo_publish_header plan_segment(const LoopOutline& outline) noexcept {
  const auto whole_lines = [](std::uint64_t bytes) { return (bytes + 63) / 64 * 64; };
  const std::uint64_t vertices = outline.layout->vertex_count();
  const std::uint64_t triangles = triangles_of(*outline.model);
  nendo_publish_header plan{};
  std::memcpy(plan.magic, NENDO_PUBLISH_MAGIC, sizeof plan.magic);
  plan.byte_order = NENDO_PUBLISH_BYTE_ORDER;
  plan.major = NENDO_PUBLISH_MAJOR;
  plan.minor = NENDO_PUBLISH_MINOR;
  plan.vertices = static_cast<std::uint32_t>(vertices);
  plan.triangles = static_cast<std::uint32_t>(triangles);
  plan.record_stride = whole_lines(8 * max_record_words(outline));
  const auto records_per_second =
      static_cast<std::uint64_t>(std::clamp(outline.rate_hz, 4.0, 1024.0));
  plan.record_slots = static_cast<std::uint32_t>(
      std::clamp(max_record_bytes / plan.record_stride, std::uint64_t{4}, records_per_second));
  plan.shape_stride = whole_lines(8 * shape_slot_words(vertices));
  plan.shape_slots = 4;
  plan.setup_offset = sizeof(nendo_publish_header);
  plan.triangles_offset = whole_lines(radii_offset + sizeof(PublishedRadii));
  plan.rest_offset = whole_lines(plan.triangles_offset + 12 * triangles);
  plan.records_offset = whole_lines(plan.rest_offset + 12 * vertices);
  plan.shapes_offset = plan.records_offset + plan.record_slots * plan.record_stride;
  plan.states_stride = whole_lines(sizeof(nendo_publish_states));
  plan.states_offset = plan.shapes_offset + plan.shape_slots * plan.shape_stride;
  plan.segment_bytes = plan.states_offset + std::uint64_t{plan.record_slots} * plan.states_stride;
  return plan;
}

Result<void> SegmentPublisher::begin(const LoopOutline& outline) {
  const nendo_publish_header plan = plan_segment(outline);
  if (!memory_ || std::memcmp(&plan, &plan_, sizeof plan) != 0) {
    if (auto laid = lay_out(outline); !laid) return laid;
    return announce();
  }
  describe(outline);
  return {};
}

Result<void> SegmentPublisher::lay_out(const LoopOutline& outline) {
  end();
  plan_ = plan_segment(outline);
  auto memory = SharedMemory::create(name_, plan_.segment_bytes, group_);
  if (!memory) return memory.error();
  memory_.emplace(*std::move(memory));
  number_ = 0;
  records_ = RecordRing(memory_->words() + plan_.records_offset / 8, plan_.record_slots,
                        plan_.record_stride / 8);
  states_ = RecordRing(memory_->words() + plan_.states_offset / 8, plan_.record_slots,
                       plan_.states_stride / 8);
  shapes_ = ShapeRing(memory_->words() + plan_.shapes_offset / 8, plan_.shape_slots,
                      plan_.shape_stride / 8, plan_.vertices);
  counts_.bytes = plan_.segment_bytes;
  counts_.is_locked = memory_->is_locked();
  write_header();
  describe(outline);
  memory_->words()[state_word].store(state_words(NENDO_PUBLISH_LIVE), std::memory_order_release);
  return {};
}

Result<void> SegmentPublisher::announce() {
  auto announced = memory_->announce();
  if (!announced) memory_.reset();
  return announced;
}

/// What the records from now on are of.
void SegmentPublisher::describe(const LoopOutline& outline) {
  record_ = FrameRecord(outline, ++generation_);
  shapes_.begin(*outline.layout);
  write_setup(outline);
}

void SegmentPublisher::write_header() noexcept {
  nendo_publish_header header = plan_;
  header.writer_pid = static_cast<std::uint32_t>(::getpid());
  header.created_monotonic_ns = now_ns(CLOCK_MONOTONIC);
  header.created_realtime_ns = now_ns(CLOCK_REALTIME);
  store_words(words_of(header), memory_->words());
}

void SegmentPublisher::write_setup(const LoopOutline& outline) {
  nendo_publish_setup setup{};
  setup.generation = generation_;
  const auto& layout = *outline.layout;
  std::memcpy(setup.origin, layout.origin().data(), sizeof setup.origin);
  setup.unit = layout.unit();
  setup.rate_hz = outline.rate_hz;
  setup.units_per_metre = outline.units_per_metre;
  std::memcpy(setup.offset, outline.model->offset.data(), sizeof setup.offset);
  setup.mode = static_cast<std::uint32_t>(1 + static_cast<int>(outline.mode));
  setup.radii_offset = radii_offset;
  const auto words = words_of(setup);
  AtomicWord* const all = memory_->words();
  AtomicWord* const place = all + plan_.setup_offset / 8;
  auto& stage = *reinterpret_cast<SeqLock<>*>(place);
  stage.open(generation_);
  store_words(std::span(words).subspan(1), place + 1);
  store_words(words_of(radii_of(outline)), all + radii_offset / 8);
  store_all(deform::corners_of_triangles(*outline.model), all + plan_.triangles_offset / 8);
  store_all(floats_of(layout.pack(), layout), all + plan_.rest_offset / 8);
  stage.close(generation_);
}

void SegmentPublisher::show(const flow::Frame& frame) noexcept {
  ++number_;
  shapes_.write(number_, frame.shape);
  record_.describe(frame, number_, shapes_.changes());
  records_.write(number_, record_.words());
  const auto states = words_of(states_of(frame, number_));
  states_.write(number_, std::span(states).subspan(1));
  AtomicWord* const header = memory_->words();
  header[heartbeat_word].store(
      static_cast<std::uint64_t>(std::chrono::nanoseconds(frame.woke.time_since_epoch()).count()),
      std::memory_order_relaxed);
  header[newest_word].store(number_, std::memory_order_relaxed); // the record's stage has the order
  ++counts_.records;
}

SegmentCounts SegmentPublisher::counts() const noexcept {
  SegmentCounts counts = counts_;
  counts.shape_changes += shapes_.changes();
  return counts;
}

void SegmentPublisher::end() noexcept {
  if (!memory_) return;
  counts_.shape_changes += shapes_.changes();
  shapes_ = {};
  memory_->words()[state_word].store(state_words(NENDO_PUBLISH_ENDED), std::memory_order_release);
  memory_.reset();
}

} // namespace nendo::publish
