#include "manual/model_json.hpp"

#include <nlohmann/json.hpp>

namespace nendo::cli { // where the JSON library looks for them

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OptionModel, names, value, choices, default_value, summary,
                                   heading, required, repeats)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CommandModel, name, summary, footer, options, commands)

} // namespace nendo::cli

namespace nendo::manual {

std::string model_json(const cli::CommandModel& command) {
  return nlohmann::json(command).dump();
}

Result<cli::CommandModel> parse_model(const std::string& json) {
  try {
    return nlohmann::json::parse(json).get<cli::CommandModel>();
  } catch (const nlohmann::json::exception& error) {
    return Error{Errc::bad_input, std::string("not the description of a command: ") + error.what()};
  }
}

} // namespace nendo::manual
