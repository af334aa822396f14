#include "edit/edit_session.hpp"

#include <cmath>
#include <cstring>
#include <thread>

#include <doctest/doctest.h>

#include "commands/commands.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "support/text_files.hpp"
#include "support/timelines.hpp"
#include "timeline/hand_curve.hpp"
#include "timeline/timeline.hpp"

namespace edit_session_test {

using namespace nendo;
using namespace nendo::edit;
using namespace nendo::timeline;
using forms::EditActions;
using forms::EditCommand;
using forms::KeyDrag;
using forms::StripKey;
using forms::TipDrag;

namespace {

struct Edited {
  explicit Edited(bool with_puppet = false)
      : first(with_puppet ? test::puppet_timeline(model)
                          : test::waved_timeline(model, flow::Mode::type1)) {}

  test::TemporaryFolder folder;
  std::string out = (folder.path() / "take.timeline.toml").string();
  deform::Mesh model = test::sphere(12, 24, 1.0);
  Timeline first;
  EditSession session{first, model, out};

  void wish(EditCommand command) {
    EditActions actions;
    actions.commands = {command};
    session.handle(actions);
  }
  void click(StripKey key) {
    EditActions actions;
    actions.select.emplace(key);
    session.handle(actions);
  }
  template <class Tried>
  void try_out(const Tried& tried, bool keep = false) {
    EditActions actions;
    actions.tried = tried;
    actions.keep = keep;
    session.handle(actions);
  }
  const Timeline& now() const { return session.history().timeline(); }
  const Key& key(std::size_t hand, std::size_t key) const { return now().hands[hand].keys[key]; }
  Eigen::Vector3d tip(std::size_t hand, std::size_t at, hand::Finger finger) const {
    const Key& of = key(hand, at);
    return now()
        .hands[hand]
        .skeleton()
        .pose(of.angles, of.wrist_pose())
        .fingertip_positions()
        .col(static_cast<Eigen::Index>(finger));
  }
};

} // namespace

TEST_SUITE("edit_session") {
  TEST_CASE("pictures show the shapes of their times, and an edit replaces those that it changes") {
    Edited edited;
    edited.session.hurry_pictures(); // also while other tests run
    std::vector<forms::StripPicture> cells;
    for (double from_s = 0.0; from_s < edited.first.duration_s; from_s += 0.125)
      cells.push_back({from_s, std::min(from_s + 0.125, edited.first.duration_s)});
    EditActions asks;
    asks.cells = cells;
    const auto drawn = [&] { // as picture after picture of the window asks for them
      do {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        edited.session.handle(asks);
        edited.session.view();
      } while (!edited.session.has_all_pictures());
      return edited.session.view().pictures;
    };
    /// Those of the player's shapes.
    const auto played = [&] {
      auto player = Player::make(edited.now(), edited.model);
      REQUIRE(player);
      std::vector<ShapePictures::Shape> shapes;
      while ((*player)->next()) {
        CachedShape shape;
        shape.shape = (*player)->frame().shape;
        shape.model = (*player)->model(0);
        shapes.push_back(std::make_shared<CachedShape>(std::move(shape)));
      }
      std::vector<ShapePictures::Shape> wanted;
      for (const auto& cell : cells)
        wanted.push_back(shapes[static_cast<std::size_t>(
            std::lround((cell.from_s + cell.to_s) / 2.0 * edited.now().rate_hz))]);
      ShapePictures pictures(edited.now().units_per_metre);
      pictures.hurry();
      auto found = pictures.of(wanted);
      for (; std::ranges::find(found, nullptr) != found.end(); found = pictures.of(wanted))
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return found;
    };
    const auto check_all = [&](const std::vector<forms::StripPicture>& seen) {
      const auto expected = played();
      REQUIRE(seen.size() == expected.size());
      for (std::size_t at = 0; at < seen.size(); ++at)
        CHECK(*seen[at].image == *expected[at]);
    };
    const auto before = drawn();
    check_all(before);
    CHECK_FALSE(*before.front().image == *before.back().image);

    const std::size_t key = edited.now().hands[1].keys.size() - 2;
    edited.try_out(KeyDrag{{1, key}, edited.key(1, key).time_s + 0.02}, true);
    for (const auto& cell : edited.session.view().pictures)
      CHECK(cell.image != nullptr); // the old ones until there are others
    const auto after = drawn();
    check_all(after);
    std::size_t kept = 0;
    while (kept < cells.size() && after[kept].image == before[kept].image)
      ++kept;
    CHECK(kept > 0);
    CHECK(kept < cells.size());
    CHECK(cells[kept].to_s > edited.key(1, key - 1).time_s);
    CHECK_FALSE(*after[kept].image == *before[kept].image);
  }

  TEST_CASE("a puppet is edited, mirrored, undone and saved like hands that touch the model") {
    Edited edited(true);
    CHECK(edited.session.view().marks[1].name == "smileRight listens to right.wrist_yaw");
    edited.click({1, 5});
    edited.try_out(KeyDrag{{1, 5}, 0.47}, true);
    CHECK(edited.key(1, 5).time_s == 0.47);
    edited.wish(EditCommand::mirror);
    CHECK(edited.session.view().marks[1].name == "smileLeft listens to left.wrist_yaw");
    CHECK(edited.now().hands[1].side == Side::left);
    edited.wish(EditCommand::save);
    const auto saved = read_timeline(edited.out);
    REQUIRE(saved);
    CHECK(test::same_bits(*saved, edited.now()));
    edited.wish(EditCommand::undo);
    edited.wish(EditCommand::undo);
    CHECK(test::same_bits(edited.now(), edited.first));
    CHECK(edited.session.history().is_modified());
    CHECK_FALSE(edited.session.scene_frame().held); // no fingertip touches the model
    while (edited.session.view().computing)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    edited.session.seek(0.28);
    const auto& functions = edited.session.view().functions;
    REQUIRE(functions.size() == edited.first.rig_state.functions.size());
    play_functions(edited.first, std::array{25.0 / 90.0},
                   [&](std::size_t, const PuppetMoment& moment) {
                     const auto values = moment.hands.player().values();
                     for (std::size_t at = 0; at < values.size(); ++at) {
                       CHECK(functions[at].value == doctest::Approx(values[at]));
                       CHECK(functions[at].name == edited.first.rig->puppet().functions[at].name);
                     }
                   });
  }

  TEST_CASE("what is shown at a frame's time are the player's hands, and where they grabbed") {
    Edited edited;
    auto player = Player::make(edited.first, edited.model);
    REQUIRE(player);
    render::HoldTracker holds;
    while (edited.session.view().computing)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    while ((*player)->next()) {
      holds.follow((*player)->frame());
      edited.session.seek((*player)->time_s());
      CHECK_FALSE(edited.session.view().shape_is_old);
      const render::SceneFrame& scene_frame = edited.session.scene_frame();
      CHECK(scene_frame.held == (*player)->frame().held);
      for (std::size_t slot = 0; slot < 2; ++slot) {
        REQUIRE(scene_frame.hands[slot]);
        CHECK(scene_frame.hands[slot]->pose.fingertip_positions() ==
              (*player)->frame().hands[slot].pose.fingertip_positions());
        if (scene_frame.held) CHECK(scene_frame.hands[slot]->starts == holds.starts(slot));
      }
    }
  }

  TEST_CASE("a key that is clicked has the head, and a drag of it is one step") {
    Edited edited;
    edited.wish(EditCommand::play);
    edited.click({1, 3});
    CHECK_FALSE(edited.session.view().facts.playing);
    CHECK(edited.session.view().head_s == edited.first.hands[1].keys[3].time_s);
    CHECK(edited.session.view().at_selected);
    const double to_s = edited.first.hands[1].keys[5].time_s + 0.01;
    for (const double at_s : {0.35, 0.5, to_s})
      edited.try_out(KeyDrag{{1, 3}, at_s, false}, at_s == to_s);
    CHECK(edited.key(1, 5).time_s == to_s); // past two others
    CHECK(edited.session.view().selected == StripKey{1, 5});
    CHECK(edited.session.view().head_s == to_s);
    CHECK(edited.session.view().modified);
    edited.try_out(KeyDrag{{1, 5}, 0.1, true}, true);
    CHECK(edited.now().hands[1].keys.size() == edited.first.hands[1].keys.size() + 1);
    edited.wish(EditCommand::undo);
    edited.wish(EditCommand::undo);
    CHECK(test::same_bits(edited.now(), edited.first));
    CHECK_FALSE(edited.session.view().modified);
    edited.wish(EditCommand::undo);
    CHECK(edited.session.view().message == "There is nothing to undo.");
    edited.try_out(KeyDrag{{0, 0}, edited.first.hands[0].keys[1].time_s, false});
    CHECK(edited.session.view().refused);
    EditActions drop;
    drop.drop = true;
    edited.session.handle(drop);
    CHECK(test::same_bits(edited.now(), edited.first));
  }

  TEST_CASE("a fingertip that is dragged comes to the place, or as near as it can, and says so") {
    Edited edited;
    edited.click({0, 4});
    const auto index = hand::Finger::index;
    // A place that it can reach: where it is in another pose of the same hand.
    Key other = edited.key(0, 4);
    other.angles[index].pip_flexion_rad += 0.2;
    const Eigen::Vector3d target_m = edited.first.hands[0]
                                         .skeleton()
                                         .pose(other.angles, other.wrist_pose())
                                         .fingertip_positions()
                                         .col(1);
    const Eigen::Vector3d begin_m = edited.tip(0, 4, index);
    for (const double part : {0.3, 0.7, 1.0})
      edited.try_out(TipDrag{index, begin_m + part * (target_m - begin_m)}, part == 1.0);
    CHECK((edited.tip(0, 4, index) - target_m).norm() < 1e-4);
    CHECK(edited.session.view().message.starts_with("index tip: 0.0"));
    CHECK(edited.tip(0, 4, hand::Finger::thumb) ==
          Eigen::Vector3d(edited.first.hands[0]
                              .skeleton()
                              .pose(edited.first.hands[0].keys[4].angles,
                                    edited.first.hands[0].keys[4].wrist_pose())
                              .fingertip_positions()
                              .col(0)));
    edited.wish(EditCommand::undo);
    CHECK(test::same_bits(edited.now(), edited.first));
    edited.try_out(TipDrag{index, begin_m + Eigen::Vector3d(0.0, 1.0, 0.0)}, true);
    CHECK(edited.session.view().message.find("out of reach") != std::string::npos);
    CHECK_FALSE(edited.session.view().refused);
    CHECK((edited.tip(0, 4, index) - begin_m).norm() > 1e-3);
  }

  TEST_CASE("keys are added, copied and deleted at the head, and the hands mirrored") {
    Edited edited;
    const std::size_t keys = edited.first.hands[0].keys.size();
    edited.session.seek(0.123);
    edited.wish(EditCommand::delete_key);
    CHECK(edited.session.view().refused); // nothing is selected
    edited.wish(EditCommand::add_key);    // both hands
    CHECK(edited.now().hands[0].keys.size() == keys + 1);
    CHECK(edited.now().hands[1].keys.size() == keys + 1);
    edited.wish(EditCommand::add_key); // there is one already
    CHECK(edited.session.view().refused);
    edited.wish(EditCommand::undo);
    CHECK(test::same_bits(edited.now(), edited.first));
    edited.click({0, 2});
    edited.session.seek(0.5);
    edited.wish(EditCommand::copy_key);
    CHECK(edited.now().hands[0].keys.size() == keys + 1);
    CHECK(edited.now().hands[1].keys.size() == keys);
    CHECK(edited.session.view().at_selected);
    edited.wish(EditCommand::mirror);
    CHECK(edited.now().hands[0].side == Side::right);
    CHECK(edited.session.view().selected->lane == 0);
    edited.wish(EditCommand::delete_key);
    CHECK(edited.now().hands[0].keys.size() == keys);
    edited.wish(EditCommand::mirror);
    for (std::size_t hand = 0; hand < 2; ++hand)
      for (std::size_t key = 0; key < keys; ++key)
        CHECK((edited.key(hand, key).wrist_m - edited.first.hands[hand].keys[key].wrist_m).norm() <
              1e-12);
  }

  TEST_CASE("a command that is not possible is refused with the reason, and changes nothing") {
    Edited edited;
    for (const auto command :
         {EditCommand::undo, EditCommand::redo, EditCommand::copy_key, EditCommand::delete_key}) {
      edited.wish(command);
      CHECK(edited.session.view().refused);
      CHECK(edited.session.view().message ==
            commands::row_of(command).refusal_in(commands::EditFacts{}));
    }
    edited.try_out(KeyDrag{{0, 3}, edited.key(0, 3).time_s});
    edited.wish(EditCommand::undo); // of a trial that has changed nothing
    CHECK(edited.session.view().message == "There is nothing to undo.");
    edited.session.seek(0.0);
    edited.wish(EditCommand::previous_key);
    CHECK(edited.session.view().message == "there is no earlier key");
    CHECK(test::same_bits(edited.now(), edited.first));
  }

  TEST_CASE("the head goes by keys and by frames, and plays on in time") {
    Edited edited;
    edited.wish(EditCommand::next_key);
    CHECK(edited.session.view().head_s == edited.first.hands[0].keys[1].time_s);
    edited.wish(EditCommand::next_key);
    edited.wish(EditCommand::previous_key);
    CHECK(edited.session.view().selected->key == 1);
    edited.session.seek(0.5 / edited.first.rate_hz);
    edited.wish(EditCommand::next_frame);
    CHECK(edited.session.view().head_s == 1.0 / edited.first.rate_hz);
    edited.wish(EditCommand::next_frame);
    CHECK(edited.session.view().head_s == 2.0 / edited.first.rate_hz);
    edited.wish(EditCommand::previous_frame);
    edited.wish(EditCommand::previous_frame);
    CHECK(edited.session.view().head_s == 0.0);
    edited.wish(EditCommand::previous_frame);
    CHECK(edited.session.view().head_s == 0.0);
    edited.wish(EditCommand::faster);
    CHECK(edited.session.view().speed > 1.0);
    edited.wish(EditCommand::slower);
    edited.wish(EditCommand::play);
    edited.session.advance(0.25);
    CHECK(edited.session.view().head_s == 0.25);
    edited.session.advance(100.0);
    CHECK(edited.session.view().head_s == edited.first.duration_s);
    CHECK_FALSE(edited.session.view().facts.playing);
  }

  TEST_CASE("what is saved is what was edited, and what cannot be saved stays unsaved") {
    Edited edited;
    edited.click({0, 3});
    edited.wish(EditCommand::delete_key);
    edited.wish(EditCommand::save);
    CHECK_FALSE(edited.session.view().modified);
    const auto text = timeline_text(edited.now());
    REQUIRE(text);
    CHECK(test::contents(edited.out) == *text);
    edited.wish(EditCommand::undo);
    CHECK(edited.session.view().modified);

    EditSession elsewhere(edited.first, edited.model,
                          (edited.folder.path() / "none" / "a.timeline.toml").string());
    EditActions actions;
    actions.commands = {EditCommand::mirror, EditCommand::save};
    elsewhere.handle(actions);
    CHECK(elsewhere.view().refused);
    CHECK(elsewhere.view().modified);
  }

  TEST_CASE("the export is of the timeline as it is edited, and continues beside") {
    Edited edited;
    edited.wish(EditCommand::mirror);
    edited.wish(EditCommand::export_glb);
    CHECK(edited.session.view().facts.exporting);
    edited.wish(EditCommand::export_glb); // one at a time
    CHECK(edited.session.view().refused);
    while (edited.session.view().facts.exporting) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      edited.session.advance(0.0);
    }
    const std::string file = (edited.folder.path() / "take.glb").string();
    CHECK(test::contents(file).starts_with("glTF"));
    CHECK(edited.session.view().message.starts_with(file));
    CHECK(edited.session.view().modified); // that is not saving
    edited.wish(EditCommand::export_glb);  // and is stopped by leaving
  }
}

} // namespace edit_session_test
