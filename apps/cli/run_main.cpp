#include "cli/run_main.hpp"

#include <exception>
#include <iostream>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::cli {
namespace {

std::string_view own_name = "nendo";

} // namespace

std::string_view program_name() noexcept {
  return own_name;
}

int run_main(std::string_view name, const std::function<int()>& run) {
  own_name = name;
  try {
    return run();
  } catch (const std::exception& error) { // out of memory, mostly
    std::cerr << name << ": " << error.what() << '\n';
    return static_cast<int>(Errc::failed);
  }
}

int run_program_with(std::string command, int argc, char** argv, const std::string& summary,
                     const std::function<void(Command&)>& add_commands) {
  std::vector<char*> arguments(argv, argv + argc);
  if (!command.empty()) arguments.insert(arguments.begin() + 1, command.data());
  const auto count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  return run_program(count, arguments.data(), summary, add_commands);
}

} // namespace nendo::cli
