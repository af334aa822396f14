#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/hand/joints.hpp>

#include "support/bvh_reader.hpp"
#include "support/program.hpp"

namespace poses_command_test {

using nendo::hand::Joint;
using nendo::test::BvhRecording;
using nendo::test::contents;
using nendo::test::EmulatedGlove;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::Program;
using nendo::test::TemporaryFolder;
using nlohmann::ordered_json;

namespace {

using Arguments = std::vector<std::string>;

Eigen::Vector3d place(const ordered_json& pose, const std::string& joint) {
  const auto& p = pose["joints"][joint]["position_m"];
  return {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
}

double distance(const ordered_json& pose, const std::string& a, const std::string& b) {
  return (place(pose, a) - place(pose, b)).norm();
}

std::vector<ordered_json> poses_of(const Arguments& arguments) {
  const auto done = nendo::test::nendo(arguments);
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  CHECK(done.err.empty());
  std::vector<ordered_json> poses;
  for (const auto& line : lines_of(done.out))
    poses.push_back(ordered_json::parse(line));
  return poses;
}

// What a shell makes of `command`, in which $0 is the program; its own output stays out of the way.
int exit_code_of(const std::string& command, const std::filesystem::path& folder) {
  const std::string line =
      "cd " + folder.string() + " && sh -c '" + command + "' " + NENDO_PROGRAM + " >/dev/null";
  const int status = std::system(line.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool grows_beyond(const std::filesystem::path& path, std::uintmax_t bytes) {
  std::error_code missing;
  for (int turn = 0; turn < 2000; ++turn) {
    const auto size = std::filesystem::file_size(path, missing);
    if (!missing && size > bytes) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

} // namespace

TEST_SUITE("poses") {
  TEST_CASE("each line is a pose of OpenXR's 26 joints, finite, with unit quaternions") {
    const auto poses = poses_of({"poses", "sim:wave?seed=4", "--count", "40"});
    REQUIRE(poses.size() == 40);
    double last_time_s = 0.0;
    for (const auto& pose : poses) {
      CHECK(pose["hand"] == "right");
      CHECK(pose["time_s"].get<double>() > last_time_s);
      last_time_s = pose["time_s"];
      REQUIRE(pose["joints"].size() == nendo::hand::joint_count);
      std::size_t at = 0;
      for (const auto& [name, joint] : pose["joints"].items()) {
        CHECK(name == name_of(static_cast<Joint>(at++)));
        REQUIRE(joint.size() == 2);
        REQUIRE(joint["position_m"].size() == 3);
        REQUIRE(joint["orientation_xyzw"].size() == 4);
        double square = 0.0;
        for (const auto& part : joint["orientation_xyzw"])
          square += part.get<double>() * part.get<double>(); // null would throw
        CHECK(std::abs(square - 1.0) < 1e-12);
        CHECK(joint["orientation_xyzw"][3].get<double>() >= 0.0);
        CHECK(place(pose, name).norm() < 0.25); // a hand's reach
      }
    }
    CHECK(place(poses.front(), "index_tip") != place(poses.back(), "index_tip")); // it waves
  }

  TEST_CASE("the first line of a glove reports which joints it measures, as nendo info does") {
    for (const std::string glove : {"sim?sensors=18", "sim?sensors=22"}) {
      const auto info = ordered_json::parse(nendo::test::nendo({"info", glove, "--json"}).out);
      const auto poses = poses_of({"poses", glove, "--count", "3"});
      CHECK(poses.at(0)["angles"] == info["angles"]);
      CHECK(poses[0]["angles"].size() == 23);
      CHECK_FALSE(poses.at(1).contains("angles"));
      CHECK_FALSE(poses.at(2).contains("angles"));
      // The middle finger's direction is estimated with either glove.
      const auto& deviations = poses[1]["deviations_deg"];
      CHECK(deviations.contains("index_dip_flexion") == (glove == "sim?sensors=18"));
      for (const auto& [name, deviation] : deviations.items()) {
        CHECK(info["angles"][name].get<std::string>().starts_with("from_"));
        CHECK(deviation.get<double>() > 1.0);
      }
    }
  }

  TEST_CASE("two gloves give lines that tell their hand, and a BVH file for each") {
    const auto poses = poses_of({"poses", "sim:wave?hand=left", "sim:pinch", "--count", "60"});
    REQUIRE(poses.size() == 60);
    std::map<std::string, int> lines;
    for (const auto& pose : poses)
      ++lines[pose["hand"].get<std::string>()];
    CHECK(lines["left"] > 10);
    CHECK(lines["right"] > 10);
    const nendo::test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    const auto done = nendo::test::nendo(
        {"poses", "sim:wave?hand=left", "sim", "--bvh", path("both.bvh"), "--duration", "0.5"});
    CHECK(done.exit_code == 0);
    CHECK(done.out.find("poses of a left hand") != std::string::npos);
    CHECK(std::filesystem::exists(path("both-left.bvh")));
    CHECK(std::filesystem::exists(path("both-right.bvh")));
    CHECK_FALSE(std::filesystem::exists(path("both.bvh")));
    CHECK(nendo::test::nendo({"poses", "sim", "sim", "--count", "1"}).exit_code == 2);
    CHECK(nendo::test::nendo({"poses", "sim", "sim?hand=left", "sim", "--count", "1"}).exit_code ==
          2);
  }

  TEST_CASE("--adapt poses the hand by what it learns") {
    const auto poses =
        poses_of({"poses", "sim:wave?seed=4&rate=200", "--adapt", "--count", "1200"});
    const auto plain = poses_of({"poses", "sim:wave?seed=4&rate=200", "--count", "1200"});
    const auto reach = [](const ordered_json& pose) {
      return distance(pose, "wrist", "index_tip");
    };
    const auto least = [&](const std::vector<ordered_json>& of) {
      double reach_m = 1.0;
      for (std::size_t n = 800; n < of.size(); ++n)
        reach_m = std::min(reach_m, reach(of[n]));
      return reach_m;
    };
    // A wave bends the fingers by less than their usual range, so that it comes to look larger.
    CHECK(least(poses) < least(plain) - 0.002);
  }

  TEST_CASE("a quaternion turns -Z to where the bone goes") {
    for (const auto& pose : poses_of({"poses", "sim:wave?seed=4&hand=left", "--count", "20"})) {
      for (const std::string finger : {"index", "ring"}) {
        const auto& q = pose["joints"][finger + "_proximal"]["orientation_xyzw"];
        const double x = q[0], y = q[1], z = q[2], w = q[3];
        // The third column of the quaternion's matrix, written out.
        const Eigen::Vector3d backward(2 * (x * z + w * y), 2 * (y * z - w * x),
                                       1 - 2 * (x * x + y * y));
        const Eigen::Vector3d bone =
            (place(pose, finger + "_intermediate") - place(pose, finger + "_proximal"));
        CHECK((bone.normalized() + backward).norm() < 1e-9);
      }
    }
  }

  TEST_CASE("a left glove gives a left hand, with the thumb on the other side") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    const EmulatedGlove glove(link, "left", "18");
    const auto poses =
        poses_of({"poses", "serial:" + link.string(), "--count", "3", "--calibration", "none"});
    REQUIRE(poses.size() == 3);
    CHECK(poses[0]["hand"] == "left");
    CHECK(place(poses[0], "thumb_metacarpal").x() > 0.01);
    const auto right = poses_of({"poses", "sim", "--count", "1"});
    CHECK(place(right.at(0), "thumb_metacarpal").x() < -0.01);
  }

  TEST_CASE("--hand-length scales the whole hand") {
    const auto small = poses_of({"poses", "sim", "--count", "1", "--hand-length", "100"}).at(0);
    const auto large = poses_of({"poses", "sim", "--count", "1", "--hand-length", "250"}).at(0);
    // Buchholz et al. 1992: the index finger's proximal phalanx is 0.245 of the hand's length.
    CHECK(distance(small, "index_proximal", "index_intermediate") == doctest::Approx(0.0245));
    for (const std::string joint : {"little_proximal", "thumb_metacarpal", "palm"}) {
      CHECK(distance(large, "wrist", joint) ==
            doctest::Approx(2.5 * distance(small, "wrist", joint)));
    }
  }

  TEST_CASE("--rate keeps to a grid, faster and slower than the glove") {
    for (const double rate_hz : {40.0, 700.0}) {
      const auto poses = poses_of(
          {"poses", "sim:wave?rate=100", "--rate", std::to_string(rate_hz), "--count", "60"});
      REQUIRE(poses.size() == 60);
      std::set<double> places;
      for (std::size_t k = 0; k < poses.size(); ++k) {
        const double since_s = poses[k]["time_s"].get<double>() - poses[0]["time_s"].get<double>();
        CHECK(std::abs(since_s - static_cast<double>(k) / rate_hz) < 1e-6);
        places.insert(place(poses[k], "middle_tip").y());
      }
      CHECK(places.size() > 5);
    }
  }

  TEST_CASE("--duration ends after that time of samples") {
    const auto done = nendo::test::nendo({"poses", "sim?rate=100", "--duration", "0.5"});
    REQUIRE(done.exit_code == 0);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() >= 30);
    CHECK(lines.size() <= 51);
    CHECK(ordered_json::parse(lines.back())["time_s"].get<double>() -
              ordered_json::parse(lines.front())["time_s"].get<double>() <
          0.5);
    CHECK(done.seconds < 5.0);
  }

  TEST_CASE("a BVH file has duration times rate frames and the bones of the hand") {
    for (const std::string hand : {"left", "right"}) {
      const TemporaryFolder folder;
      const auto path = folder.path() / "take.bvh";
      const auto done =
          nendo::test::nendo({"poses", "sim:wave?hand=" + hand, "--bvh", path.string(),
                              "--duration", "0.7", "--hand-length", "200"});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      CHECK(lines_of(done.out).size() == 1);
      CHECK(done.out.find("63 poses of a " + hand + " hand") != std::string::npos);
      const BvhRecording recording(contents(path));
      CHECK(recording.frames.size() == 63); // 0.7 s at 90 Hz
      CHECK(recording.declared_frames == 63);
      CHECK(std::abs(recording.frame_time_s - 1.0 / 90.0) < 1e-12);
      CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
      const std::string suffix = hand == "left" ? "_L" : "_R";
      const auto base = recording.find("index_proximal" + suffix);
      const auto end = recording.find("index_intermediate" + suffix);
      const auto tip = recording.find_end_of("index_distal" + suffix);
      double min_m = 1.0, max_m = 0.0;
      for (std::size_t frame = 0; frame < recording.frames.size(); ++frame) {
        const auto world = recording.world(frame);
        const auto metres = [&](std::size_t node) {
          return Eigen::Vector3d(0.01 * world[node].topRightCorner<3, 1>());
        };
        CHECK((metres(end) - metres(base)).norm() == doctest::Approx(0.245 * 0.2));
        const double reach_m = (metres(tip) - metres(base)).norm();
        min_m = std::min(min_m, reach_m);
        max_m = std::max(max_m, reach_m);
      }
      CHECK(max_m - min_m > 0.005); // it waves
    }
  }

  TEST_CASE("the two ways out tell the same of a hand that rests") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "take.bvh";
    // One sample and its repetitions: the noise of a simulated hand comes from its seed.
    const std::string glove = "sim:rest?seed=9&rate=1";
    const auto pose = poses_of({"poses", glove, "--count", "1"}).at(0);
    REQUIRE(
        nendo::test::nendo({"poses", glove, "--bvh", path.string(), "--count", "1"}).exit_code ==
        0);
    const BvhRecording recording(contents(path));
    REQUIRE(recording.frames.size() == 1);
    const auto world = recording.world(0);
    for (const auto& node : recording.nodes) {
      const auto at = static_cast<std::size_t>(&node - recording.nodes.data());
      std::string joint = node.name;
      if (joint.empty()) {
        joint = recording.nodes[static_cast<std::size_t>(node.parent)].name;
        joint = joint.substr(0, joint.find("_distal")) + "_tip";
      } else {
        joint.resize(joint.size() - 2);
      }
      CAPTURE(joint);
      const Eigen::Vector3d at_m = 0.01 * world[at].topRightCorner<3, 1>();
      CHECK((at_m - place(pose, joint)).norm() < 0.003); // a count or two of noise
    }
  }

  TEST_CASE("Ctrl-C completes the file, and ends lines whole") {
    for (const int signal : {SIGINT, SIGTERM}) {
      const TemporaryFolder folder;
      const auto path = folder.path() / "take.bvh";
      Program program({"poses", "sim:wave", "--bvh", path.string(), "--rate", "200"});
      REQUIRE(grows_beyond(path.string() + ".part", 20'000));
      program.signal(signal);
      const auto done = program.wait();
      CAPTURE(done.err);
      CHECK(done.exit_code == 0);
      const BvhRecording recording(contents(path));
      CHECK(recording.frames.size() > 10);
      CHECK(recording.declared_frames == recording.frames.size());
      CHECK_FALSE(recording.torn);
      CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
    }
    const TemporaryFolder folder;
    CHECK(exit_code_of("\"$0\" poses sim:wave >lines 2>err & "
                       "until [ -s lines ]; do sleep 0.05; done; kill -INT $!; wait $!",
                       folder.path()) == 0);
    CHECK(contents(folder.path() / "err").empty());
    const auto lines = contents(folder.path() / "lines");
    CHECK(lines.ends_with('\n'));
    for (const auto& line : lines_of(lines))
      CHECK(ordered_json::accept(line));
  }

  TEST_CASE("a killed program leaves a file that reads") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "take.bvh";
    Program program({"poses", "sim:wave", "--bvh", path.string()});
    REQUIRE(grows_beyond(path.string() + ".part", 20'000));
    program.signal(SIGKILL);
    CHECK(program.wait().exit_code == 128 + SIGKILL);
    const BvhRecording recording(contents(path.string() + ".part"));
    CHECK(recording.declared_frames > 5);
    // Between the frames and their count nothing is lost but the count.
    CHECK(recording.declared_frames <= recording.frames.size());
    CHECK_FALSE(recording.torn);
    const auto again = nendo::test::nendo({"poses", "sim", "--bvh", path.string(), "--count", "1"});
    CHECK(again.exit_code == 1);
    CHECK(is_one_line_about(again.err, "take.bvh.part"));
  }

  TEST_CASE("a full disk is an error in one line, and a reader that has gone ends it silently") {
    const TemporaryFolder folder;
    const auto err = folder.path() / "err";
    CHECK(exit_code_of("\"$0\" poses sim >/dev/full 2>err", folder.path()) == 1);
    CHECK(is_one_line_about(contents(err), "No space left"));

    CHECK(exit_code_of("{ \"$0\" poses sim 2>err; echo $? >code; } | head -n 1", folder.path()) ==
          0);
    CHECK(contents(folder.path() / "code") == "141\n");
    CHECK(contents(err).empty());

    // A limit of 64 blocks of 512 bytes stands for a disk: a file may not grow beyond it.
    CHECK(exit_code_of("trap \"\" XFSZ; ulimit -f 64; exec \"$0\" poses sim --bvh take.bvh "
                       "--rate 1000 2>err",
                       folder.path()) == 1);
    CHECK(is_one_line_about(contents(err), "take.bvh.part"));
    const BvhRecording recording(contents(folder.path() / "take.bvh.part"));
    CHECK(recording.frames.size() > 1);
    CHECK(recording.declared_frames == recording.frames.size());
    CHECK(contents(err).find("the first " + std::to_string(recording.declared_frames) + " poses") !=
          std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "take.bvh"));
  }

  TEST_CASE("what cannot be done gets one clear line, the right exit code, and leaves no file") {
    const TemporaryFolder folder;
    const auto path = (folder.path() / "take.bvh").string();
    struct Case {
      Arguments arguments;
      int exit_code;
      std::string about;
    };
    for (const Case& c :
         {Case{{"sim", "--rate", "0.5"}, 2, "--rate"}, Case{{"sim", "--rate", "-90"}, 2, "--rate"},
          Case{{"sim", "--rate", "nan"}, 2, "--rate"}, Case{{"sim", "--rate", "1e5"}, 2, "--rate"},
          Case{{"sim", "--rate", "fast"}, 2, "fast"},
          Case{{"sim", "--duration", "-1"}, 2, "--duration"},
          Case{{"sim", "--duration", "inf"}, 2, "--duration"},
          Case{{"sim", "--hand-length", "99"}, 2, "--hand-length"},
          Case{{"sim", "--hand-length", "0.187"}, 2, "millimetres"},
          Case{{"sim", "--hand-length", "nan"}, 2, "--hand-length"},
          Case{{"sim", "--count", "-3"}, 2, "count"}, Case{{"bogus:1"}, 2, "bogus"},
          Case{{"sim:moonwalk"}, 2, "moonwalk"},
          Case{{"serial:/dev/no-such-port"}, 3, "/dev/no-such-port"},
          Case{{"sim", "--bvh", "/no/such/folder/x.bvh"}, 1, "/no/such/folder/x.bvh"},
          Case{{"sim", "--bvh", folder.path().string()}, 1, "regular file"},
          Case{{"sim", "--bvh", "/dev/null"}, 1, "/dev/null"}}) {
      Arguments arguments{"poses"};
      arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
      if (std::find(arguments.begin(), arguments.end(), "--bvh") == arguments.end())
        arguments.insert(arguments.end(), {"--bvh", path});
      const auto done = nendo::test::nendo(arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == c.exit_code);
      CHECK(is_one_line_about(done.err, c.about));
      CHECK(done.out.empty());
      CHECK(done.seconds < 5.0);
      CHECK(std::filesystem::is_empty(folder.path()));
    }
    CHECK(nendo::test::nendo({"poses"}).exit_code == 2);
  }
}

} // namespace poses_command_test
