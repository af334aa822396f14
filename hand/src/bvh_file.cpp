#include <nendo/hand/bvh_file.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <nendo/base/files.hpp>

namespace nendo::hand {
namespace {

namespace fs = std::filesystem;

std::string why(int error_number) {
  return std::generic_category().message(error_number);
}

bool write_all(int fd, std::string_view rest, std::uint64_t at) noexcept {
  while (!rest.empty()) {
    const ssize_t written = ::pwrite(fd, rest.data(), rest.size(), static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    rest.remove_prefix(static_cast<std::size_t>(written));
    at += static_cast<std::uint64_t>(written);
  }
  return true;
}

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

BvhFile::BvhFile(fs::path target, fs::path part, UniqueFd fd, BvhFormat format)
    : target_(std::move(target)), part_(std::move(part)), fd_(std::move(fd)),
      format_(std::move(format)) {}

BvhFile::~BvhFile() {
  if (fd_.is_open() && frames_ == 0) ::unlink(part_.c_str());
}

Result<BvhFile> BvhFile::create(const fs::path& path, const HandSkeleton& skeleton,
                                double rate_hz) {
  if (!(rate_hz > 0.0 && rate_hz <= 1e6)) {
    return Error{Errc::usage, path.string() + ": use a rate above 0 and up to 1000000 frames a "
                                              "second"};
  }
  const HandPose flat = skeleton.pose({}, Eigen::Isometry3d::Identity());
  if (!std::all_of(flat.joints.begin(), flat.joints.end(),
                   [](const auto& joint) { return joint.matrix().allFinite(); })) {
    return Error{Errc::usage, path.string() + ": the hand's size is not finite; use one in metres"};
  }
  const auto failed = [&](const std::string& what) {
    return Error{Errc::failed, path.string() + ": " + what};
  };
  const fs::path target = target_of(path);
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (path.empty() || (fs::exists(status) && !fs::is_regular_file(status)))
    return failed("is not a regular file; name a file to write");
  fs::path part = target;
  part += ".part";
  UniqueFd fd(::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!fd.is_open() && errno == EEXIST) {
    return failed(part.string() + " is there, a recording that was cut short or still runs; " +
                  "rename or remove it first");
  }
  if (!fd.is_open()) return failed("cannot be written: " + why(errno) + "; choose another place");
  BvhFile file(target, std::move(part), std::move(fd), BvhFormat(skeleton));
  if (const auto begun = file.begin(rate_hz); !begun) return begun.error();
  return file;
}

Result<void> BvhFile::begin(double rate_hz) {
  const std::string hierarchy = format_.hierarchy();
  const std::string head = hierarchy + BvhFormat::motion_head(0, rate_hz);
  if (!write_all(fd_.get(), head, 0)) return failure(errno);
  count_at_ = hierarchy.size() + BvhFormat::count_place;
  size_ = head.size();
  return {};
}

Error BvhFile::failure(int error_number) const {
  std::string message = target_.string() + ": cannot be written: " + why(error_number);
  if (frames_ > 0)
    message += "; the first " + std::to_string(frames_) + " poses are in " + part_.string();
  return {Errc::failed, std::move(message)};
}

Result<void> BvhFile::add(const HandPose& pose) {
  if (!format_.append_frame(pose, pending_))
    return Error{Errc::bad_input, target_.string() + ": a pose that is not finite was left out"};
  ++pending_frames_;
  return {};
}

Result<void> BvhFile::flush() {
  if (pending_frames_ == 0) return {};
  if (!write_all(fd_.get(), pending_, size_)) {
    const int error_number = errno;
    // Some readers go by the lines and not by the count. If this fails, the count still holds.
    [[maybe_unused]] const int cut = ::ftruncate(fd_.get(), static_cast<off_t>(size_));
    return failure(error_number);
  }
  size_ += pending_.size();
  frames_ += std::exchange(pending_frames_, 0);
  pending_.clear();
  if (!write_all(fd_.get(), BvhFormat::count_text(frames_), count_at_)) return failure(errno);
  return {};
}

Result<void> BvhFile::finish() {
  if (auto flushed = flush(); !flushed) return flushed;
  if (::fsync(fd_.get()) != 0) return failure(errno);
  if (!fd_.close()) return failure(errno);
  if (::rename(part_.c_str(), target_.c_str()) != 0) return failure(errno);
  return {};
}

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
