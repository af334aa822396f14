#include <doctest/doctest.h>

#include "session/run_commands.hpp"

namespace loop_commands_test {

using namespace nendo;
using nendo::session::LoopCommands;

TEST_SUITE("loop_commands") {
  TEST_CASE("each command that finds no space is named once, until a command finds space again") {
    LoopCommands commands(2);
    CHECK(commands.push(flow::Request::commit));
    CHECK(commands.push(flow::Mark{}));
    CHECK_FALSE(commands.dropped());
    CHECK(commands.size() == 2);

    CHECK_FALSE(commands.push(flow::DrawWire{true}));
    CHECK_FALSE(commands.push(flow::SetLayer{1, true}));
    CHECK_FALSE(commands.push(flow::SetLayer{2, true}));
    CHECK_FALSE(commands.push(flow::Request::undo));
    CHECK(commands.dropped() == "The loop is not responding; dropped: wire, punch, undo.");
    CHECK_FALSE(commands.dropped());
    CHECK_FALSE(commands.push(flow::Request::undo)); // which was said
    CHECK_FALSE(commands.dropped());
    CHECK_FALSE(commands.push(flow::DrawWire{true, flow::Blade::knife}));
    CHECK(commands.dropped() == "The loop is not responding; dropped: knife.");
    CHECK_FALSE(commands.try_push(flow::WristMove{})); // stays with the caller
    CHECK_FALSE(commands.dropped());

    commands.ring().drain([](const flow::Command&) noexcept {});
    CHECK(commands.push(flow::Request::grab));
    CHECK(commands.push(flow::Request::grab));
    CHECK_FALSE(commands.push(flow::Request::undo));
    CHECK(commands.dropped() == "The loop is not responding; dropped: undo.");
  }

  TEST_CASE("a command dropped just before another finds space is also named") {
    LoopCommands commands(2);
    CHECK(commands.push(flow::Request::grab));
    CHECK(commands.push(flow::Request::grab));
    CHECK_FALSE(commands.push(flow::SetSymmetry{true}));
    commands.ring().drain([](const flow::Command&) noexcept {});
    CHECK(commands.push(flow::Request::grab));
    CHECK(commands.dropped() == "The loop is not responding; dropped: symmetry.");
  }
}

} // namespace loop_commands_test
