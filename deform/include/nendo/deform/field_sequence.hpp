#pragma once
// Fields that a shape goes through one after another: what a copy of the model elsewhere, on a GPU
// or another machine, needs to become the same.

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

class FieldSequence {
public:
  FieldSequence() = default;
  /// Allocates for `most` fields of the size of `like`; nothing does afterwards, for such fields.
  FieldSequence(std::size_t most, const CsrbfField& like) : fields_(most, like) {}

  void clear() noexcept { used_ = 0; }
  void push(const CsrbfField& field) noexcept {
    assert(used_ < fields_.size());
    fields_[used_++] = field;
  }
  /// Becomes equal to `other`, which has no more fields than there is room for.
  void follow(const FieldSequence& other) noexcept {
    clear();
    for (const CsrbfField& field : other.fields())
      push(field);
  }

  /// First to last.
  std::span<const CsrbfField> fields() const noexcept { return {fields_.data(), used_}; }
  std::size_t room() const noexcept { return fields_.size(); }

private:
  std::vector<CsrbfField> fields_;
  std::size_t used_ = 0;
};

} // namespace nendo::deform
