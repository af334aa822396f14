#include <nendo/hand/bvh_file.hpp>

#include <csignal>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/bvh_reader.hpp"
#include "support/random_poses.hpp"
#include "support/temporary_folder.hpp"

namespace bvh_file_test {

using namespace nendo;
using namespace nendo::hand;
using nendo::test::BvhRecording;
using nendo::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

std::string contents(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

HandPose some_pose() {
  static std::mt19937 random(5);
  return HandSkeleton(Side::right).pose(test::random_angles(random), test::random_place(random));
}

void add(BvhFile& file, int poses) {
  for (int n = 0; n < poses; ++n)
    REQUIRE(file.add(some_pose()));
}

// A file may grow to that size and no further, as on a full disk.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : before_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, before_signal_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
  rlimit before_{};
  void (*before_signal_)(int);
};

} // namespace

TEST_SUITE("bvh file") {
  TEST_CASE("at any time the file says how many frames it has, and gets its name at the end") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "take.bvh";
    const fs::path part = folder.path() / "take.bvh.part";
    auto file = BvhFile::create(path, HandSkeleton(Side::right), 120.0);
    REQUIRE(file);
    std::size_t sure = 0;
    for (const int poses : {0, 1, 8, 1, 90, 900}) { // the count's digits grow
      add(*file, poses);
      CHECK(BvhRecording(contents(part)).frames.size() == sure);
      REQUIRE(file->flush());
      sure += static_cast<std::size_t>(poses);
      const BvhRecording recording(contents(part));
      CHECK(recording.frames.size() == sure);
      CHECK(recording.declared_frames == sure);
      CHECK_FALSE(recording.torn);
      CHECK(file->frames() == sure);
    }
    add(*file, 3);
    CHECK_FALSE(fs::exists(path));
    REQUIRE(file->finish());
    CHECK_FALSE(fs::exists(part));
    const BvhRecording recording(contents(path));
    CHECK(recording.declared_frames == sure + 3);
    CHECK(recording.frames.size() == sure + 3);
    CHECK(std::abs(recording.frame_time_s - 1.0 / 120.0) < 1e-12);
  }

  TEST_CASE("a killed program leaves what it flushed, and the file of that name as it was") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "take.bvh";
    std::ofstream(path) << "an earlier take";
    const pid_t child = ::fork();
    if (child == 0) {
      auto file = BvhFile::create(path, HandSkeleton(Side::right), 90.0);
      for (int n = 0; n < 7; ++n)
        if (!file->add(some_pose())) ::_exit(1);
      if (!file->flush()) ::_exit(2);
      if (!file->add(some_pose())) ::_exit(3);
      ::raise(SIGKILL);
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));
    CHECK(contents(path) == "an earlier take");
    const BvhRecording recording(contents(folder.path() / "take.bvh.part"));
    CHECK(recording.declared_frames == 7);
    CHECK(recording.frames.size() == 7);

    // Nor does the next recording write over it.
    const auto next = BvhFile::create(path, HandSkeleton(Side::right), 90.0);
    REQUIRE_FALSE(next);
    CHECK(next.error().code == Errc::failed);
    CHECK(next.error().message.find("take.bvh.part") != std::string::npos);
    CHECK(BvhRecording(contents(folder.path() / "take.bvh.part")).frames.size() == 7);
    REQUIRE(fs::remove(folder.path() / "take.bvh.part"));
    auto again = BvhFile::create(path, HandSkeleton(Side::right), 90.0);
    REQUIRE(again);
    add(*again, 2);
    REQUIRE(again->finish());
    CHECK(BvhRecording(contents(path)).frames.size() == 2);
  }

  TEST_CASE("on a full disk the frames before it stay, whole, and the error says where") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "take.bvh";
    const fs::path part = folder.path() / "take.bvh.part";
    std::optional<Error> error;
    std::uint64_t flushed = 0;
    {
      const FileSizeLimit limit(50'000);
      auto file = BvhFile::create(path, HandSkeleton(Side::right), 90.0);
      REQUIRE(file);
      for (int round = 0; round < 1000 && !error; ++round) {
        add(*file, 3);
        if (const auto done = file->flush(); !done) error = done.error();
      }
      flushed = file->frames();
    }
    REQUIRE(error);
    CHECK(error->code == Errc::failed);
    CHECK(error->message.find("take.bvh.part") != std::string::npos);
    CHECK(error->message.find(std::to_string(flushed) + " poses") != std::string::npos);
    CHECK(flushed > 10);
    CHECK_FALSE(fs::exists(path));
    const BvhRecording recording(contents(part));
    CHECK(recording.declared_frames == flushed);
    CHECK(recording.frames.size() == flushed);
    CHECK_FALSE(recording.torn);
  }

  TEST_CASE("a recording without a frame leaves no file behind, unless it was finished") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "take.bvh";
    {
      REQUIRE(BvhFile::create(path, HandSkeleton(Side::left), 90.0));
    }
    CHECK(fs::is_empty(folder.path()));
    auto file = BvhFile::create(path, HandSkeleton(Side::left), 90.0);
    REQUIRE(file);
    REQUIRE(file->finish());
    CHECK(BvhRecording(contents(path)).declared_frames == 0);
  }

  TEST_CASE("what cannot be written is an error that names it, and nothing is made") {
    const TemporaryFolder folder;
    const HandSkeleton skeleton(Side::right);
    for (const fs::path& path : {fs::path("/no/such/folder/take.bvh"), folder.path(), fs::path(),
                                 fs::path("/dev/null"), fs::path("/dev/full")}) {
      const auto file = BvhFile::create(path, skeleton, 90.0);
      CAPTURE(path);
      REQUIRE_FALSE(file);
      CHECK(file.error().code == Errc::failed);
      CHECK(file.error().message.find(path.string()) != std::string::npos);
      CHECK_FALSE(fs::exists(path.string() + ".part"));
    }
    const fs::path path = folder.path() / "take.bvh";
    for (const double rate_hz : {0.0, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity()}) {
      const auto file = BvhFile::create(path, skeleton, rate_hz);
      REQUIRE_FALSE(file);
      CHECK(file.error().code == Errc::usage);
    }
    const HandSkeleton absurd(Side::right, {std::numeric_limits<double>::infinity(), 0.08});
    CHECK_FALSE(BvhFile::create(path, absurd, 90.0));
    CHECK(fs::is_empty(folder.path()));
  }

  TEST_CASE("a pose that is not finite is left out, and the others stay") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "take.bvh";
    auto file = BvhFile::create(path, HandSkeleton(Side::right), 90.0);
    REQUIRE(file);
    add(*file, 1);
    HandPose bad = some_pose();
    bad.joints[index_of(Joint::thumb_distal)].linear()(0, 0) =
        std::numeric_limits<double>::quiet_NaN();
    const auto refused = file->add(bad);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::bad_input);
    add(*file, 1);
    REQUIRE(file->finish());
    CHECK(BvhRecording(contents(path)).frames.size() == 2);
  }

  TEST_CASE("a symbolic link leads to the file that is replaced") {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "real.bvh") << "old";
    fs::create_symlink(folder.path() / "real.bvh", folder.path() / "link.bvh");
    auto file = BvhFile::create(folder.path() / "link.bvh", HandSkeleton(Side::right), 90.0);
    REQUIRE(file);
    add(*file, 1);
    REQUIRE(file->finish());
    CHECK(fs::is_symlink(folder.path() / "link.bvh"));
    CHECK(BvhRecording(contents(folder.path() / "real.bvh")).frames.size() == 1);
  }
}

} // namespace bvh_file_test
