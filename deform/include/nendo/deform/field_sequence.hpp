#pragma once
// The fields that a tick applied to a shape, in order. Applying them to a copy of the model, on a
// GPU or another machine, gives the same shape.

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

class FieldSequence {
public:
  FieldSequence() = default;
  /// Allocates `max_fields` fields of the size of `like`. The other functions do not allocate
  /// for fields of that size.
  FieldSequence(std::size_t max_fields, const CsrbfField& like) : fields_(max_fields, like) {}

  void clear() noexcept { used_ = 0; }
  /// Appends a field. The sequence must have fewer than capacity() fields.
  void push(const CsrbfField& field) noexcept {
    assert(used_ < fields_.size());
    fields_[used_++] = field;
  }
  /// Copies `other`, which must have at most capacity() fields.
  void follow(const FieldSequence& other) noexcept {
    clear();
    for (const CsrbfField& field : other.fields())
      push(field);
  }

  /// Returns the fields in the order of their application.
  std::span<const CsrbfField> fields() const noexcept { return {fields_.data(), used_}; }
  /// Returns the largest number of fields.
  std::size_t capacity() const noexcept { return fields_.size(); }
  /// Returns whether follow() can copy any content of `other` without allocating.
  bool can_hold_fields_of(const FieldSequence& other) const noexcept {
    return capacity() >= other.capacity() &&
           (other.capacity() == 0 || fields_[0].centres.cols() == other.fields_[0].centres.cols());
  }

private:
  std::vector<CsrbfField> fields_;
  std::size_t used_ = 0;
};

} // namespace nendo::deform
