#include <nendo/flow/hand_input.hpp>

#include <algorithm>

#include <nendo/flow/input_script.hpp>

namespace nendo::flow {

bool are_usable(std::span<const HandInput> inputs) noexcept {
  for (auto input = inputs.begin(); input != inputs.end(); ++input)
    if (!input->layer && std::any_of(inputs.begin(), input, [&](const HandInput& before) {
          return before.side == input->side;
        }))
      return false;
  return !inputs.empty() && inputs.size() <= most_inputs;
}

std::size_t count_hands(std::span<const HandInput> inputs) noexcept {
  const bool has_other = std::any_of(inputs.begin(), inputs.end(), [&](const HandInput& input) {
    return input.side != inputs.front().side;
  });
  return inputs.empty() ? 0 : 1 + static_cast<std::size_t>(has_other);
}

} // namespace nendo::flow
