#include "publish/segment.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <ctime>

#include <unistd.h>

#include <nendo/deform/triangles.hpp>
#include <nendo_publish.h>

namespace nendo::publish {
namespace {

constexpr std::uint64_t max_record_bytes = std::uint64_t{16} << 20;

std::uint64_t triangles_of(const deform::Mesh& mesh) noexcept {
  std::uint64_t triangles = 0;
  deform::for_each_triangle(mesh, [&](const auto&) { ++triangles; });
  return triangles;
}

std::vector<float> floats_of(const deform::BlockShape& shape, const deform::BlockLayout& layout) {
  std::vector<float> floats(3 * layout.vertex_count());
  for (std::size_t at = 0; at < layout.vertex_count(); ++at) {
    const auto& block = shape[at / deform::block_size];
    float* const to = &floats[3 * std::size_t{layout.order()[at]}];
    to[0] = block.x[at % deform::block_size];
    to[1] = block.y[at % deform::block_size];
    to[2] = block.z[at % deform::block_size];
  }
  return floats;
}

template <class T>
void store_all(const std::vector<T>& values, AtomicWord* to) {
  static_assert(sizeof(T) == 4);
  std::vector<std::uint64_t> words((values.size() + 1) / 2);
  if (!values.empty()) std::memcpy(words.data(), values.data(), sizeof(T) * values.size());
  store_words(words, to);
}

std::int64_t now_ns(clockid_t clock) noexcept {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

constexpr std::size_t newest_word = offsetof(nendo_publish_header, newest) / 8;
constexpr std::size_t heartbeat_word = offsetof(nendo_publish_header, heartbeat_ns) / 8;
constexpr std::size_t state_word = offsetof(nendo_publish_header, state) / 8;

// The word that `state` shares with a reserved number.
std::uint64_t state_words(std::uint32_t state) noexcept {
  return std::bit_cast<std::uint64_t>(std::array<std::uint32_t, 2>{state, 0});
}

} // namespace

SegmentPlan plan_segment(const LoopOutline& outline) noexcept {
  const auto whole_lines = [](std::uint64_t bytes) { return (bytes + 63) / 64 * 64; };
  SegmentPlan plan;
  plan.vertices = outline.layout->vertex_count();
  plan.triangles = triangles_of(*outline.model);
  plan.record_stride = whole_lines(8 * max_record_words(outline));
  const auto records_per_second =
      static_cast<std::uint64_t>(std::clamp(outline.rate_hz, 4.0, 1024.0));
  plan.record_slots =
      std::clamp(max_record_bytes / plan.record_stride, std::uint64_t{4}, records_per_second);
  plan.shape_stride = whole_lines(8 * shape_slot_words(plan.vertices));
  plan.shape_slots = 4;
  plan.setup_offset = sizeof(nendo_publish_header);
  plan.triangles_offset = plan.setup_offset + sizeof(nendo_publish_setup);
  plan.rest_offset = whole_lines(plan.triangles_offset + 12 * plan.triangles);
  plan.records_offset = whole_lines(plan.rest_offset + 12 * plan.vertices);
  plan.shapes_offset = plan.records_offset + plan.record_slots * plan.record_stride;
  plan.segment_bytes = plan.shapes_offset + plan.shape_slots * plan.shape_stride;
  return plan;
}

Result<void> SegmentPublisher::begin(const LoopOutline& outline) {
  if (!memory_ || plan_segment(outline) != plan_) {
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
  nendo_publish_header header{};
  std::memcpy(header.magic, NENDO_PUBLISH_MAGIC, sizeof header.magic);
  header.byte_order = NENDO_PUBLISH_BYTE_ORDER;
  header.major = NENDO_PUBLISH_MAJOR;
  header.minor = NENDO_PUBLISH_MINOR;
  header.segment_bytes = plan_.segment_bytes;
  header.writer_pid = static_cast<std::uint32_t>(::getpid());
  header.vertices = static_cast<std::uint32_t>(plan_.vertices);
  header.triangles = static_cast<std::uint32_t>(plan_.triangles);
  header.record_slots = static_cast<std::uint32_t>(plan_.record_slots);
  header.shape_slots = static_cast<std::uint32_t>(plan_.shape_slots);
  header.setup_offset = plan_.setup_offset;
  header.triangles_offset = plan_.triangles_offset;
  header.rest_offset = plan_.rest_offset;
  header.records_offset = plan_.records_offset;
  header.record_stride = plan_.record_stride;
  header.shapes_offset = plan_.shapes_offset;
  header.shape_stride = plan_.shape_stride;
  header.created_monotonic_ns = now_ns(CLOCK_MONOTONIC);
  header.created_realtime_ns = now_ns(CLOCK_REALTIME);
  std::array<std::uint64_t, sizeof header / 8> words{};
  std::memcpy(words.data(), &header, sizeof header);
  store_words(words, memory_->words());
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
  std::array<std::uint64_t, sizeof setup / 8> words{};
  std::memcpy(words.data(), &setup, sizeof setup);
  AtomicWord* const all = memory_->words();
  AtomicWord* const place = all + plan_.setup_offset / 8;
  auto& stage = *reinterpret_cast<SeqLock<>*>(place);
  stage.open(generation_);
  store_words(std::span(words).subspan(1), place + 1);
  store_all(deform::corners_of_triangles(*outline.model), all + plan_.triangles_offset / 8);
  store_all(floats_of(layout.pack(), layout), all + plan_.rest_offset / 8);
  stage.close(generation_);
}

void SegmentPublisher::show(const flow::Frame& frame) noexcept {
  ++number_;
  shapes_.write(number_, frame.shape);
  record_.describe(frame, number_, shapes_.changes());
  records_.write(number_, record_.words());
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
