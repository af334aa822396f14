// The timeline of the studio, whose file another thread reads.

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "studio/studio_timeline.hpp"
#include "support/eventually.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "support/timelines.hpp"

namespace studio_timeline_test {

using namespace nendo;
using namespace nendo::studio;
namespace fs = std::filesystem;

namespace {

/// A slow disk.
struct Disk {
  std::atomic<bool> is_fast = false;
  std::mutex mutex;
  std::set<std::string> begun; ///< the files whose reading has begun

  StudioTimeline::Frames read(const std::string& file) {
    {
      const std::scoped_lock lock(mutex);
      begun.insert(file);
    }
    CHECK(test::eventually([&] { return is_fast.load(); }));
    if (file == "bad.nendo") return Error{Errc::bad_input, file};
    const deform::Mesh model = test::sphere(12, 24, 1.0);
    return takes::TimelineFrames::make(test::waved_timeline(model, flow::Mode::type1), model);
  }
  std::set<std::string> files() {
    const std::scoped_lock lock(mutex);
    return begun;
  }
};

} // namespace

TEST_SUITE("studio_timeline") {
  TEST_CASE("files are left without waiting, two are read at once, and then the last") {
    Disk disk;
    StudioTimeline timeline(
        [&](const std::string& file, const std::string&) { return disk.read(file); });
    const auto session = [&] {
      const auto read = timeline.read();
      CHECK(read);
      return read ? *read : nullptr;
    };
    for (const char* const file : {"a.nendo", "b.nendo", "c.nendo", "d.nendo"}) {
      timeline.open(Open{file});
      CHECK(session() == nullptr);
    }
    CHECK(timeline.waiting_words() == "Reading d.nendo");
    CHECK(test::eventually([&] { return disk.files().size() == 2; }));
    CHECK(session() == nullptr);
    CHECK(disk.files() == std::set<std::string>{"a.nendo", "b.nendo"});
    disk.is_fast = true;
    CHECK(test::eventually([&] { return session() != nullptr; }));
    CHECK(disk.files() == std::set<std::string>{"a.nendo", "b.nendo", "d.nendo"});
    CHECK(timeline.file() == "d.nendo");
  }

  TEST_CASE("a file that was sent and left is removed when it turns out that it cannot be read") {
    const test::TemporaryFolder folder;
    const std::string good = (folder.path() / "good.nendo").string();
    const std::string bad = (folder.path() / "bad.nendo").string();
    for (const bool is_closed : {false, true}) {
      std::ofstream(good) << "sent";
      std::ofstream(bad) << "sent";
      Disk disk;
      auto timeline =
          std::make_unique<StudioTimeline>([&](const std::string& file, const std::string&) {
            return disk.read(fs::path(file).filename().string());
          });
      timeline->open(Open{bad, true});
      timeline->open(Open{good, true});
      CHECK(fs::exists(bad));
      disk.is_fast = true;
      if (is_closed) timeline.reset();
      CHECK(test::eventually([&] { return !fs::exists(bad) || (timeline && !timeline->read()); }));
      CHECK_FALSE(fs::exists(bad));
      CHECK(fs::exists(good));
    }
  }
}

} // namespace studio_timeline_test
