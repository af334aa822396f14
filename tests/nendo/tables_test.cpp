// Tables as people have them, through the commands that read them.

#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace tables_test {

using nendo::test::contents;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::write_file;
using nlohmann::json;

namespace {

struct Folder {
  nendo::test::TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    write_file(folder.path() / name, text);
    return path(name);
  }
};

/// The samples that `nendo monitor` shows of a table.
std::vector<json> samples_of(const std::string& table) {
  const auto done = nendo::test::nendo({"monitor", "replay:" + table, "--json"});
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::vector<json> samples;
  for (const std::string& line : lines_of(done.out))
    samples.push_back(json::parse(line));
  return samples;
}

} // namespace

TEST_SUITE("tables") {
  TEST_CASE("a glove's table has times of any origin and unit, and any usual separator") {
    const Folder files;
    for (const auto& [name, text, first_s] :
         std::vector<std::tuple<std::string, std::string, double>>{
             {"epoch.csv",
              "time_s,index_mcp,wrist_yaw\n1700000000.0000,74,170\n1700000000.0111,72,168\n",
              1700000000.0},
             {"comma.csv", "time_s;index_mcp;wrist_yaw\n0,0000;74;170\n0,0111;72;168\n", 0.0},
             {"ms.CSV", "Wrist Yaw\tTime (ms)\tIndex MCP\r\n170\t-5\t74\r\n168\t6,1\t72\r\n",
              -0.005},
             {"numpy.txt", "# time_s index_mcp wrist_yaw\n1e1 7.4e1 170.0\n10.0111 72 168\n",
              10.0}}) {
      const std::string& file = name;
      CAPTURE(file);
      const auto samples = samples_of(files.write(name, text));
      REQUIRE(samples.size() == 2);
      CHECK(samples[0]["raw"]["index_mcp"] == 74);
      CHECK(samples[1]["raw"]["wrist_yaw"] == 168);
      CHECK(samples[0]["time_s"].get<double>() == doctest::Approx(first_s).epsilon(1e-12));
      CHECK(samples[1]["time_s"].get<double>() - samples[0]["time_s"].get<double>() ==
            doctest::Approx(0.0111).epsilon(1e-4));
    }
  }

  TEST_CASE("what is wrong is one line with the place, and columns that are not read are named") {
    const Folder files;
    const auto monitor = [&](const std::string& text) {
      return nendo::test::nendo({"monitor", "replay:" + files.write("a.csv", text), "--json"});
    };
    const auto noted = monitor("time_s,index_mcp,mood\n0,1,good\n");
    CHECK(noted.exit_code == 0);
    CHECK(noted.err.find("not read: mood") != std::string::npos);
    for (const auto& [text, what] : std::vector<std::pair<std::string, std::string>>{
             {"time_s,index_mcp\nnoon,1\n",
              "a.csv:2: column 1 (time_s): 'noon' is no time; use seconds"},
             {"time_s,index_mcp\n0,1\n1,-3\n", "a.csv:3: column 2 (index_mcp): '-3' is no count"},
             {"time_s,index_mcp\n1,1\n0,1\n", "sort the rows by time"},
             {"time,index_mcp\n0,1\n", "name it time_s"},
             {"0,1\n1,2\n", "a.csv:1: has numbers where the names"},
             {"time_s,index_mcp\n0,1,2\n", "a.csv:2: has 3 cells where there are 2 columns"}}) {
      const auto refused = monitor(text);
      CHECK(refused.exit_code == 5);
      CHECK_MESSAGE(is_one_line_about(refused.err, what), refused.err);
    }
  }

  TEST_CASE("numpy reads what is exported without options, if it is installed") {
    // Debian's, for which python3-numpy is: another python3 may come first in the path.
    const std::string python = "/usr/bin/python3 ";
    if (std::system((python + "-c 'import numpy' 2>/dev/null").c_str()) != 0) {
      MESSAGE("python3-numpy is not installed");
      return;
    }
    const Folder files;
    const auto made = [&](const std::vector<std::string>& arguments) {
      const auto done = nendo::test::nendo(arguments);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    };
    made({"record", "sim:wave?hand=left&sensors=18", "sim:grasp", "--duration", "300ms", "--out",
          files.path("a.nendo")});
    made({"export", files.path("a.nendo"), "--out", files.path("samples.csv")});
    made({"run", "--left", "sim", "--right", "sim:grasp", "--duration", "0.3", "--out",
          files.path("a.obj"), "--record", files.path("run.nendo")});
    made({"export", files.path("run.nendo"), "--out", files.path("motion.csv")});
    const std::string script = files.write(
        "read.py",
        "import sys, numpy\n"
        "for name in ('samples.csv', 'motion.csv'):\n"
        "    t = numpy.genfromtxt(sys.argv[1] + '/' + name, delimiter=',', names=True)\n"
        "    lines = open(sys.argv[1] + '/' + name).read().splitlines()\n"
        "    assert len(t) == len(lines) - 1 > 10\n"
        "    assert list(t.dtype.names) == lines[0].split(','), t.dtype.names\n"
        "    assert all(t.dtype[n] == float for n in t.dtype.names)\n"
        "    assert numpy.loadtxt(sys.argv[1] + '/' + name, delimiter=',', skiprows=1).shape"
        " == (len(t), len(t.dtype.names))\n"
        "    if name == 'motion.csv':\n"
        "        assert set(t['left_calibrated']) == {1.0} and set(t['status']) <= {0.0, 1.0}\n"
        "        continue\n"
        "    assert set(t['hand']) == {0.0, 1.0} and set(t['calibrated']) == {1.0}\n"
        "    assert numpy.isnan(t['switch']).all() and numpy.isfinite(t['device_time_s']).all()\n"
        "    left = t['hand'] == 0\n"
        "    assert numpy.isnan(t['index_dip_count'][left]).all()\n"
        "    assert numpy.isfinite(t['index_dip_count'][~left]).all()\n"
        "    assert numpy.isfinite(t['index_mcp_deg']).all()\n");
    CHECK(std::system((python + script + " " + files.folder.path().string()).c_str()) == 0);
    // A glove again: the same samples.
    const auto samples = samples_of(files.path("samples.csv") + "?hand=left&speed=10");
    CHECK(samples.size() > 10);
    CHECK(samples[0]["hand"] == "left");
  }

  TEST_CASE("control vectors and wires may have semicolons and decimal commas") {
    const Folder files;
    const std::string cube = files.write(
        "cube.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    const auto deformed = [&](const std::string& vectors) {
      const auto done =
          nendo::test::nendo({"deform", cube, "--vectors", files.write("v.csv", vectors),
                              "--radius", "2", "--out", files.path("out.obj")});
      CHECK_MESSAGE(done.exit_code == 0, done.err);
      return contents(files.path("out.obj"));
    };
    const std::string wanted = deformed("x,y,z,dx,dy,dz\n0,1,0,0,0.2,0\n");
    CHECK(deformed("x;y;z;dx;dy;dz\n0;1;0;0;0.2;0\n") == wanted);
    CHECK(deformed("\xEF\xBB\xBFX; Y; Z; DX; DY; DZ\r\n0;1;0;0;0,2;0\r\n") == wanted);
    CHECK(deformed("dz\tdy\tdx\tz\ty\tx\n0\t0,2\t0\t0\t1\t0\n") == wanted);
    const auto cut = [&](const std::string& wire) {
      const auto done = nendo::test::nendo(
          {"cut", cube, "--wire", files.write("w.txt", wire), "--out", files.path("part.obj")});
      CHECK_MESSAGE(done.exit_code == 0, done.err);
      return contents(files.path("part.obj"));
    };
    const std::string parts = cut("-1,0.5,-1,-1,0.5,2\n2,0.5,-1,2,0.5,2\n");
    CHECK(cut("-1 0.5 -1, -1 0.5 2\n2 0.5 -1, 2 0.5 2\n") == parts);
    CHECK(cut("x;y;z;x2;y2;z2\n-1;0,5;-1;-1;0,5;2\n2;0,5;-1;2;0,5;2\n") == parts);
    const auto refused =
        nendo::test::nendo({"cut", cube, "--wire", files.write("w.txt", "-1,0.5,-1,-1,x,2\n"),
                            "--out", files.path("q.obj")});
    CHECK(refused.exit_code == 5);
    CHECK(is_one_line_about(refused.err, "w.txt:1: column 5: 'x'"));
  }
}

} // namespace tables_test
