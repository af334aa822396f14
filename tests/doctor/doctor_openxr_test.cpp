// What the doctor makes of manifests of OpenXR's layers.

#include <cstdlib>

#include <doctest/doctest.h>

#include "doctor/doctor.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace doctor_openxr_test {

using namespace nendo::doctor;
using nendo::test::TemporaryFolder;
using nendo::test::write_file;

namespace {

std::string manifest(const std::string& layer, const std::string& library) {
  return R"({"file_format_version": "1.0.0", "api_layer": {"name": ")" + layer +
         R"(", "library_path": ")" + library + R"("}})";
}

const char* const own = "XR_APILAYER_NENDO_hand_tracking";

} // namespace

TEST_SUITE("doctor") {
  TEST_CASE("without a layer of OpenXR, and without NENDO_XR, nothing is said") {
    const TemporaryFolder folder;
    ::unsetenv("NENDO_XR");
    const OpenXrFacts facts = read_openxr({folder.path(), folder.path() / "nowhere"});
    CHECK(facts.manifests.empty());
    CHECK(diagnose_openxr(facts).empty());
  }

  TEST_CASE("NENDO_XR without a layer, without a name and when disabled is a warning each") {
    OpenXrFacts facts;
    facts.segment = "clay";
    REQUIRE(diagnose_openxr(facts).size() == 1);
    CHECK(diagnose_openxr(facts)[0].severity == Severity::warning);
    CHECK(diagnose_openxr(facts)[0].remedy.find("nendo-openxr") != std::string::npos);
    facts.manifests.push_back({"/usr/share/it.json", ""});
    CHECK(diagnose_openxr(facts).empty());
    facts.is_disabled = true;
    REQUIRE(diagnose_openxr(facts).size() == 1);
    CHECK(diagnose_openxr(facts)[0].remedy == "unset DISABLE_NENDO_XR");
    facts.is_disabled = false;
    facts.segment = "../clay";
    CHECK(diagnose_openxr(facts).size() == 1);
  }

  TEST_CASE("a layer whose library is missing, or is another one, is a failure") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "layer.json";
    const auto only_problem = [&] {
      const auto found = diagnose_openxr(read_openxr({folder.path()}));
      REQUIRE(found.size() == 1);
      CHECK(found[0].severity == Severity::failure);
      CHECK(found[0].subject == path.string());
      CHECK_FALSE(found[0].remedy.empty());
      return found[0].what;
    };
    write_file(path, manifest(own, "./nowhere.so"));
    CHECK(only_problem().find("nowhere.so") != std::string::npos);
    write_file(path, manifest(own, "libm.so.6")); // in the search path, but no layer
    CHECK(only_problem().find("xrNegotiateLoaderApiLayerInterface") != std::string::npos);
    write_file(path, manifest(own, ""));
    CHECK(only_problem().find("no library") != std::string::npos);
  }

  TEST_CASE("manifests of others are not judged, and Nendo's must be JSON") {
    const TemporaryFolder folder;
    write_file(folder.path() / "other.json", manifest("XR_APILAYER_OTHER", "./nowhere.so"));
    write_file(folder.path() / "broken.json", "{");
    write_file(folder.path() / "list.json", "[1, 2]");
    write_file(folder.path() / "number.json", R"({"api_layer": {"name": 7}})");
    write_file(folder.path() / "nendo.txt", "no manifest");
    CHECK(read_openxr({folder.path()}).manifests.empty());
    write_file(folder.path() / "XrApiLayer_nendo.json", "{");
    const auto found = diagnose_openxr(read_openxr({folder.path()}));
    REQUIRE(found.size() == 1);
    CHECK(found[0].what.find("not JSON") != std::string::npos);
  }

#ifdef NENDO_OPENXR_MANIFESTS
  TEST_CASE("the layer in the build folder can be loaded by its manifest") {
    const OpenXrFacts facts = read_openxr({NENDO_OPENXR_MANIFESTS});
    REQUIRE(facts.manifests.size() == 1);
    CHECK(facts.manifests[0].problem == "");
  }
#endif
}

} // namespace doctor_openxr_test
