#include "files/gltf_morphs.hpp"

#include <algorithm>

#include "geometry/usable.hpp"

namespace nendo::deform {

namespace {

std::vector<double> weights_in(const GltfDocument::Json& item) {
  std::vector<double> weights;
  const GltfDocument::Json* const list = gltf_member(item, "weights");
  if (list == nullptr || !list->is_array()) return weights;
  for (const GltfDocument::Json& number : *list) {
    if (!number.is_number() || !is_usable(number.get<double>()))
      throw GltfRefusal{"a weight of a morph target is not a finite number"};
    weights.push_back(number.get<double>());
  }
  return weights;
}

} // namespace

std::vector<double> default_weights(const GltfDocument::Json& node,
                                    const GltfDocument::Json& mesh) {
  const bool has_own = gltf_member(node, "weights") != nullptr;
  auto weights = weights_in(has_own ? node : mesh);
  if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0.0; }))
    weights.clear();
  return weights;
}

std::size_t apply_targets(const GltfDocument& document, const GltfDocument::Json& primitive,
                          const std::vector<double>& weights, GltfNumbers& places) {
  const GltfDocument::Json* const targets = gltf_member(primitive, "targets");
  if (targets == nullptr || !targets->is_array()) return 0;
  std::size_t read = 0;
  for (std::size_t at = 0; at < std::min(weights.size(), targets->size()); ++at) {
    const GltfDocument::Json& target = (*targets)[at];
    if (weights[at] == 0.0 || gltf_member(target, "POSITION") == nullptr) continue;
    const GltfNumbers moved = document.numbers(gltf_count(target, "POSITION", 0));
    if (moved.width != 3 || moved.count != places.count)
      throw GltfRefusal{"a morph target is of another size than its vertices"};
    read += moved.count;
    for (std::size_t k = 0; k < places.values.size(); ++k)
      places.values[k] += weights[at] * moved.values[k];
  }
  return read;
}

} // namespace nendo::deform
