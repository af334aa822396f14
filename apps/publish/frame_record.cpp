#include "publish/frame_record.hpp"

#include <cstring>

#include <nendo/hand/angle_sources.hpp>

namespace nendo::publish {
namespace {

constexpr std::size_t head_words = sizeof(nendo_publish_record) / 8;
constexpr std::size_t field_words = sizeof(nendo_publish_field) / 8;
constexpr std::size_t function_words = sizeof(nendo_publish_function) / 8;

std::int64_t nanoseconds(HostClock::duration time) noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
}

void describe_pose(const Eigen::Isometry3d& pose, nendo_publish_joint& out) noexcept {
  const Eigen::Vector3f place = pose.translation().cast<float>();
  const Eigen::Quaternionf turn = Eigen::Quaterniond(pose.linear()).normalized().cast<float>();
  std::memcpy(out.position, place.data(), sizeof out.position);
  std::memcpy(out.orientation, turn.coeffs().data(), sizeof out.orientation);
}

void describe_hand(const flow::HandFrame& hand, nendo_publish_hand& out) noexcept {
  out = {};
  if (!hand.present) return;
  out.flags = NENDO_PUBLISH_PRESENT;
  if (hand.silent) out.flags |= NENDO_PUBLISH_SILENT;
  out.samples = hand.samples;
  for (std::size_t at = 0; at < hand::joint_count; ++at)
    describe_pose(hand.pose.joints[at], out.joints[at]);
}

void describe_state(const flow::HandFrame& hand, nendo_publish_hand_state& out) noexcept {
  if (hand.wrist_switch != WristSwitch::unknown) out.flags |= NENDO_PUBLISH_HAS_SWITCH;
  if (hand.wrist_switch == WristSwitch::on) out.flags |= NENDO_PUBLISH_SWITCH_ON;
  if (hand.tracked) out.flags |= NENDO_PUBLISH_TRACKED;
  if (hand.lost) out.flags |= NENDO_PUBLISH_LOST;
  out.measured = hand::measured_bits(hand::angle_sources(hand.sensors, hand.left_out));
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    out.angles[at] = hand.angles[hand::angle_at(at)];
  out.sampled_ns = nanoseconds(hand.sampled.time_since_epoch());
  out.tracked_ns = nanoseconds(hand.tracked_at.time_since_epoch());
  describe_pose(hand.T_stage_wrist, out.forearm);
}

// The numbers in a record are those of the enumerations, which must not change.
template <class Choice>
constexpr std::uint32_t published_number(Choice choice) noexcept {
  return static_cast<std::uint32_t>(choice);
}
static_assert(published_number(deform::FieldStatus::ok) == 0 &&
              published_number(deform::FieldStatus::merged) == 1 &&
              published_number(deform::FieldStatus::singular) == 2 &&
              published_number(deform::FieldStatus::too_dense) == 3 &&
              published_number(deform::FieldStatus::not_finite) == 4);
static_assert(published_number(deform::Wendland::c0) == 0 &&
              published_number(deform::Wendland::c2) == 1 &&
              published_number(deform::Wendland::c4) == 2 &&
              published_number(deform::Wendland::c6) == 3);

} // namespace

static_assert(std::size_t{NENDO_PUBLISH_JOINTS} == hand::joint_count);
static_assert(std::size_t{NENDO_PUBLISH_ANGLES} == hand::angle_count);

nendo_publish_states states_of(const flow::Frame& frame, std::uint64_t number) noexcept {
  nendo_publish_states states{};
  states.number = number;
  states.model = frame.model;
  std::size_t body = 0; // contacts count the present hands
  for (std::size_t side = 0; side < 2; ++side) {
    if (!frame.hands[side].present) continue;
    describe_state(frame.hands[side], states.hands[side]);
    const flow::HandTouch touch = flow::touch_of(frame.contacts.all(), body++);
    static_assert(sizeof touch == sizeof states.hands[side].touch);
    std::memcpy(states.hands[side].touch, touch.data(), sizeof touch);
  }
  return states;
}

std::size_t max_record_words(const LoopOutline& outline) noexcept {
  return head_words + outline.max_fields * (field_words + outline.functions * function_words);
}

FrameRecord::FrameRecord(const LoopOutline& outline, std::uint64_t generation)
    : words_(max_record_words(outline)), generation_(generation) {}

std::size_t FrameRecord::put_field(const deform::CsrbfField& field, std::size_t at) noexcept {
  const auto functions = static_cast<std::size_t>(field.centres.cols());
  const std::size_t end = at + field_words + functions * function_words;
  if (end > words_.size()) return 0;
  nendo_publish_field head{};
  const bool keeps_volume = field.keep_volume > 0.0;
  head.kernel = published_number(field.kernel);
  if (keeps_volume) head.kernel |= std::uint32_t{NENDO_PUBLISH_KEEPS_VOLUME};
  if (field.is_halfway) head.kernel |= std::uint32_t{NENDO_PUBLISH_HALFWAY};
  head.functions = static_cast<std::uint32_t>(functions);
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = field.polynomial;
  std::memcpy(head.polynomial, rows.data(), sizeof head.polynomial);
  if (keeps_volume) head.polynomial[0] = field.keep_volume;
  std::memcpy(&words_[at], &head, sizeof head);
  at += field_words;
  for (Eigen::Index n = 0; n < field.centres.cols(); ++n, at += function_words) {
    nendo_publish_function function{};
    std::memcpy(function.centre, field.centres.col(n).data(), sizeof function.centre);
    function.radius = field.radii[n];
    std::memcpy(function.coefficient, field.coefficients.col(n).data(),
                sizeof function.coefficient);
    std::memcpy(&words_[at], &function, sizeof function);
  }
  return end;
}

nendo_publish_record head_of(const flow::Frame& frame) noexcept {
  nendo_publish_record head{};
  head.tick = frame.tick;
  head.ticks = frame.ticks_run;
  head.missed = frame.missed;
  head.rest_changes = frame.rest_changes;
  head.shape_jumps = frame.shape_jumps;
  head.scheduled_ns = nanoseconds(frame.scheduled.time_since_epoch());
  head.woke_ns = nanoseconds(frame.woke.time_since_epoch());
  head.since_last_ns = nanoseconds(frame.since_last);
  head.units_per_metre = frame.units_per_metre;
  if (frame.held) head.flags |= NENDO_PUBLISH_HELD;
  head.status = published_number(frame.status);
  head.mode = static_cast<std::uint8_t>(1 + static_cast<int>(frame.settings.mode));
  for (std::size_t side = 0; side < 2; ++side)
    describe_hand(frame.hands[side], head.hands[side]);
  return head;
}

void FrameRecord::describe(const flow::Frame& frame, std::uint64_t number,
                           std::uint64_t shape_changes) noexcept {
  nendo_publish_record head = head_of(frame);
  head.number = number;
  head.generation = generation_;
  head.shape_changes = shape_changes;
  used_ = head_words;
  for (const auto& field : frame.fields.fields()) {
    const std::size_t end = put_field(field, used_);
    if (end == 0) { // a part of them would lead to another shape
      head.flags |= NENDO_PUBLISH_FIELDS_LEFT_OUT;
      head.fields = 0;
      used_ = head_words;
      break;
    }
    used_ = end;
    ++head.fields;
  }
  head.fields_bytes = 8 * (used_ - head_words);
  std::memcpy(words_.data(), &head, sizeof head);
}

} // namespace nendo::publish
