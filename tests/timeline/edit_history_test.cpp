#include <doctest/doctest.h>

#include "support/rounds.hpp"
#include "support/timelines.hpp"
#include "timeline/edit.hpp"
#include "timeline/edit_history.hpp"
#include "timeline/timeline.hpp"

namespace edit_history_test {

using namespace nendo;
using namespace nendo::timeline;

namespace {

using Edit = EditHistory::Edit;
using Selection = std::optional<KeyRef>;

Timeline some_timeline(unsigned seed = 1) {
  std::mt19937 random(seed);
  return test::random_timeline(random);
}

std::string text_of(const Timeline& timeline) {
  const auto text = timeline_text(timeline);
  REQUIRE(text);
  return *text;
}

/// One that moves a key somewhere, at random; now and then it is refused.
Edit random_edit(std::mt19937& random) {
  const Side side = random() % 2 == 0 ? Side::left : Side::right;
  const std::size_t key = random() % 8;
  const double to_s = 1e-3 * static_cast<double>(random() % 3000);
  const auto kind = random() % 7;
  return [=](Timeline& timeline) -> Result<Selection> {
    const auto did = [&]() -> Result<void> {
      switch (kind) {
      case 0:
        return move_key(timeline, side, key, to_s);
      case 1:
        return copy_key(timeline, side, key, to_s);
      case 2:
        return delete_key(timeline, side, key);
      case 3:
        return add_key(timeline, side, to_s);
      case 4:
        return retime(timeline, 0.5 + to_s, 0.1, 0.4);
      case 5:
        return blend_key(timeline, side, key, 0.3);
      default:
        return mirror(timeline, 0.1);
      }
    }();
    if (!did) return did.error();
    return Selection(KeyRef{side, key});
  };
}

Result<Selection> refuse(Timeline& timeline) {
  timeline.hands.clear(); // what an edit leaves behind does not matter
  return Error{Errc::usage, "no"};
}

} // namespace

TEST_SUITE("edit_history") {
  TEST_CASE("undo reverts every edit and redo does it again, bit for bit, without limit") {
    for (const unsigned seed : {1U, 2U, 3U}) {
      std::mt19937 random(seed);
      EditHistory history(some_timeline(seed));
      std::vector<std::string> versions{text_of(history.timeline())};
      std::vector<Selection> selections{history.selected()};
      for (int edit = 0; edit < test::rounds(300); ++edit) {
        const std::string before = versions.back();
        const bool done = static_cast<bool>(history.apply(random_edit(random)));
        const std::string now = text_of(history.timeline());
        CHECK(complaint_about(history.timeline()).empty());
        if (!done) CHECK(now == before);
        if (now == before) continue; // no step
        versions.push_back(now);
        selections.push_back(history.selected());
      }
      CHECK(versions.size() > static_cast<std::size_t>(test::rounds(100)));
      for (int round = 0; round < 2; ++round) {
        for (std::size_t at = versions.size() - 1; at > 0; --at) {
          CHECK(history.can_undo());
          REQUIRE(history.undo());
          CHECK(text_of(history.timeline()) == versions[at - 1]);
        }
        CHECK_FALSE(history.undo());
        for (std::size_t at = 1; at < versions.size(); ++at) {
          CHECK(history.can_redo());
          REQUIRE(history.redo());
          CHECK(text_of(history.timeline()) == versions[at]);
          CHECK(history.selected() == selections[at]);
        }
        CHECK_FALSE(history.redo());
      }
    }
  }

  TEST_CASE("it is modified unless it is as it was saved, by whatever way") {
    EditHistory history(some_timeline());
    const Edit longer = [](Timeline& timeline) -> Result<Selection> {
      timeline.duration_s += 1.0;
      return Selection();
    };
    CHECK_FALSE(history.is_modified());
    REQUIRE(history.apply(longer));
    CHECK(history.is_modified());
    history.undo();
    CHECK_FALSE(history.is_modified());
    history.redo();
    history.saved();
    CHECK_FALSE(history.is_modified());
    history.undo();
    CHECK(history.is_modified());
    REQUIRE(history.apply(longer)); // what was saved can no longer be reached
    CHECK(history.is_modified());
    CHECK_FALSE(history.redo());
    history.undo();
    CHECK(history.is_modified());
    history.saved();
    CHECK_FALSE(history.is_modified());
  }

  TEST_CASE("an edit that is refused, or does nothing, is no step") {
    EditHistory history(some_timeline());
    const std::string before = text_of(history.timeline());
    const auto done = history.apply(refuse);
    REQUIRE_FALSE(done);
    CHECK(done.error().message == "no");
    CHECK(text_of(history.timeline()) == before);
    REQUIRE(history.apply([](Timeline&) -> Result<Selection> { return Selection(); }));
    CHECK_FALSE(history.can_undo());
    CHECK_FALSE(history.is_modified());
  }

  TEST_CASE("only the last of a mouse's tries is kept, as one step, or nothing") {
    const Timeline first = some_timeline();
    EditHistory history(first);
    const double time_s = first.hands[0].keys[2].time_s;
    const auto to = [&](double at_s) -> Edit {
      return [=](Timeline& timeline) -> Result<Selection> {
        const auto done = move_key(timeline, Side::left, 2, at_s);
        if (!done) return done.error();
        return key_at(timeline, Side::left, at_s);
      };
    };
    history.select(KeyRef{Side::left, 2});
    for (int step = 1; step <= 5; ++step) {
      REQUIRE(history.try_out(to(time_s + 0.001 * step)));
      CHECK(find_key(history.timeline(), *history.selected())->time_s == time_s + 0.001 * step);
    }
    CHECK_FALSE(history.try_out(to(-1.0))); // and the try before stays
    CHECK(find_key(history.timeline(), *history.selected())->time_s == time_s + 0.001 * 5);
    CHECK(history.is_trying());
    CHECK(history.is_modified());
    history.keep();
    const std::string moved = text_of(history.timeline());
    REQUIRE(history.undo());
    CHECK(test::same_bits(history.timeline(), first));
    CHECK(history.selected() == KeyRef{Side::left, 2});
    CHECK_FALSE(history.can_undo());
    REQUIRE(history.redo());
    CHECK(text_of(history.timeline()) == moved);
    REQUIRE(history.try_out(to(time_s + 0.3)));
    history.drop();
    CHECK(text_of(history.timeline()) == moved);
    CHECK_FALSE(history.is_trying());
  }

  TEST_CASE("what is selected exists, and each change is another revision") {
    EditHistory history(some_timeline());
    history.select(KeyRef{Side::left, 999});
    CHECK_FALSE(history.selected());
    history.select(KeyRef{Side::left, 5});
    const auto before = history.revision();
    REQUIRE(history.apply([](Timeline& timeline) -> Result<Selection> {
      const auto done = delete_key(timeline, Side::left, 5);
      if (!done) return done.error();
      return Selection(KeyRef{Side::left, 5});
    }));
    CHECK(history.revision() != before);
    CHECK_FALSE(history.selected());
    history.undo();
    CHECK(history.selected() == KeyRef{Side::left, 5});
  }
}

} // namespace edit_history_test
