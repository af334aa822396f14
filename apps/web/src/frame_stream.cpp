#include <nendo/web/frame_stream.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "wire.hpp"

namespace nendo::web {

/// In front of a record in the ring; what it tells and its step follow.
struct FrameStream::RecordHead {
  std::uint32_t bytes = 0; ///< with this head
  std::uint32_t told_bytes = 0;
  std::uint64_t number = 0;
  double wear = 0.0;
  std::uint8_t undone = 0;
  std::uint8_t bakes = 0;
  std::uint8_t spare[6]{};
};

namespace {

/// As BlockField estimates the error of a field's float sums, and two coordinates' rounding.
constexpr double float_error = 3e-7;
constexpr double rounding_error = 1.2e-7;
/// Of the model's diagonal, of the 1e-5 within which a follower is to stay.
constexpr double most_wear = 2e-6;
/// A second of a 1 kHz loop's ordinary frames, in chunks; and no fewer than this many of the
/// largest.
constexpr std::size_t least_chunks = 16384;
constexpr std::size_t least_records = 16;

} // namespace

FrameStream::FrameStream(const deform::BlockLayout& layout, flow::Mode mode,
                         std::size_t most_fields, std::size_t most_functions)
    : origin_(layout.origin()), unit_(layout.unit()), vertices_(layout.vertex_count()),
      type1_(mode == flow::Mode::type1),
      most_wear_(std::pow(most_wear * layout.diagonal() / layout.unit(), 2)), rest_(layout.pack()),
      record_((sizeof(RecordHead) + sizeof(UpdateHead) + 2 * hand_bytes + step_head_bytes +
               most_fields * field_bytes(most_functions) + sizeof(Chunk) - 1) /
                  sizeof(Chunk) * sizeof(Chunk),
              std::byte{1}),
      ring_(std::max(least_chunks, least_records * (record_.size() / sizeof(Chunk)))),
      given_(rest_) {
  // Its pages are there before the first tick.
  for (std::size_t at = ring_.claim(ring_.capacity()); at > 0; --at)
    ring_.claimed(at - 1) = Chunk{};
}

void FrameStream::show(const flow::Frame& frame) noexcept {
  ++number_;
  const bool undone = frame.undos != undos_;
  const bool committed = frame.commits != commits_;
  undos_ = frame.undos;
  commits_ = frame.commits;
  // In either case the shape of this frame is the one that the hands hold from now on: a commit is
  // made of it, and after an undo they have not moved it yet.
  if (type1_ && (undone || committed)) rest_.follow(frame.shape);
  give_shape(frame); // before the record: see take_shape()
  if (listened_to_.load(std::memory_order_relaxed)) push(frame, undone, committed);
}

void FrameStream::give_shape(const flow::Frame& frame) noexcept {
  if (request_.load(std::memory_order_acquire) != Request::asked) return;
  given_.follow(type1_ ? rest_ : frame.shape);
  given_number_ = number_;
  request_.store(Request::ready, std::memory_order_release);
}

// Errors of many steps are as likely to be of either sign, so that squares add up.
double FrameStream::wear_of(const flow::Frame& frame) const noexcept {
  double wear = 0.0;
  for (const deform::CsrbfField& field : frame.fields.fields()) {
    const double largest = field.coefficients.cwiseAbs().maxCoeff() / unit_;
    const double overlap = std::sqrt(static_cast<double>(field.centres.cols()));
    const double error = float_error * largest * overlap + rounding_error;
    wear += error * error / most_wear_;
  }
  return wear;
}

void FrameStream::push(const flow::Frame& frame, bool undone, bool committed) noexcept {
  const bool bakes = !type1_ || committed;
  RecordHead head;
  UpdateHead update = head_of(frame);
  update.number = head.number = number_;
  WireWriter out(record_);
  out.put(head);
  out.put(update);
  for (const flow::HandFrame& hand : frame.hands)
    if (hand.present) write_hand(hand, out);
  head.told_bytes = static_cast<std::uint32_t>(out.used() - sizeof head);
  write_step(bakes ? StepKind::bake : StepKind::draw, frame.fields, origin_, unit_, out);
  head.bytes = static_cast<std::uint32_t>(out.used());
  head.undone = undone ? 1 : 0;
  head.wear = bakes ? wear_of(frame) : 0.0;
  head.bakes = bakes ? 1 : 0;
  std::memcpy(record_.data(), &head, sizeof head);
  const std::size_t chunks = (out.used() + sizeof(Chunk) - 1) / sizeof(Chunk);
  if (ring_.claim(chunks) < chunks) {
    ring_.refuse(1); // all of it or nothing
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
    Record record;
    record.number = head.number;
    record.broken = head.undone != 0 || head.number != taken_ + 1;
    record.wear = head.wear;
    record.bakes = head.bakes != 0;
    const auto body = std::span(incoming_).subspan(sizeof head, wanted - sizeof head);
    const auto told = body.first(head.told_bytes);
    const auto step = body.subspan(head.told_bytes);
    record.told.assign(told.begin(), told.end());
    record.step.assign(step.begin(), step.end());
    records.push_back(std::move(record));
    taken_ = head.number;
    incoming_.clear();
    wanted = 0;
  });
}

void FrameStream::ask_for_shape() noexcept {
  Request none = Request::none;
  request_.compare_exchange_strong(none, Request::asked, std::memory_order_release,
                                   std::memory_order_relaxed);
}

// A shape that was not ready after the last take() is of a later frame than all that this gave,
// because the tick gives a frame's shape before its record. So no record after it is missed.
std::optional<FrameStream::Shape> FrameStream::take_shape() {
  if (request_.load(std::memory_order_acquire) != Request::ready) return std::nullopt;
  Shape shape{given_number_, std::vector<std::byte>(sizeof(ShapeHead) + 12 * vertices_)};
  ShapeHead head;
  head.vertices = static_cast<std::uint32_t>(vertices_);
  head.number = given_number_;
  WireWriter out(shape.message);
  out.put(head);
  for (std::size_t at = 0; at < vertices_; ++at) {
    const deform::VertexBlock& block = given_[at / deform::block_size];
    const std::size_t lane = at % deform::block_size;
    out.put(block.x[lane]);
    out.put(block.y[lane]);
    out.put(block.z[lane]);
  }
  request_.store(Request::none, std::memory_order_release);
  return shape;
}

} // namespace nendo::web
