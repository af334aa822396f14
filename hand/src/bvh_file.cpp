#include <nendo/hand/bvh_file.hpp>

#include <cerrno>
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

bool is_finite(const HandPose& pose) {
  bool finite = true;
  for (const auto& joint : pose.joints)
    finite = finite && joint.matrix().allFinite();
  return finite;
}

} // namespace

BvhFile::BvhFile(fs::path target, fs::path part, int fd, BvhFormat format)
    : target_(std::move(target)), part_(std::move(part)), fd_(fd), format_(std::move(format)) {}

BvhFile::BvhFile(BvhFile&& other) noexcept
    : target_(std::move(other.target_)), part_(std::move(other.part_)),
      fd_(std::exchange(other.fd_, -1)), format_(other.format_),
      pending_(std::move(other.pending_)), pending_frames_(other.pending_frames_),
      frames_(other.frames_), size_(other.size_), count_at_(other.count_at_) {}

BvhFile::~BvhFile() {
  if (fd_ < 0) return;
  ::close(fd_);
  if (frames_ == 0) ::unlink(part_.c_str());
}

Result<BvhFile> BvhFile::create(const fs::path& path, const HandSkeleton& skeleton,
                                double rate_hz) {
  if (!(rate_hz > 0.0 && rate_hz <= 1e6)) {
    return Error{Errc::usage, path.string() + ": use a rate above 0 and up to 1000000 frames a "
                                              "second"};
  }
  if (!is_finite(skeleton.pose({}, Eigen::Isometry3d::Identity()))) {
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
  const int fd = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0 && errno == EEXIST) {
    return failed(part.string() + " is there, a recording that was cut short or still runs; " +
                  "rename or remove it first");
  }
  if (fd < 0) return failed("cannot be written: " + why(errno) + "; choose another place");
  BvhFile file(target, std::move(part), fd, BvhFormat(skeleton));
  if (const auto begun = file.begin(rate_hz); !begun) return begun.error();
  return file;
}

Result<void> BvhFile::begin(double rate_hz) {
  const std::string hierarchy = format_.hierarchy();
  const std::string head = hierarchy + BvhFormat::motion_head(0, rate_hz);
  if (!write_all(fd_, head, 0)) return failure(errno);
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
  if (!write_all(fd_, pending_, size_)) {
    const int error_number = errno;
    // Some readers go by the lines and not by the count. If this fails, the count still holds.
    [[maybe_unused]] const int cut = ::ftruncate(fd_, static_cast<off_t>(size_));
    return failure(error_number);
  }
  size_ += pending_.size();
  frames_ += std::exchange(pending_frames_, 0);
  pending_.clear();
  if (!write_all(fd_, BvhFormat::count_text(frames_), count_at_)) return failure(errno);
  return {};
}

Result<void> BvhFile::finish() {
  if (auto flushed = flush(); !flushed) return flushed;
  if (::fsync(fd_) != 0) return failure(errno);
  if (::close(std::exchange(fd_, -1)) != 0) return failure(errno);
  if (::rename(part_.c_str(), target_.c_str()) != 0) return failure(errno);
  return {};
}

} // namespace nendo::hand
