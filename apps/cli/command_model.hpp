#pragma once
// A description of a command and its options as plain data. --help, manual pages and completions
// are generated from it, so they agree.

#include <string>
#include <vector>

namespace nendo::cli {

struct OptionModel {
  std::vector<std::string> names;   ///< "-i", "--interval"; a positional argument has one: "GLOVE"
  std::string value;                ///< the type of its value: "TEXT"; empty: a flag
  std::vector<std::string> choices; ///< the valid values; empty: any
  std::string default_value;
  std::string summary;
  std::string heading; ///< its heading in --help; empty: "Options"
  bool required = false;
  bool repeats = false;

  bool is_positional() const { return !names.front().starts_with('-'); }
};

struct CommandModel {
  std::string name;    ///< without those of parents: "bind"
  std::string summary; ///< one line; for the program, several
  std::string footer;  ///< the text after the options
  std::vector<OptionModel> options;
  std::vector<CommandModel> commands; ///< hidden ones left out
};

} // namespace nendo::cli
