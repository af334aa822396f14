#pragma once
// Counts what an OBJ has and a mesh cannot keep.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace nendo::deform {

class ObjLeftOut {
public:
  /// Counts a statement that is not read. Known ones that change no polygon, such as vn and s, do
  /// not count.
  void statement(std::string_view keyword, std::size_t line);
  void weight(double w) noexcept { weights_ += w != 1.0 ? 1 : 0; }

  /// One note for each kind.
  void add_to(std::vector<std::string>& notes) const;

private:
  std::size_t lines_ = 0, points_ = 0, curves_ = 0, weights_ = 0;
  std::size_t unknown_ = 0, first_unknown_line_ = 0;
  std::string first_unknown_;
};

} // namespace nendo::deform
