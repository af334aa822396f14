#include "takes/glove_samples.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

#include <nendo/driver/open_glove.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::takes {
namespace {

bool is_of_simulated(std::string_view source) {
  const auto spec = driver::parse_glove_spec(source);
  return spec && spec->kind == "sim";
}

/// Recognises it by the source of a glove's samples, because a recording keeps no more of that.
bool was_simulated(const driver::GloveInfo& glove) {
  return is_of_simulated(glove.source) ||
         std::any_of(glove.facts.begin(), glove.facts.end(), [](const auto& fact) {
           return fact.name == "recorded_from" && is_of_simulated(fact.value);
         });
}

} // namespace

bool is_calibrated(const recording::Setup& setup, std::size_t glove) {
  const flow::HandInput& hand = setup.hands[glove];
  if (hand.wearer.adapt) return true;
  if (glove >= setup.gloves.size()) return false; // its description is damaged
  const driver::GloveInfo& info = setup.gloves[glove];
  return was_simulated(info) ||
         !(hand.wearer.of(hand.first.side).calibration == hand::default_calibration(info.counts));
}

std::optional<bool> is_calibrated(const recording::Setup& setup, Side side) {
  for (std::size_t glove = 0; glove < setup.hands.size(); ++glove)
    if (setup.hands[glove].side == side) return is_calibrated(setup, glove);
  return std::nullopt;
}

Result<GloveSamples> GloveSamples::open(const std::filesystem::path& path) {
  auto reader = recording::TakeReader::open(path);
  if (!reader) return reader.error();
  return GloveSamples(*std::move(reader));
}

GloveSamples::GloveSamples(recording::TakeReader reader) : reader_(std::move(reader)) {
  const recording::Setup& setup = reader_.setup();
  for (std::size_t glove = 0; glove < setup.hands.size(); ++glove)
    gloves_.push_back(
        {hand::ActiveCalibration(setup.hands[glove].wearer), takes::is_calibrated(setup, glove)});
}

SensorMask GloveSamples::sensors() const {
  SensorMask sensors;
  for (const auto& glove : reader_.setup().gloves)
    sensors.bits |= glove.sensors.bits;
  for (const auto& hand : reader_.setup().hands)
    sensors.bits |= hand.first.present.bits;
  return sensors;
}

bool GloveSamples::next() {
  while (const auto entry = reader_.next()) {
    if (std::holds_alternative<recording::Gap>(*entry)) exact_ = false;
    const auto* const recorded = std::get_if<recording::RecordedSample>(&*entry);
    if (recorded == nullptr) continue;
    sample_ = recorded->sample;
    glove_ = recorded->glove;
    calibration_ = glove_ < gloves_.size() ? &gloves_[glove_].calibration.follow(sample_) : nullptr;
    return true;
  }
  return false;
}

} // namespace nendo::takes
