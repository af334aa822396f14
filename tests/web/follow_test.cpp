// A client that follows the steps has the loop's shape: the law that the page lives by, with a
// client that was written from PROTOCOL.md alone.

#include <map>
#include <random>

#include <doctest/doctest.h>

#include "following_client.hpp"
#include "streamed_loop.hpp"
#include "support/any_puppet.hpp"
#include "web/frame_stream.hpp"
#include "web/model_message.hpp"

namespace follow_test {

using namespace nendo;
using namespace nendo::web;
using nendo::test::FollowingClient;
using nendo::test::StreamedLoop;

namespace {

/// As the server's thread does: records and shapes, over a feed, to one client.
struct Followed {
  StreamedLoop& streamed;
  Feed feed;
  FollowingClient client;
  std::map<std::uint64_t, std::vector<std::byte>> weights; ///< messages, by their number
  bool has_weights = true;                                 ///< false: they are on their way yet

  explicit Followed(StreamedLoop& loop) : streamed(loop), client(loop.model) {
    streamed.stream->set_active(true);
  }

  void pass(bool has_space = true) {
    std::vector<Record> records;
    streamed.stream->take(records);
    const auto shape = streamed.stream->take_shape();
    if (const auto& surface = streamed.test.loop->changes().sculptor_options().surface)
      weights.try_emplace(surface->number(), weights_message(*surface));
    feed.look_at(records);
    if (!has_space) {
      feed.skip(records);
      return;
    }
    if (const auto wanted = feed.wanted_weights(); wanted != 0 && has_weights) {
      REQUIRE(weights.contains(wanted));
      CHECK(client.take(weights[wanted]));
      feed.weights_sent(wanted);
    }
    if (shape && feed.wants_shape()) {
      CHECK(client.take(shape->message));
      feed.shape_sent(shape->number);
    }
    if (const auto update = feed.update(records, streamed.stream->lost()))
      CHECK(client.take(*update));
    if (feed.wants_shape()) streamed.stream->request_shape();
  }
  /// As a share of the diagonal.
  double gap(const deform::Points& shape) const {
    return (client.vertices() - shape).cwiseAbs().maxCoeff() / client.diagonal;
  }
  bool is_up_to_date() const {
    return client.follows() && !feed.wants_shape() && feed.wanted_weights() == 0;
  }
};

const std::array<std::pair<flow::Mode, bool>, 4> ways{{{flow::Mode::type1, false},
                                                       {flow::Mode::type1, true},
                                                       {flow::Mode::type2, false},
                                                       {flow::Mode::type2, true}}};

StreamedLoop loop_of(const std::pair<flow::Mode, bool>& way) {
  if (way.second) return StreamedLoop(way.first, {.injective = deform::InjectiveOptions{}});
  return StreamedLoop(way.first);
}

/// With a mask, whose border cuts through what its functions reach.
StreamedLoop puppet_loop(flow::Mode mode) {
  static const std::string text =
      std::string(test::ball_puppet) + "[[masks]]\nat = [0.3, 0.3, 0.9]\nradius = 0.5\n";
  return StreamedLoop(mode, {.puppet = text.c_str()});
}

} // namespace

TEST_SUITE("follow") {
  TEST_CASE("through grabs, commits and undos, in either mode, a follower has the loop's shape at "
            "every tick, within 1e-5 of the diagonal") {
    for (const auto& way : ways) {
      CAPTURE(name_of(way.first));
      CAPTURE(way.second);
      StreamedLoop streamed = loop_of(way);
      Followed followed(streamed);
      REQUIRE(followed.client.good);
      std::mt19937 random(11);
      int bent = 0;
      double worst = 0.0;
      double moved = 0.0;
      int compared = 0;
      for (int tick = 0; tick < 600; ++tick) {
        bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 40);
        if (random() % 25 == 0)
          streamed.test.commands.try_push(flow::requests[random() % flow::requests.size()]);
        const auto shape = streamed.tick(bent);
        moved = std::max(moved, (shape - streamed.test.model.vertices).cwiseAbs().maxCoeff());
        followed.pass();
        if (!followed.is_up_to_date()) continue;
        worst = std::max(worst, followed.gap(shape));
        ++compared;
      }
      CHECK(worst < 1e-5);
      CHECK(moved > 0.05); // of a ball of radius 1
      CHECK(compared > 500);
      CHECK(followed.client.rest_changes >= 3);
      CHECK(followed.client.jumps >= 3);
      CHECK(followed.client.shapes >= static_cast<int>(followed.client.jumps));
      CHECK(followed.client.lost == 0);
    }
  }

  TEST_CASE(
      "so it has through changes of settings, from each mode to each, without the whole shape "
      "being sent") {
    for (const auto& way : ways) {
      CAPTURE(name_of(way.first));
      StreamedLoop streamed = loop_of(way);
      Followed followed(streamed);
      std::mt19937 random(12);
      int bent = 0;
      double worst = 0.0;
      int shapes = 0;
      for (int tick = 0; tick < 600; ++tick) {
        bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 40);
        if (random() % 6 == 0) {
          auto settings = test::any_settings(streamed.test.loop->changes().settings(), random);
          settings.brushes = {}; // whose work no field describes, nor that of hands in clay
          if (settings.mode == flow::Mode::clay) settings.mode = flow::Mode::type2;
          static_cast<void>(streamed.test.loop->changes().change_settings(settings));
        }
        const auto shape = streamed.tick(bent);
        followed.pass();
        if (tick == 10) shapes = followed.client.shapes;
        if (tick > 10) worst = std::max(worst, followed.gap(shape));
      }
      CHECK(worst < 1e-5);
      CHECK(shapes == 1);
      CHECK(streamed.test.loop->stats().changes > 50);
      CHECK(followed.client.shapes < 10); // for rounding errors only
    }
  }

  TEST_CASE(
      "a follower that takes several ticks at once, or misses some, comes to the same shape") {
    for (const auto& way : ways) {
      CAPTURE(name_of(way.first));
      CAPTURE(way.second);
      StreamedLoop streamed = loop_of(way);
      Followed followed(streamed);
      std::mt19937 random(5);
      int bent = 0;
      int compared = 0;
      for (int stretch = 0; stretch < 150; ++stretch) {
        deform::Points shape;
        for (auto ticks = 1 + random() % 8; ticks > 0; --ticks) {
          bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 40);
          if (random() % 40 == 0)
            streamed.test.commands.try_push(flow::requests[random() % flow::requests.size()]);
          shape = streamed.tick(bent);
        }
        followed.pass(random() % 4 != 0);
        if (!followed.is_up_to_date() || followed.client.number != followed.client.newest) continue;
        if (followed.client.tick + 1 != streamed.test.loop->stats().ticks)
          continue; // it missed this
        CHECK(followed.gap(shape) < 1e-5);
        ++compared;
      }
      CHECK(compared > 30);
      CHECK(followed.client.skipped > 50);
    }
  }

  TEST_CASE("when no thread empties the ring, frames are lost and counted, and a fresh shape "
            "repairs it") {
    StreamedLoop streamed(flow::Mode::type2);
    Followed followed(streamed);
    streamed.tick(0);
    followed.pass();
    streamed.tick(1);
    followed.pass();
    REQUIRE(followed.is_up_to_date());
    const int shapes = followed.client.shapes;
    for (int tick = 0; tick < 3000; ++tick)
      streamed.tick(tick % 30);
    CHECK(streamed.stream->lost() > 0);
    for (int tick = 0; tick < 4; ++tick) { // what is in the ring, what says that some is not
      const auto shape = streamed.tick(5 * tick);
      followed.pass();
      if (tick == 3) CHECK(followed.gap(shape) < 1e-5);
    }
    CHECK(followed.client.shapes == shapes + 1);
    CHECK(followed.client.lost == streamed.stream->lost());
    CHECK(followed.is_up_to_date());
  }

  TEST_CASE("radii of their own, and a finger's worth of nothing, are sent as they are") {
    std::vector<deform::OwnSupport> own;
    for (Eigen::Index point = 0; point < 10; ++point)
      own.push_back({point, {0.2 + 0.05 * static_cast<double>(point), 1.0}});
    StreamedLoop streamed(flow::Mode::type1, {.supports = deform::with_common(own)});
    Followed followed(streamed);
    for (int tick = 0; tick < 40; ++tick) {
      const auto shape = streamed.tick(tick);
      followed.pass();
      if (followed.is_up_to_date()) CHECK(followed.gap(shape) < 1e-5);
    }
    CHECK(followed.is_up_to_date());
  }

  TEST_CASE(
      "the hands' joints are sent to within 0.03 mm and a hundredth of a degree, whatever bends") {
    StreamedLoop streamed(flow::Mode::type1);
    Followed followed(streamed);
    std::mt19937 random(3);
    double max_m = 0.0;
    double max_rad = 0.0;
    for (int tick = 0; tick < 200; ++tick) {
      for (const Side side : {Side::left, Side::right}) {
        auto sample = test::bent_sample(side, 0, HostClock::now());
        for (auto& sensor : sample.raw)
          sensor.value = static_cast<std::uint16_t>(40 + random() % 160);
        streamed.test.rings[flow::Placement::index_of(side)]->try_push(sample);
      }
      Eigen::Isometry3d wrist = streamed.test.placement.T_stage_wrist[0];
      wrist.rotate(Eigen::AngleAxisd(0.03 * tick, Eigen::Vector3d(1, 2, 3).normalized()));
      wrist.translation().x() += 0.01 * tick;
      streamed.test.commands.try_push(flow::WristMove::to(Side::left, wrist));
      const auto& frame = streamed.test.frame_after_tick(static_cast<std::uint64_t>(tick));
      followed.pass();
      for (std::size_t slot = 0; slot < 2; ++slot) {
        REQUIRE(followed.client.present[slot]);
        const auto& hand = frame.hands[slot];
        const Eigen::Quaterniond forearm(hand.T_stage_wrist.linear());
        max_rad = std::max(max_rad, followed.client.forearms[slot].angularDistance(forearm));
        for (std::size_t joint = 0; joint < 26; ++joint) {
          const auto& pose = hand.pose.joints[joint];
          const auto& sent = followed.client.joints[slot][joint];
          max_m = std::max(max_m, (sent - pose.translation()).norm());
          const Eigen::Quaterniond turn(pose.linear());
          max_rad = std::max(max_rad, followed.client.turns[slot][joint].angularDistance(turn));
        }
      }
    }
    CHECK(max_m < 3e-5);
    CHECK(max_rad < 1.75e-4);
    CHECK(max_rad > 1e-6); // it was measured
  }

  TEST_CASE("a glove of another hand size, in place of the first, is sent with its own bones") {
    StreamedLoop streamed(flow::Mode::type1, {.swapped_length_m = 0.15});
    Followed followed(streamed);
    for (const Side worn : {Side::right, Side::left}) { // on the right hand
      streamed.test.rings[1]->try_push(test::bent_sample(worn, 10, HostClock::now()));
      const auto& frame = streamed.test.frame_after_tick(worn == Side::right ? 0 : 1);
      followed.pass();
      CHECK(followed.client.other_bones[1] == (worn == Side::left));
      for (std::size_t joint = 0; joint < 26; ++joint) {
        const auto place = frame.hands[1].pose.joints[joint].translation();
        CHECK((followed.client.joints[1][joint] - place).norm() < 3e-5);
      }
    }
  }

  TEST_CASE("an ordinary frame of two hands takes hundreds of bytes, of several links, too") {
    for (const auto& way : ways) {
      CAPTURE(name_of(way.first));
      StreamedLoop streamed = loop_of(way);
      Followed followed(streamed);
      std::size_t most = 0;
      for (int tick = 0; tick < 60; ++tick) {
        streamed.tick(tick / 3);
        followed.pass();
        most = std::max(most, followed.client.update_bytes);
      }
      CHECK(most > 72 + 2 * 126);
      CHECK(most < 1000);
      const auto& chain = streamed.test.loop->frames().front().chain;
      const bool in_links = way.second && way.first == flow::Mode::type1;
      if (in_links) CHECK(chain.links > 1);
      if (in_links) CHECK(followed.client.implied_centres > 100);
    }
  }

  TEST_CASE(
      "through grabs, commits, undos and clutches, a follower has a puppet's shape at every "
      "tick, within 2e-6 of the diagonal, where it bakes within 1e-5, and gets weights and shapes "
      "only when it must") {
    for (const flow::Mode mode : {flow::Mode::type1, flow::Mode::type2}) {
      CAPTURE(name_of(mode));
      const bool bakes = mode == flow::Mode::type2;
      StreamedLoop streamed = puppet_loop(mode);
      Followed followed(streamed);
      const FollowingClient& client = followed.client;
      std::mt19937 random(21);
      int bent = 0;
      double worst = 0.0;
      double moved = 0.0;
      int compared = 0;
      std::size_t most = 0;
      for (int tick = 0; tick < 600; ++tick) {
        bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 40);
        if (random() % 25 == 0)
          streamed.test.commands.try_push(flow::requests[random() % flow::requests.size()]);
        if (random() % 25 == 0)
          streamed.test.commands.try_push(
              flow::SetClutch{random() % 2 == 0 ? Side::left : Side::right,
                              puppet::RigPlayer::all_fingers, random() % 2 == 0});
        const auto shape = streamed.tick(bent);
        moved = std::max(moved, (shape - streamed.test.model.vertices).cwiseAbs().maxCoeff());
        followed.pass();
        const flow::Frame& frame = streamed.test.loop->frames().front();
        CHECK(client.released == frame.released);
        CHECK(client.is_puppet);
        most = std::max(most, client.update_bytes);
        if (!followed.is_up_to_date()) continue;
        worst = std::max(worst, followed.gap(shape));
        ++compared;
      }
      CHECK(client.good);
      CHECK(worst < (bakes ? 1e-5 : 2e-6));
      CHECK(moved > 0.05); // of a ball of radius 1
      CHECK(compared > 500);
      CHECK(client.rest_changes > 3);
      CHECK(client.jumps > 3);
      CHECK(client.jumps < 100); // not one for each tick
      CHECK(client.vectors > 1000);
      CHECK(client.weights == 1);
      CHECK(client.shapes < static_cast<int>(client.jumps) + (bakes ? 10 : 3));
      CHECK(most < 1000);
    }
  }

  TEST_CASE("a puppet's follower gets other weights when radii, kernel or mode change, and has the "
            "shape then, too") {
    StreamedLoop streamed = puppet_loop(flow::Mode::type1);
    Followed followed(streamed);
    std::mt19937 random(22);
    int bent = 0;
    double worst = 0.0;
    int compared = 0;
    for (int tick = 0; tick < 1200; ++tick) {
      bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 40);
      if (random() % 20 == 0)
        static_cast<void>(streamed.test.loop->changes().change_settings(
            test::any_settings(streamed.test.loop->changes().settings(), random)));
      const auto shape = streamed.tick(bent);
      followed.pass();
      if (!followed.is_up_to_date()) continue;
      worst = std::max(worst, followed.gap(shape));
      ++compared;
    }
    CHECK(followed.client.good);
    CHECK(worst < 1e-5);
    CHECK(compared > 500);
    CHECK(followed.client.weights > 3);
    CHECK(static_cast<std::uint64_t>(followed.client.weights) <=
          streamed.test.loop->stats().changes + 1);
    CHECK(streamed.test.loop->stats().changes > 15);
  }

  TEST_CASE("a puppet's follower continues with each puppet that an edit or an undo brings") {
    for (const bool begins_with_one : {true, false}) {
      CAPTURE(begins_with_one);
      StreamedLoop streamed =
          begins_with_one ? puppet_loop(flow::Mode::type1) : StreamedLoop(flow::Mode::type1);
      Followed followed(streamed);
      std::mt19937 random(23);
      double worst = 0.0;
      int compared = 0, bent = 0;
      flow::DeformLoop& loop = *streamed.test.loop;
      for (int tick = 0; tick < 400; ++tick) {
        bent = std::clamp(bent + static_cast<int>(random() % 7) - 3, 0, 40);
        if (tick % 20 == 10)
          static_cast<void>(loop.changes().change_puppet(
              test::any_puppet(loop.changes().puppet(loop.changes().newest_puppet()),
                               streamed.test.model, random, 5)));
        if (tick % 60 == 40) streamed.test.commands.try_push(flow::Request::undo);
        const auto shape = streamed.tick(bent);
        if (const auto& awaited = loop.frames().front().awaited)
          static_cast<void>(loop.changes().change_to(*awaited));
        followed.pass();
        if (!followed.is_up_to_date()) continue;
        worst = std::max(worst, followed.gap(shape));
        ++compared;
      }
      CHECK(followed.client.good);
      CHECK(loop.changes().next_puppet() > 8);
      CHECK(worst < 1e-5);
      CHECK(compared > 250);
      CHECK(followed.client.weights > 3);
    }
  }

  TEST_CASE("a follower whose weights are late gets neither steps nor shapes until it has them") {
    StreamedLoop streamed = puppet_loop(flow::Mode::type1);
    Followed followed(streamed);
    followed.has_weights = false;
    for (int tick = 0; tick < 30; ++tick) {
      streamed.tick(tick);
      followed.pass();
    }
    CHECK(followed.client.updates > 20);
    CHECK(followed.client.vectors == 0);
    const int shapes = followed.client.shapes;
    CHECK(shapes <= 1);
    followed.has_weights = true;
    for (int tick = 30; tick < 40; ++tick) {
      const auto shape = streamed.tick(tick);
      followed.pass();
      if (followed.is_up_to_date()) CHECK(followed.gap(shape) < 2e-6);
    }
    CHECK(followed.is_up_to_date());
    CHECK(followed.client.shapes == shapes + 1);
    CHECK(followed.client.good);
  }

  TEST_CASE("the model's message has the mesh: its places, order and triangles") {
    const StreamedLoop streamed(flow::Mode::type1);
    const FollowingClient client(streamed.model);
    REQUIRE(client.good);
    const deform::Mesh& mesh = streamed.test.model;
    CHECK(client.name == "ball");
    REQUIRE(client.order.size() == static_cast<std::size_t>(mesh.vertices.cols()));
    double worst = 0.0;
    for (std::size_t at = 0; at < client.order.size(); ++at)
      for (std::size_t axis = 0; axis < 3; ++axis)
        worst = std::max(
            worst, std::abs(client.origin[axis] +
                            client.unit * static_cast<double>(client.rest[3 * at + axis]) -
                            mesh.vertices(static_cast<Eigen::Index>(axis), client.order[at])));
    CHECK(worst < 1e-6);
    double volume = 0.0; // of the closed surface, by its triangles
    for (std::size_t at = 0; at < client.corners.size(); at += 3) {
      const auto corner = [&](std::size_t n) -> Eigen::Vector3d {
        return mesh.vertices.col(client.order[client.corners[at + n]]);
      };
      volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
    }
    CHECK(volume > 3.9); // a ball's, 4.19, less what flat triangles cut off
    CHECK(volume < 4.19);
  }
}

} // namespace follow_test
