#pragma once
// A page of the studio without a browser, and timelines for it.

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/eventually.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "support/timelines.hpp"
#include "web/page_form.hpp"
#include "web/server.hpp"

namespace nendo::test {

struct StudioPage {
  TemporaryFolder folder; ///< also the current folder, where files go that browsers send
  std::filesystem::path before = std::filesystem::current_path();
  std::unique_ptr<web::Server> server;
  web::PageForm form;

  StudioPage() {
    ::setenv("XDG_STATE_HOME", folder.path().c_str(), 1); // for recent files
    std::filesystem::current_path(folder.path());
    auto opened = web::Server::open({"127.0.0.1", 0});
    REQUIRE(opened);
    server = *std::move(opened);
    server->present_nothing(); // as the studio does
  }
  ~StudioPage() {
    std::filesystem::current_path(before);
    ::unsetenv("XDG_STATE_HOME");
  }
  StudioPage(const StudioPage&) = delete;
  StudioPage& operator=(const StudioPage&) = delete;

  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  /// Writes a timeline of both hands with its model.
  std::string timeline_file(const std::string& name = "wave.timeline.toml") const {
    REQUIRE(deform::write_mesh(path("ball.ply"), sphere(12, 24, 1.0)));
    const auto model = deform::read_mesh(path("ball.ply"));
    REQUIRE(model);
    timeline::Timeline waved = waved_timeline(*model, flow::Mode::type1);
    waved.mesh = path("ball.ply");
    REQUIRE(timeline::write_timeline(path(name), waved));
    return path(name);
  }
};

} // namespace nendo::test
