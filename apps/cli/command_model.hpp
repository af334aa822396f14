#pragma once
// A description of a command and its options in plain data. --help, manual pages and completions
// are made of it, so they cannot disagree.

#include <string>
#include <vector>

namespace nendo::cli {

struct OptionModel {
  std::vector<std::string> names;   ///< "-i", "--interval"; a positional argument has one: "GLOVE"
  std::string value;                ///< what its value is: "TEXT"; empty: a flag
  std::vector<std::string> choices; ///< the values that there are; empty: any
  std::string default_value;
  std::string summary;
  std::string heading; ///< under which --help shows it; empty: "Options"
  bool required = false;
  bool repeats = false;

  bool is_positional() const { return !names.front().starts_with('-'); }
};

struct CommandModel {
  std::string name;    ///< its own: "bind"
  std::string summary; ///< one line; of the program, further lines
  std::string footer;  ///< the text after the options
  std::vector<OptionModel> options;
  std::vector<CommandModel> commands; ///< hidden ones left out
};

} // namespace nendo::cli
