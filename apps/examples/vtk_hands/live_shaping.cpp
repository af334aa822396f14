#include "live_shaping.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include <nendo/hand/calibration_store.hpp>
#include <nendo/recording/replay_driver.hpp>

namespace vtk_hands {

using namespace nendo;

namespace {

/// The hand that a person has calibrated for this glove, or an average one.
hand::Wearer wearer_of(const driver::GloveInfo& glove) {
  hand::Wearer wearer;
  if (glove.kind != driver::GloveKind::device) return wearer;
  std::string serial;
  for (const driver::GloveFact& fact : glove.facts)
    if (fact.name == "serial") serial = fact.value;
  const auto stored = hand::list_calibrations(hand::calibration_folders());
  for (const Side side : {Side::left, Side::right}) {
    const auto choice = hand::choose_calibration(
        stored.files, {"", glove.model, side == glove.side ? serial : "", side, glove.counts});
    if (!choice) continue;
    const hand::WearerCalibration& known = choice->file->wearer;
    wearer.of(side) = {hand::calibration_for(known, glove.counts), known.size};
  }
  return wearer;
}

} // namespace

// A glove with its ring, from which the loop drinks, and its first sample.
struct LiveShaping::Hand {
  SampleRing ring{1024};
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;
};

Result<std::unique_ptr<LiveShaping::Hand>> LiveShaping::open(const std::string& glove, Side side) {
  constexpr std::chrono::seconds patience(5);
  auto opened = driver::open_glove(glove, side, {.drivers = {recording::replay_driver()}});
  if (!opened) return opened.error();
  auto hand = std::make_unique<Hand>();
  hand->glove = *std::move(opened);
  if (const auto started = hand->glove->start(hand->ring); !started) return started.error();
  const auto latest = std::chrono::steady_clock::now() + patience;
  while (!hand->ring.try_pop(hand->first)) {
    if (std::chrono::steady_clock::now() > latest) {
      hand->glove->stop();
      return Error{Errc::no_device, glove + ": no sample came; is the glove worn and switched on?"};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return hand;
}

Result<std::unique_ptr<LiveShaping>> LiveShaping::begin(const deform::Mesh& model,
                                                        const ShapingOptions& options) {
  std::unique_ptr<LiveShaping> shaping(new LiveShaping);
  std::array<std::optional<flow::Fingertips>, 2> tips;
  std::vector<flow::HandInput> inputs;
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    if (options.gloves.at(slot).empty()) continue;
    auto hand = open(options.gloves.at(slot), side);
    if (!hand) return hand.error();
    const flow::HandInput input{&(*hand)->ring, side, wearer_of((*hand)->glove->info()),
                                (*hand)->first};
    const Side glove = input.first.side;
    tips.at(slot) = input.skeleton(glove)
                        .pose(hand::joint_angles(input.first, input.wearer.of(glove).calibration),
                              Eigen::Isometry3d::Identity())
                        .fingertip_positions();
    inputs.push_back(input);
    shaping->hands_.push_back(*std::move(hand));
  }
  constexpr double reach = 0.2; // of the model's longest side
  const auto box = deform::finite_box_of(model.vertices);
  const double longest = (box.highest - box.lowest).maxCoeff();
  flow::LoopOptions loop;
  loop.sculptor.mode = options.mode;
  loop.sculptor.piece_length = 0.1 * reach * longest;
  loop.sculptor.deformer.supports = deform::one_radius(reach * longest);
  shaping->loop_ = std::make_unique<flow::DeformLoop>(model, flow::place_hands(model, tips),
                                                      std::move(inputs), loop);
  shaping->thread_ =
      std::thread([&running = *shaping->loop_, &over = shaping->over_] { running.run(over); });
  return shaping;
}

LiveShaping::~LiveShaping() {
  over_ = true;
  if (thread_.joinable()) thread_.join();
  for (auto& hand : hands_)
    hand->glove->stop();
}

bool LiveShaping::has_ended() const noexcept {
  return std::all_of(hands_.begin(), hands_.end(),
                     [](const auto& hand) { return hand->glove->has_ended(); });
}

} // namespace vtk_hands
