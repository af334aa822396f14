#pragma once
// nendo bench calibration --judge: what the judge found, as text.

#include <string>

namespace nendo::bench::judge_bench {

struct Output {
  bool json = false;
  bool markdown = false;
  bool floor = false; ///< judges the floor; the wearers must be strangers
};

/// Judges the calibration of every wearer of a file, and prints the table. Returns the exit code.
int judge_file(const std::string& path, const Output& output);

} // namespace nendo::bench::judge_bench
