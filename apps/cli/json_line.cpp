#include "cli/json_line.hpp"

#include <iostream>

#include <nlohmann/json.hpp>

namespace nendo::cli {

std::string json_text(const nlohmann::ordered_json& object) {
  return object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void print_line(const nlohmann::ordered_json& object) {
  std::cout << json_text(object) << std::endl;
}

} // namespace nendo::cli
