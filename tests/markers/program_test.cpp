// nendo-markers as a user runs it, and the OSC inlet that it feeds.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/driver/open_tracker.hpp>

#include "rendered_views.hpp"
#include "support/eventually.hpp"
#include "support/required.hpp"
#include "support/shell.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace markers_program_test {

using namespace nendo;
using namespace nendo::test;

namespace {

Spoken run(const std::string& arguments) {
  return shell(NENDO_MARKERS_PROGRAM " " + arguments);
}

/// A port that was free a moment ago.
std::string free_port() {
  const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  REQUIRE(::bind(socket.get(), any, length) == 0);
  REQUIRE(::getsockname(socket.get(), any, &length) == 0);
  return std::to_string(ntohs(address.sin_port));
}

/// Writes picture number `at` of a sequence, which OpenCV takes for a video.
void write_picture(const std::filesystem::path& folder, const std::string& name, int at,
                   const cv::Mat& picture) {
  const std::string number = (at < 10 ? "0" : "") + std::to_string(at);
  std::ofstream file(folder / (name + number + ".pgm"), std::ios::binary);
  file << "P5\n" << picture.cols << ' ' << picture.rows << "\n255\n";
  file.write(reinterpret_cast<const char*>(picture.data),
             static_cast<std::streamsize>(picture.total()));
  REQUIRE(file.good());
}

} // namespace

TEST_SUITE("markers_program") {
  TEST_CASE("a video of the sheet calibrates, and one of a bracelet becomes poses of a tracker") {
    const TemporaryFolder folder;
    std::mt19937 random(9);
    for (int view = 0; view < 12; ++view) {
      const cv::Mat picture = sheet_view(random);
      for (const int twice : {0, 1}) // held still
        write_picture(folder.path(), "sheet", 2 * view + twice, picture);
    }
    const std::string in = "cd " + folder.path().string() + " && ";
    const auto calibrated = shell(in + NENDO_MARKERS_PROGRAM
                                  " calibrate --camera sheet%02d.pgm --views 10 --out cam.toml");
    REQUIRE_MESSAGE(calibrated.exit_code == 0, calibrated.out);
    CHECK(calibrated.out.find("wrote cam.toml") != std::string::npos);

    constexpr int pictures = 10;
    for (int at = 0; at < pictures; ++at) {
      RenderedView view(true_camera(), random);
      view.draw_bracelet(Side::right, cv::Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1),
                         {-0.1 + 0.01 * at, 0.05, 0.6});
      write_picture(folder.path(), "wrist", at, view.taken());
    }
    const std::string port = free_port();
    const std::array specs{"osc:" + port + "/right"};
    const auto stations = required(driver::open_trackers(specs));
    PoseRing ring(64);
    const std::array rings{&ring};
    require_ok(driver::start_trackers(stations, rings));
    const auto tracked = shell(in +
                               NENDO_MARKERS_PROGRAM
                               " --camera wrist%02d.pgm --calibration cam.toml --to 127.0.0.1:" +
                               port);
    REQUIRE_MESSAGE(tracked.exit_code == 0, tracked.out);
    CHECK(tracked.out.find("left in 0, right in 10") != std::string::npos);
    CHECK(eventually([&] { return ring.size() == pictures; }));
    stations.front().tracker->stop();
    int at = 0;
    ring.drain([&](const PoseSample& sample) {
      CHECK(sample.station == 2);
      CHECK(sample.has_device_time);
      // The stage's x and y are against those of the picture.
      CHECK(std::abs(sample.position_m[0] - (0.1 - 0.01 * at++)) < 0.006);
      CHECK(std::abs(sample.position_m[1] + 0.05) < 0.006);
      CHECK(std::abs(sample.position_m[2] - 0.6) < 0.009);
    });
    CHECK(at == pictures);
    CHECK(stations.front().tracker->stats().bad_records == 0);

    const auto other = shell(
        in +
        NENDO_MARKERS_PROGRAM " track --camera wrist%02d.pgm --side left --to 127.0.0.1:" + port);
    CHECK(other.out.find("left in 0\n") != std::string::npos);
  }

  TEST_CASE("the sheet is printed to a file") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "bracelet.svg";
    const auto printed = run("print --out " + path.string());
    CHECK(printed.exit_code == 0);
    CHECK(printed.out == "wrote " + path.string() + "\n");
    CHECK(contents(path).find("<svg") == 0);
  }

  TEST_CASE("what cannot be done is an error of one line, with a remedy") {
    const TemporaryFolder folder;
    struct Case {
      std::string arguments;
      int exit_code;
      std::string said;
    };
    for (const Case& wrong :
         {Case{"--camera none.avi", 3, "no video"}, Case{"--camera 987", 3, "no such camera"},
          Case{"--to localhost:9000", 2, "numeric address"}, Case{"--to 0", 2, "ADDRESS:PORT"},
          Case{"--side up", 2, "--side"}, Case{"print --out a.png", 2, ".svg"},
          Case{"calibrate --camera none.avi", 3, "no video"}}) {
      CAPTURE(wrong.arguments);
      const auto done = shell("cd " + folder.path().string() + " && " NENDO_MARKERS_PROGRAM " " +
                              wrong.arguments);
      CAPTURE(done.out);
      CHECK(done.exit_code == wrong.exit_code);
      CHECK(done.out.find(wrong.said) != std::string::npos);
      CHECK(std::count(done.out.begin(), done.out.end(), '\n') == 1);
    }
  }
}

} // namespace markers_program_test
