#include "export/shape_files.hpp"

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/recorded_motion.hpp"

namespace mesh_sequence_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::Motion;
using nendo::test::RecordedMotion;

TEST_SUITE("mesh_sequence") {
  TEST_CASE("a number has one place in a name, as printf has it") {
    struct Row {
      const char* pattern;
      const char* name; ///< name of number 7; null: refused
    };
    for (const Row& row : std::initializer_list<Row>{{"a-%04d.obj", "a-0007.obj"},
                                                     {"%d.ply", "7.ply"},
                                                     {"50%%-%02d.obj", "50%-07.obj"},
                                                     {"a.obj", nullptr},
                                                     {"%d-%d.obj", nullptr},
                                                     {"%s.obj", nullptr},
                                                     {"%4d.obj", nullptr},
                                                     {"%00d.obj", nullptr},
                                                     {"%012d.obj", nullptr},
                                                     {"%", nullptr},
                                                     {"%0", nullptr},
                                                     {"a%%.obj", nullptr},
                                                     {"%n%d.obj", nullptr},
                                                     {"%-4d.obj", nullptr}}) {
      CAPTURE(row.pattern);
      const auto name = NumberedName::parse(row.pattern);
      CHECK(static_cast<bool>(name) == (row.name != nullptr));
      if (name && row.name != nullptr) CHECK(name->of(7) == row.name);
      if (!name) CHECK(name.error().message.find("as in take-%04d") != std::string::npos);
    }
    CHECK(NumberedName::parse("%02d")->of(12345) == "12345");
  }

  TEST_CASE("each frame is a whole mesh with the model's faces, exactly") {
    const RecordedMotion motion(Motion{.ticks = 12});
    for (const std::string ending : {".obj", ".ply"}) {
      const auto source = motion.frames();
      auto frames = ChosenFrames::make(*source, {.rate_hz = 50.0});
      REQUIRE(frames);
      const auto done = export_mesh_sequence(*frames, motion.path("f-%03d" + ending).string());
      REQUIRE(done);
      REQUIRE(done->files.size() == 6);
      std::uintmax_t bytes = 0;
      for (std::size_t at = 0; at < 6; ++at) {
        const auto path = motion.path("f-00" + std::to_string(at + 1) + ending);
        CHECK(done->files[at] == path.string());
        const auto mesh = deform::read_mesh(path);
        REQUIRE(mesh);
        CHECK(mesh->vertices == motion.shapes[2 * at]);
        CHECK(mesh->face_corners == motion.played.test.model.face_corners);
        bytes += std::filesystem::file_size(path);
      }
      CHECK(done->bytes == bytes);
    }
  }

  TEST_CASE("a frame that cannot be written ends it, and what is whole is reported") {
    const RecordedMotion motion(Motion{.ticks = 4});
    std::filesystem::create_directory(motion.path("f-3.obj"));
    const auto source = motion.frames();
    auto frames = ChosenFrames::make(*source, {.rate_hz = 100.0});
    const auto done = export_mesh_sequence(*frames, motion.path("f-%d.obj").string());
    REQUIRE_FALSE(done);
    CHECK(done.error().code == Errc::failed);
    CHECK(done.error().message.find("2 frames before it are whole") != std::string::npos);
  }
}

} // namespace mesh_sequence_test
