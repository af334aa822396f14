#include <cstdlib>
#include <filesystem>

#include <doctest/doctest.h>

#include "session/kept_state.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace kept_state_test {

using namespace nendo;

TEST_SUITE("kept_state") {
  TEST_CASE("hints are due until they were closed, and never without a place to keep that") {
    const test::TemporaryFolder folder;
    const char* const before = std::getenv("HOME");
    const std::string home = before != nullptr ? before : "";
    ::unsetenv("XDG_STATE_HOME");
    ::setenv("HOME", folder.path().c_str(), 1);
    CHECK(session::are_hints_due());
    session::keep_hints_closed();
    CHECK_FALSE(session::are_hints_due());
    CHECK(std::filesystem::exists(folder.path() / ".local/state/nendo/hints-closed"));

    ::setenv("XDG_STATE_HOME", (folder.path() / "state").c_str(), 1);
    CHECK(session::are_hints_due());
    session::keep_hints_closed();
    CHECK_FALSE(session::are_hints_due());

    // A file is where the folder would be: no error, and the hints come again.
    test::write_file(folder.path() / "file", "");
    ::setenv("XDG_STATE_HOME", (folder.path() / "file").c_str(), 1);
    session::keep_hints_closed();
    CHECK(session::are_hints_due());

    ::unsetenv("XDG_STATE_HOME");
    ::unsetenv("HOME");
    CHECK_FALSE(session::are_hints_due());
    session::keep_hints_closed();
    ::setenv("HOME", home.c_str(), 1);
  }
}

} // namespace kept_state_test
