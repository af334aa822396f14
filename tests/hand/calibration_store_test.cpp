#include <nendo/hand/calibration_store.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "support/temporary_folder.hpp"

namespace calibration_store_test {

using namespace nendo;
using namespace nendo::hand;
using nendo::test::TemporaryFolder;

namespace fs = std::filesystem;

namespace {

const std::string model = "CyberGlove, 22 sensors";

struct About {
  std::string user = "anna";
  std::string serial = "";
  Side side = Side::right;
  std::string glove_model = model;
  int made_s = 1000;
};

WearerCalibration wearer_of(const About& about) {
  WearerCalibration wearer;
  wearer.user = about.user;
  wearer.glove_serial = about.serial;
  wearer.glove_model = about.glove_model;
  wearer.side = about.side;
  wearer.made = std::chrono::sys_seconds(std::chrono::seconds(about.made_s));
  wearer.method = "quick";
  wearer.calibration = default_calibration();
  return wearer;
}

struct Store {
  TemporaryFolder root;
  CalibrationFolders folders{root.path() / "own", root.path() / "shared"};

  void add(const std::string& name, const About& about, bool shared = false) const {
    const auto written =
        write_calibration((shared ? folders.shared : folders.own) / name, wearer_of(about));
    REQUIRE(written);
  }
  /// The chosen file's name, or "none".
  std::string chosen(const GloveIdentity& glove) const {
    const auto list = list_calibrations(folders);
    const auto choice = choose_calibration(list.files, glove);
    return choice ? choice->file->path.stem().string() : "none";
  }
};

GloveIdentity glove(const std::string& user, const std::string& serial, Side side = Side::right) {
  return {user, model, serial, side, {}};
}

} // namespace

TEST_SUITE("calibration store") {
  TEST_CASE("names are distinct, stay in their folder and fit a file system") {
    const std::string inputs[] = {"anna",
                                  "Anna",
                                  "an na",
                                  "an_na",
                                  "an%20na",
                                  "a+b",
                                  "a%2Bb",
                                  "",
                                  ".",
                                  "..",
                                  "../../etc/passwd",
                                  "/etc/passwd",
                                  "any",
                                  "%61ny",
                                  "a\nb",
                                  std::string("a\0b", 3),
                                  "é",
                                  "\xFF",
                                  std::string(1000, 'x'),
                                  std::string(1000, 'x') + "y",
                                  std::string(79, 'x'),
                                  std::string(300, '/'),
                                  std::string(301, '/'),
                                  "x.20261121T192705Z"};
    std::set<std::string> names;
    for (const auto& user : inputs) {
      for (const auto& serial : inputs) {
        for (const Side side : {Side::left, Side::right}) {
          const std::string name = calibration_file_name(user, serial, side);
          CAPTURE(name);
          CHECK(name.size() <= 200);
          CHECK(name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                       "0123456789_+%.-") == std::string::npos);
          CHECK_FALSE(name.starts_with('.'));
          CHECK(name.ends_with(".toml"));
          CHECK_FALSE(is_earlier_version(name));
          CHECK(names.insert(name).second);
        }
      }
    }
    CHECK(calibration_file_name("anna", "", Side::right) == "anna+any+right.toml");
    CHECK(calibration_file_name("anna", "A1", Side::left) == "anna+A1+left.toml");
  }

  TEST_CASE("this very glove goes before any glove, and that before another of its model") {
    const Store store;
    CHECK(store.chosen(glove("anna", "A1")) == "none");
    store.add("other.toml", {"anna", "B2", Side::right, model, 9000});
    CHECK(store.chosen(glove("anna", "A1")) == "other");
    store.add("any.toml", {"anna", "", Side::right, model, 5000});
    CHECK(store.chosen(glove("anna", "A1")) == "any");
    store.add("this.toml", {"anna", "A1", Side::right, model, 1000});
    CHECK(store.chosen(glove("anna", "A1")) == "this");
    // A glove without a serial number is any glove.
    CHECK(store.chosen(glove("anna", "")) == "any");
    const auto list = list_calibrations(store.folders);
    CHECK(choose_calibration(list.files, glove("anna", "A1"))->match == GloveMatch::this_glove);
    CHECK(choose_calibration(list.files, glove("anna", "C3"))->match == GloveMatch::any_glove);
    CHECK(choose_calibration({list.files[1]}, glove("anna", "C3"))->match ==
          GloveMatch::other_glove);
  }

  TEST_CASE("the other hand's, another user's and another model's is never used") {
    const Store store;
    store.add("left.toml", {"anna", "A1", Side::left});
    CHECK(store.chosen(glove("anna", "A1", Side::right)) == "none");
    CHECK(store.chosen(glove("anna", "A1", Side::left)) == "left");
    CHECK(store.chosen(glove("berta", "A1", Side::left)) == "none");
    CHECK(store.chosen(glove("", "A1", Side::left)) == "left"); // any user
    GloveIdentity other = glove("anna", "Z9", Side::left);
    CHECK(store.chosen(other) == "left");
    other.model = "CyberGlove, 18 sensors";
    CHECK(store.chosen(other) == "none");
    other.serial = "A1"; // two makers may give the same number
    CHECK(store.chosen(other) == "none");
    GloveIdentity self_calibrating = glove("anna", "A1", Side::left);
    self_calibrating.counts.self_calibrated = true;
    CHECK(store.chosen(self_calibrating) == "none");
  }

  TEST_CASE("a user's own file goes before a shared one, and the newer before the older") {
    const Store store;
    store.add("shared.toml", {"anna", "A1", Side::right, model, 9000}, true);
    CHECK(store.chosen(glove("anna", "A1")) == "shared");
    store.add("own.toml", {"anna", "A1", Side::right, model, 10});
    CHECK(store.chosen(glove("anna", "A1")) == "own");
    store.add("newer.toml", {"anna", "A1", Side::right, model, 20});
    CHECK(store.chosen(glove("anna", "A1")) == "newer");
    store.add("shared2.toml", {"berta", "A1", Side::right, model, 9999}, true);
    CHECK(store.chosen(glove("berta", "A1")) == "shared2");
    const auto list = list_calibrations(store.folders);
    REQUIRE(list.files.size() == 4);
    for (const auto& file : list.files) {
      const std::string stem = file.path.stem().string();
      CHECK(is_active_calibration(file, list.files) == (stem == "newer" || stem == "shared2"));
    }
  }

  TEST_CASE("a file that cannot be read is reported, and the others are used") {
    const Store store;
    store.add("good.toml", {});
    std::ofstream(store.folders.own / "bad.toml") << "version = 7\n";
    REQUIRE(::mkfifo((store.folders.own / "pipe.toml").c_str(), 0600) == 0);
    fs::create_symlink("loop.toml", store.folders.own / "loop.toml");
    std::ofstream(store.folders.own / "notes.txt") << "no calibration";
    const auto list = list_calibrations(store.folders);
    CHECK(list.files.size() == 1);
    REQUIRE(list.unreadable.size() == 3);
    for (const auto* name : {"bad.toml", "pipe.toml", "loop.toml"}) {
      CHECK(std::any_of(list.unreadable.begin(), list.unreadable.end(), [&](const Error& error) {
        return error.message.find(name) != std::string::npos;
      }));
    }
    CHECK(store.chosen(glove("anna", "")) == "good");
  }

  TEST_CASE("earlier versions are not listed, and missing folders are empty") {
    const Store store;
    const auto none = list_calibrations(store.folders);
    CHECK(none.files.empty());
    CHECK(none.unreadable.empty());
    store.add("a.toml", {});
    store.add("a.toml", {});
    CHECK(std::distance(fs::directory_iterator(store.folders.own), fs::directory_iterator{}) == 2);
    CHECK(list_calibrations(store.folders).files.size() == 1);
    std::ofstream(store.folders.shared) << "a file where a folder should be";
    const auto list = list_calibrations(store.folders);
    CHECK(list.files.size() == 1);
    CHECK(list.unreadable.size() == 1);
  }

  TEST_CASE("the folders are where the XDG specification puts them") {
    const auto folders_with = [](const char* config) {
      const char* const before = std::getenv("XDG_CONFIG_HOME");
      const std::string saved = before == nullptr ? "" : before;
      ::setenv("XDG_CONFIG_HOME", config, 1);
      const auto folders = calibration_folders();
      before == nullptr ? ::unsetenv("XDG_CONFIG_HOME")
                        : ::setenv("XDG_CONFIG_HOME", saved.c_str(), 1);
      return folders;
    };
    CHECK(folders_with("/x/y").own == "/x/y/nendo/calibrations");
    CHECK(folders_with("/x/y").shared == "/etc/nendo/calibrations");
    const auto own = own_calibration_path("anna", "A 2", Side::left);
    REQUIRE(own);
    CHECK(*own == calibration_folders().own / calibration_file_name("anna", "A 2", Side::left));
    const char* const home = std::getenv("HOME");
    if (home != nullptr && home[0] == '/') {
      CHECK(folders_with("relative").own == fs::path(home) / ".config/nendo/calibrations");
      CHECK(folders_with("").own == fs::path(home) / ".config/nendo/calibrations");
    }
  }
}

} // namespace calibration_store_test
