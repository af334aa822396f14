#include <nendo/flow/hand_input.hpp>

#include <algorithm>
#include <string>

#include <nendo/flow/input_script.hpp>

namespace nendo::flow {

Result<void> check_inputs(std::span<const HandInput> inputs) {
  if (inputs.empty() || inputs.size() > max_inputs)
    return Error{Errc::bad_input, std::to_string(inputs.size()) + " inputs of a loop: use 1 to " +
                                      std::to_string(max_inputs)};
  for (auto input = inputs.begin(); input != inputs.end(); ++input)
    if (!input->layer && std::any_of(inputs.begin(), input, [&](const HandInput& before) {
          return before.side == input->side;
        }))
      return Error{Errc::bad_input,
                   "input " + std::to_string(input - inputs.begin()) + " of a loop: the " +
                       std::string(name_of(input->side)) +
                       " hand has an input before; make this a layer, or leave it out"};
  return {};
}

std::size_t count_hands(std::span<const HandInput> inputs) noexcept {
  const bool has_other = std::any_of(inputs.begin(), inputs.end(), [&](const HandInput& input) {
    return input.side != inputs.front().side;
  });
  return inputs.empty() ? 0 : 1 + static_cast<std::size_t>(has_other);
}

} // namespace nendo::flow
