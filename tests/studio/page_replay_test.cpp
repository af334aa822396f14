// A recording or a timeline on the page of the studio.

#include <thread>

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

  TEST_CASE("a replay that is left does not wait for its file, which is read no further") {
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
}

} // namespace page_replay_test
