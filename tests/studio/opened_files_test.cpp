// Files that a browser sends to the studio.

#include <filesystem>
#include <fstream>

#include <doctest/doctest.h>

#include "studio/opened_files.hpp"
#include "support/temporary_folder.hpp"

namespace opened_files_test {

using namespace nendo;
using namespace nendo::studio;
namespace fs = std::filesystem;

TEST_SUITE("opened_files") {
  TEST_CASE("a file that was sent replaces nothing, and keeps its ending") {
    const test::TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    fs::create_symlink("elsewhere.obj", "link.obj");
    fs::create_symlink("loop.obj", "loop.obj");
    CHECK(*store_sent("scan.obj", "1") == "scan.obj");
    CHECK(*store_sent("scan.obj", "2") == "scan-1.obj");
    CHECK(*store_sent("scan.obj", "3") == "scan-2.obj");
    CHECK(*store_sent("a.timeline.toml", "") == "a.timeline.toml");
    CHECK(*store_sent("a.timeline.toml", "") == "a-1.timeline.toml");
    CHECK(opens_in_timeline("a-1.timeline.toml"));
    CHECK(*store_sent("Scan.OBJ", "") == "Scan.OBJ");
    CHECK(*store_sent("Scan.OBJ", "") == "Scan-1.OBJ");
    CHECK(*store_sent("link.obj", "") == "link-1.obj");
    CHECK(*store_sent("loop.obj", "") == "loop-1.obj");
    const std::string reserved = (folder.path() / "b.timeline.toml").string();
    CHECK(*store_sent("b.timeline.toml", "", reserved) == "b-1.timeline.toml");
    CHECK(*store_sent("b.timeline.toml", "", "b-2.timeline.toml") == "b.timeline.toml");
    CHECK(*store_sent("b.timeline.toml", "", "b-2.timeline.toml") == "b-3.timeline.toml");
    CHECK(fs::is_symlink("link.obj"));
    for (const auto* wrong : {"program.sh", "obj", "a.toml", "a.obj.sh"}) {
      CAPTURE(wrong);
      CHECK_FALSE(check_openable(wrong));
      CHECK_FALSE(store_sent(wrong, ""));
      CHECK_FALSE(fs::exists(wrong));
    }
    fs::current_path(before);
  }
}

} // namespace opened_files_test
