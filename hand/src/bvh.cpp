#include <nendo/hand/bvh.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace nendo::hand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int decimals = 6; // 10 nm, and at a fingertip less than that of an angle
constexpr int time_decimals = 12;

// Not printf, whose decimal point is a matter of the host program's locale.
void append_number(double value, std::string& text, int places = decimals) {
  char digits[400]; // the largest double has 309 before the point
  if (std::abs(value) < 0.5 * std::pow(10.0, -places)) value = 0.0; // no "-0.000000"
  const auto end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, places).ptr;
  text.append(digits, end);
}

void append_vector(const Vector3d& vector, std::string& text) {
  for (const double value : vector) {
    text += ' ';
    append_number(value, text);
  }
}

// The angles of R = Ry(y) Rz(z) Rx(x). x is what is left once y is undone, so that the three
// give R again at z = 90 degrees, where y and x turn about one axis.
Vector3d turns_yzx(const Matrix3d& r) {
  const double y = std::atan2(-r(2, 0), r(0, 0));
  const double z = std::atan2(r(1, 0), std::hypot(r(0, 0), r(2, 0)));
  const double sin_y = std::sin(y);
  const double cos_y = std::cos(y);
  const double x = std::atan2(sin_y * r(0, 1) + cos_y * r(2, 1), sin_y * r(0, 2) + cos_y * r(2, 2));
  return {y, z, x};
}

constexpr bool is_tip(Joint joint) {
  return std::find(fingertips.begin(), fingertips.end(), joint) != fingertips.end();
}

constexpr bool has_channels(Joint joint) {
  return joint != Joint::palm && !is_tip(joint);
}

template <class Do>
void for_each_joint(Do&& act) {
  for (std::size_t at = 0; at < joint_count; ++at)
    act(static_cast<Joint>(at));
}

} // namespace

BvhFormat::BvhFormat(const HandSkeleton& skeleton)
    : side_(skeleton.side()), rest_(skeleton.pose({}, Eigen::Isometry3d::Identity())) {}

void BvhFormat::append_joint(Joint joint, int depth, std::string& text) const {
  const std::string tabs(static_cast<std::size_t>(depth), '\t');
  const auto parent = parent_of(joint);
  const char* const kind = !parent ? "ROOT " : is_tip(joint) ? "End Site" : "JOINT ";
  text += tabs + kind;
  if (!is_tip(joint)) text.append(name_of(joint)).append(side_ == Side::left ? "_L" : "_R");
  text += "\n" + tabs + "{\n" + tabs + "\tOFFSET";
  const Vector3d offset = parent
                              ? Vector3d(rest_[joint].translation() - rest_[*parent].translation())
                              : Vector3d::Zero();
  append_vector(units_per_metre * offset, text);
  text += '\n';
  if (!is_tip(joint)) {
    text += tabs + "\tCHANNELS ";
    text += parent ? "3" : "6 Xposition Yposition Zposition";
    text += " Yrotation Zrotation Xrotation\n";
  }
  for_each_joint([&](Joint child) {
    if (child != Joint::palm && parent_of(child) == joint) append_joint(child, depth + 1, text);
  });
  text += tabs + "}\n";
}

std::string BvhFormat::hierarchy() const {
  std::string text = "HIERARCHY\n";
  append_joint(Joint::wrist, 0, text);
  return text;
}

std::string BvhFormat::count_text(std::uint64_t frames) {
  // Blanks behind it: a leading zero would be octal to some readers, and others take what
  // follows one blank.
  std::string text = std::to_string(frames);
  text.resize(std::max(text.size(), count_width), ' ');
  return text;
}

std::string BvhFormat::motion_head(std::uint64_t frames, double rate_hz) {
  std::string text = "MOTION\nFrames: " + count_text(frames) + "\nFrame Time: ";
  append_number(1.0 / rate_hz, text, time_decimals);
  return text + "\n";
}

bool BvhFormat::append_frame(const HandPose& pose, std::string& text) const {
  const std::size_t before = text.size();
  bool finite = true;
  const auto append = [&](const Vector3d& vector) {
    finite = finite && vector.allFinite();
    if (finite) append_vector(vector, text);
  };
  const auto turned = [&](Joint joint) { // since the flat hand
    return Matrix3d(pose[joint].linear() * rest_[joint].linear().transpose());
  };
  append(units_per_metre * pose[Joint::wrist].translation());
  for_each_joint([&](Joint joint) {
    if (!has_channels(joint)) return;
    const auto parent = parent_of(joint);
    const Matrix3d rotation =
        parent ? Matrix3d(turned(*parent).transpose() * turned(joint)) : turned(joint);
    append(turns_yzx(rotation).unaryExpr(&to_degrees));
  });
  if (!finite) {
    text.resize(before);
    return false;
  }
  text.erase(before, 1); // the blank before the first number
  text += '\n';
  return true;
}

} // namespace nendo::hand
