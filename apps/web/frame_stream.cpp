#include "web/frame_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "web/wire.hpp"

namespace nendo::web {

/// Precedes each record in the ring. The update's head and hands follow, then its step.
struct FrameStream::RecordHead {
  std::uint32_t bytes = 0; ///< with this head
  std::uint32_t head_bytes = 0;
  RecordFacts facts{};
};

namespace {

/// Of a field's largest coefficient: the error of float sums, as BlockField estimates it; and the
/// rounding of two coordinates.
constexpr double float_error = 3e-7;
constexpr double rounding_error = 1.2e-7;
/// Of the model's diagonal. A client is to stay within 1e-5 of it.
constexpr double max_drift = 2e-6;
/// The ring holds a second of a 1 kHz loop's ordinary frames, and at least min_records of the
/// largest ones.
constexpr std::size_t min_chunks = 16384;
constexpr std::size_t min_records = 16;

bool is_type1(const flow::Frame& frame) noexcept {
  return frame.settings.mode == flow::Mode::type1;
}

} // namespace

FrameStream::FrameStream(const deform::BlockLayout& layout, const flow::FrameCapacity& capacity)
    : origin_(layout.origin()), unit_(layout.unit()), vertices_(layout.vertex_count()),
      max_drift_(std::pow(max_drift * layout.diagonal() / layout.unit(), 2)), rest_(layout.pack()),
      record_((sizeof(RecordHead) + sizeof(UpdateHead) + 2 * hand_bytes + step_head_bytes +
               std::max(capacity.fields * field_bytes(capacity.functions),
                        vectors_bytes(capacity.vectors)) +
               sizeof(Chunk) - 1) /
                  sizeof(Chunk) * sizeof(Chunk),
              std::byte{1}),
      ring_(std::max(min_chunks, min_records * (record_.size() / sizeof(Chunk)))), base_(rest_),
      drawn_(rest_) {
  // Touches all pages of the ring, so that no tick waits for one.
  for (std::size_t at = ring_.claim(ring_.capacity()); at > 0; --at)
    ring_.claimed(at - 1) = Chunk{};
}

void FrameStream::show(const flow::Frame& frame) noexcept {
  ++number_;
  // Clients can follow along the surface.
  const std::uint64_t jumps = frame.shape_jumps - frame.surface_moves;
  const bool jumped = jumps != jumps_;
  const bool committed = frame.rest_changes != rest_changes_;
  jumps_ = jumps;
  rest_changes_ = frame.rest_changes;
  // In both cases this frame's shape is the rest shape from now on: a commit makes it so, as does a
  // change of settings, and after an undo the hands have not moved it yet.
  if (jumped || committed) rest_.follow(frame.shape);
  // Before the record is pushed: see take_shape().
  copy_if_asked(base_, is_type1(frame) ? rest_ : frame.shape, frame);
  copy_if_asked(drawn_, frame.shape, frame);
  if (hands_active_.load(std::memory_order_relaxed)) {
    hands_.back() = {ros::FrameHands(frame), frame.woke};
    hands_.publish();
  }
  if (active_.load(std::memory_order_relaxed)) push(frame, jumped, committed);
}

void FrameStream::copy_if_asked(ShapeCopy& copy, const deform::BlockShape& shape,
                                const flow::Frame& frame) noexcept {
  if (copy.request.load(std::memory_order_acquire) != ShapeRequest::pending) return;
  copy.shape.follow(shape);
  copy.number = number_;
  copy.woke = frame.woke;
  copy.request.store(ShapeRequest::ready, std::memory_order_release);
}

// Errors of many steps have either sign, so their squares add up.
double FrameStream::drift_of(const flow::Frame& frame) const noexcept {
  const auto drift_by = [this](double largest, double terms) {
    const double error = float_error * largest * std::sqrt(terms) + rounding_error;
    return error * error / max_drift_;
  };
  const deform::SurfaceMove& surface = frame.surface;
  if (surface.field != 0)
    return drift_by(
        static_cast<double>(surface.vectors.leftCols(surface.count).cwiseAbs().maxCoeff()),
        surface.count);
  double drift = 0.0;
  for (const deform::CsrbfField& field : frame.fields.fields())
    drift += drift_by(field.coefficients.cwiseAbs().maxCoeff() / unit_,
                      static_cast<double>(field.centres.cols()));
  return drift;
}

void FrameStream::push(const flow::Frame& frame, bool jumped, bool committed) noexcept {
  const bool bakes = !is_type1(frame) || committed;
  RecordHead head;
  head.facts = {number_, jumped, bakes, bakes ? drift_of(frame) : 0.0, frame.surface.field};
  UpdateHead update = head_of(frame);
  update.number = number_;
  WireWriter out(record_);
  out.put(head);
  out.put(update);
  for (const flow::HandFrame& hand : frame.hands)
    if (hand.present) write_hand(hand, out);
  head.head_bytes = static_cast<std::uint32_t>(out.used() - sizeof head);
  write_step(bakes ? StepKind::bake : StepKind::draw, frame, origin_, unit_, out);
  head.bytes = static_cast<std::uint32_t>(out.used());
  std::memcpy(record_.data(), &head, sizeof head);
  const std::size_t chunks = (out.used() + sizeof(Chunk) - 1) / sizeof(Chunk);
  if (ring_.claim(chunks) < chunks) {
    ring_.refuse(1); // a part of a record would be of no use
    return;
  }
  for (std::size_t at = 0; at < chunks; ++at)
    std::memcpy(ring_.claimed(at).bytes.data(), record_.data() + at * sizeof(Chunk), sizeof(Chunk));
  ring_.commit(chunks);
}

void FrameStream::take(std::vector<Record>& records) {
  incoming_.clear();
  std::size_t wanted = 0; // of incoming_, for the record that is being put together
  RecordHead head;
  ring_.drain([&](const Chunk& chunk) noexcept {
    incoming_.insert(incoming_.end(), chunk.bytes.begin(), chunk.bytes.end());
    if (wanted == 0) {
      std::memcpy(&head, incoming_.data(), sizeof head);
      wanted = head.bytes;
    }
    if (incoming_.size() < wanted) return;
    Record record{head.facts, {}, {}};
    record.discontinuous = record.discontinuous || record.number != taken_ + 1;
    const auto body = std::span(incoming_).subspan(sizeof head, wanted - sizeof head);
    const auto record_head = body.first(head.head_bytes);
    const auto step = body.subspan(head.head_bytes);
    record.head.assign(record_head.begin(), record_head.end());
    record.step.assign(step.begin(), step.end());
    records.push_back(std::move(record));
    taken_ = head.facts.number;
    incoming_.clear();
    wanted = 0;
  });
}

void FrameStream::request(ShapeCopy& copy) noexcept {
  ShapeRequest none = ShapeRequest::none;
  copy.request.compare_exchange_strong(none, ShapeRequest::pending, std::memory_order_release,
                                       std::memory_order_relaxed);
}

void FrameStream::request_shape() noexcept {
  request(base_);
}

void FrameStream::request_drawn() noexcept {
  request(drawn_);
}

std::optional<HostTime> FrameStream::take_drawn(std::vector<float>& xyz) {
  if (drawn_.request.load(std::memory_order_acquire) != ShapeRequest::ready) return std::nullopt;
  xyz.resize(3 * vertices_);
  for (std::size_t at = 0; at < vertices_; ++at) {
    const auto vertex = deform::vertex_at(drawn_.shape, at);
    std::copy(vertex.begin(), vertex.end(), &xyz[3 * at]);
  }
  const HostTime woke = drawn_.woke;
  drawn_.request.store(ShapeRequest::none, std::memory_order_release);
  return woke;
}

// The tick copies a frame's shape before it pushes that frame's record. So a shape that becomes
// ready after take() is of a later frame than all records that take() returned, and no record
// after it is missed.
std::optional<FrameStream::Shape> FrameStream::take_shape() {
  if (base_.request.load(std::memory_order_acquire) != ShapeRequest::ready) return std::nullopt;
  Shape shape{base_.number, std::vector<std::byte>(sizeof(ShapeHead) + 12 * vertices_)};
  ShapeHead head;
  head.vertices = static_cast<std::uint32_t>(vertices_);
  head.number = base_.number;
  WireWriter out(shape.message);
  out.put(head);
  for (std::size_t at = 0; at < vertices_; ++at)
    out.put(deform::vertex_at(base_.shape, at));
  base_.request.store(ShapeRequest::none, std::memory_order_release);
  return shape;
}

namespace {

bool has_fields(const Record& record) noexcept {
  std::uint16_t count = 0;
  std::memcpy(&count, record.step.data() + 2, sizeof count);
  return count > 0;
}

float max_late(std::span<const Record> records) noexcept {
  float most = 0.0F;
  for (const Record& record : records) {
    UpdateHead head;
    std::memcpy(&head, record.head.data(), sizeof head);
    most = std::max(most, head.late_us);
  }
  return most;
}

} // namespace

void Feed::look_at(std::span<const Record> records) noexcept {
  if (!records.empty()) needed_ = records.back().weights;
}

void Feed::shape_sent(std::uint64_t number) noexcept {
  lacks_shape_ = false;
  base_ = shape_ = number;
  drift_ = 0.0;
}

// Records up to the base are known to the client. The record of the shape's own frame is needed
// only if its step is drawn: what it baked is in the shape.
std::span<const Record> Feed::unseen(std::span<const Record> records) noexcept {
  std::size_t first = 0;
  const auto is_needed = [&](const Record& record) {
    return record.number > base_ || (record.number == shape_ && base_ == shape_ && !record.bakes);
  };
  while (first < records.size() && !is_needed(records[first]))
    ++first;
  return records.subspan(first);
}

bool Feed::can_follow(std::span<const Record> records) const noexcept {
  return !lacks_shape_ && std::none_of(records.begin(), records.end(), [&](const Record& record) {
    return (record.discontinuous && record.number > shape_) ||
           (record.weights != 0 && record.weights != weights_);
  });
}

std::optional<std::vector<std::byte>> Feed::update(std::span<const Record> records,
                                                   std::uint64_t lost) {
  if (records.empty()) return std::nullopt;
  const auto news = unseen(records);
  lacks_shape_ = !can_follow(news);
  const Record& newest = records.back();
  UpdateHead head;
  std::memcpy(&head, newest.head.data(), sizeof head);
  head.max_late_us = max_late(records);
  head.lost = static_cast<std::uint32_t>(lost);
  head.skipped = static_cast<std::uint32_t>(skipped_);
  std::vector<std::byte> message = newest.head;
  for (std::size_t at = 0; !lacks_shape_ && at < news.size(); ++at) {
    const Record& record = news[at];
    if (!record.bakes && at + 1 < news.size()) continue; // the next step replaces it
    message.insert(message.end(), record.step.begin(), record.step.end());
    ++head.steps;
    drift_ += record.drift;
  }
  if (!lacks_shape_) base_ = std::max(base_, newest.number);
  std::memcpy(message.data(), &head, sizeof head);
  return message;
}

void Feed::skip(std::span<const Record> records) noexcept {
  skipped_ += records.size();
  const auto news = unseen(records);
  const bool bakes = std::any_of(news.begin(), news.end(), [](const Record& record) {
    return record.bakes && has_fields(record);
  });
  if (bakes || !can_follow(news)) lacks_shape_ = true;
  if (!lacks_shape_ && !records.empty()) base_ = std::max(base_, records.back().number);
}

} // namespace nendo::web
