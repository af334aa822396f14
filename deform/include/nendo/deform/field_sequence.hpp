#pragma once
// The fields that a tick applied to a shape, one after another. A copy of the model elsewhere, on a
// GPU or on another machine, becomes the same by applying them.

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

class FieldSequence {
public:
  FieldSequence() = default;
  /// Allocates `most` fields of the size of `like`. The other functions do not allocate
  /// for fields of that size.
  FieldSequence(std::size_t most, const CsrbfField& like) : fields_(most, like) {}

  void clear() noexcept { used_ = 0; }
  /// Appends a field; fewer than capacity() must be there.
  void push(const CsrbfField& field) noexcept {
    assert(used_ < fields_.size());
    fields_[used_++] = field;
  }
  /// Copies `other`, which may have no more fields than capacity().
  void follow(const FieldSequence& other) noexcept {
    clear();
    for (const CsrbfField& field : other.fields())
      push(field);
  }

  /// Returns the fields in the order in which they are to be applied.
  std::span<const CsrbfField> fields() const noexcept { return {fields_.data(), used_}; }
  /// Returns the largest number of fields.
  std::size_t capacity() const noexcept { return fields_.size(); }
  /// Returns whether follow() copies any fields of such a sequence without allocating.
  bool can_hold_fields_of(const FieldSequence& other) const noexcept {
    return capacity() >= other.capacity() &&
           (other.capacity() == 0 || fields_[0].centres.cols() == other.fields_[0].centres.cols());
  }

private:
  std::vector<CsrbfField> fields_;
  std::size_t used_ = 0;
};

} // namespace nendo::deform
