// A recording or a timeline on the page of the studio.

#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "studio/page_replay.hpp"
#include "support/eventually.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "support/timelines.hpp"

namespace page_replay_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

/// A page without a browser.
struct Page {
  test::TemporaryFolder folder;
  std::unique_ptr<web::Server> server;
  web::PageForm form;
  LeftReadings left;

  Page() {
    auto opened = web::Server::open({"127.0.0.1", 0});
    REQUIRE(opened);
    server = *std::move(opened);
    server->present_nothing(); // as the studio does
  }
  std::string timeline() const {
    const auto mesh = folder.path() / "ball.ply";
    REQUIRE(deform::write_mesh(mesh, test::sphere(12, 24, 1.0)));
    const auto model = deform::read_mesh(mesh);
    REQUIRE(model);
    timeline::Timeline waved = test::waved_timeline(*model, flow::Mode::type1);
    waved.mesh = mesh.string();
    const auto file = folder.path() / "wave.timeline.toml";
    REQUIRE(timeline::write_timeline(file, waved));
    return file.string();
  }
  /// Returns the error with which the replay of the timeline ends; empty: it plays.
  std::string error_of(PageReplay& replay) {
    std::string error;
    CHECK(test::eventually([&] {
      form.begin({});
      const auto wish = replay.update(form);
      if (!wish) error = wish.error().message;
      return !wish || form.message().find("The play head.") != std::string::npos;
    }));
    return error;
  }
};

} // namespace

TEST_SUITE("page_replay") {
  TEST_CASE("a model with more vertices than browsers take is refused, as by --web") {
    Page page;
    const std::string timeline = page.timeline();
    const std::size_t vertices = 12 * 24 + 2;
    PageReplay small(*page.server, page.left, timeline);
    CHECK(page.error_of(small).empty());
    PageReplay large(*page.server, page.left, timeline, 100);
    CHECK(page.error_of(large) == "--web: the model has " + std::to_string(vertices) +
                                      " vertices, and a browser takes at most 100; run it without "
                                      "--web, or reduce the model");
  }

  TEST_CASE("a replay that is left does not wait for its file") {
    Page page;
    const auto slow = page.folder.path() / "take.nendo";
    REQUIRE(::mkfifo(slow.c_str(), 0600) == 0);
    std::jthread writer([&] { // without which its reader waits
      std::this_thread::sleep_for(std::chrono::seconds(2));
      ::close(::open(slow.c_str(), O_WRONLY | O_CLOEXEC));
    });
    const HostTime begun = HostClock::now();
    {
      PageReplay replay(*page.server, page.left, slow.string());
      page.form.begin({});
      CHECK(replay.update(page.form));
    }
    CHECK(HostClock::now() - begun < std::chrono::seconds(1));
  }

  TEST_CASE("of many files whose replays are left, two are read at once") {
    Page page;
    std::vector<std::string> files;
    for (int number = 0; number < 5; ++number) {
      files.push_back(page.folder.path() / ("take" + std::to_string(number) + ".nendo"));
      REQUIRE(::mkfifo(files.back().c_str(), 0600) == 0);
      PageReplay replay(*page.server, page.left, files.back());
      page.form.begin({});
      CHECK(replay.update(page.form));
    }
    std::set<std::string> read;
    const auto look = [&] { // and end the reading
      for (const std::string& file : files) {
        const int writer = ::open(file.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        if (writer < 0) continue; // no thread reads it
        ::close(writer);
        read.insert(file);
      }
      return read.size();
    };
    CHECK(test::eventually([&] { return look() == 2; }));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    CHECK(look() == 2);
  }
}

} // namespace page_replay_test
