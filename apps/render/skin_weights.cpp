#include "render/skin_weights.hpp"

#include <algorithm>
#include <limits>

namespace nendo::render {

using Eigen::Vector3f;
using hand::Joint;

namespace {

using Weights = std::array<float, hand::joint_count>;

// Steps of spreading. Each widens a transition by about the square root of half an edge's square.
constexpr int steps_everywhere = 7;
constexpr int steps_in_palm = 40; // where flesh is thick, and follows farther away

struct Nearest {
  float distance = std::numeric_limits<float>::max();
  const FleshPart* part = nullptr;
};

void seek(const std::vector<FleshPart>& parts, const Vector3f& place, Nearest& nearest) {
  for (const FleshPart& part : parts) {
    const float distance = distance_to(part, place);
    if (distance < nearest.distance) nearest = {distance, &part};
  }
}

void spread(const std::vector<std::vector<std::uint32_t>>& beside, const std::vector<float>& pace,
            std::vector<Weights>& weights) {
  const std::vector<Weights> before = weights;
  for (std::size_t at = 0; at < weights.size(); ++at) {
    if (!(pace[at] > 0.0F) || beside[at].empty()) continue;
    Weights sum{};
    for (const std::uint32_t other : beside[at])
      for (std::size_t joint = 0; joint < sum.size(); ++joint)
        sum[joint] += before[other][joint];
    const float share = 0.5F * pace[at] / static_cast<float>(beside[at].size());
    for (std::size_t joint = 0; joint < sum.size(); ++joint)
      weights[at][joint] = (1.0F - 0.5F * pace[at]) * before[at][joint] + share * sum[joint];
  }
}

// Of the weights of a place, the four strongest.
SkinInfluence strongest(const Weights& weights) {
  std::array<std::size_t, hand::joint_count> order;
  for (std::size_t joint = 0; joint < order.size(); ++joint)
    order[joint] = joint;
  std::partial_sort(order.begin(), order.begin() + 4, order.end(),
                    [&](std::size_t a, std::size_t b) {
                      return weights[a] != weights[b] ? weights[a] > weights[b] : a < b;
                    });
  SkinInfluence influence;
  float sum = 0.0F;
  for (std::size_t rank = 0; rank < 4; ++rank) {
    influence.joints[rank] = static_cast<Joint>(order[rank]);
    influence.weights[rank] = weights[order[rank]];
    sum += influence.weights[rank];
  }
  for (float& weight : influence.weights)
    weight /= sum;
  return influence;
}

// Leaves four joints at each place. To leave others out makes steps; these are evened out again.
void keep_strongest(const std::vector<std::vector<std::uint32_t>>& beside,
                    const std::vector<float>& pace, std::vector<Weights>& weights) {
  for (int round = 0; round < 6; ++round) {
    if (round > 0) spread(beside, pace, weights);
    for (Weights& of_place : weights) {
      const SkinInfluence influence = strongest(of_place);
      of_place.fill(0.0F);
      for (std::size_t rank = 0; rank < 4; ++rank)
        of_place[hand::index_of(influence.joints[rank])] = influence.weights[rank];
    }
  }
}

} // namespace

std::vector<SkinInfluence> weights_of(const HandFlesh& flesh, const SkinMesh& mesh) {
  std::vector<Weights> weights(mesh.places.size(), Weights{});
  std::vector<float> in_palm(mesh.places.size(), 0.0F);
  for (std::size_t at = 0; at < mesh.places.size(); ++at) {
    Nearest in_finger;
    for (const auto& parts : flesh.fingers())
      seek(parts, mesh.places[at], in_finger);
    Nearest nearest;
    seek(flesh.palm(), mesh.places[at], nearest);
    constexpr float ramp_m = 0.008F;
    in_palm[at] = std::clamp(0.5F + (in_finger.distance - nearest.distance) / ramp_m, 0.0F, 1.0F);
    if (in_finger.distance < nearest.distance) nearest = in_finger;
    const float along = share_along(*nearest.part, mesh.places[at]);
    weights[at][hand::index_of(nearest.part->carriers[0])] += 1.0F - along;
    weights[at][hand::index_of(nearest.part->carriers[1])] += along;
  }
  const auto beside = neighbours_in(mesh);
  for (int step = 0; step < steps_in_palm; ++step)
    spread(beside, in_palm, weights);
  const std::vector<float> everywhere(mesh.places.size(), 1.0F);
  for (int step = 0; step < steps_everywhere; ++step)
    spread(beside, everywhere, weights);
  keep_strongest(beside, everywhere, weights);
  std::vector<SkinInfluence> influences;
  influences.reserve(weights.size());
  for (const Weights& of_place : weights)
    influences.push_back(strongest(of_place));
  return influences;
}

} // namespace nendo::render
