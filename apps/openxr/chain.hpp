#pragma once
// Chains of OpenXR's structures, which are linked by their members `next`.

#include <openxr/openxr.h>

namespace nendo::openxr {

/// Returns the first structure of this type in a chain, or null.
template <class T>
const T* in_chain(const void* next, XrStructureType type) noexcept {
  for (auto* at = static_cast<const XrBaseInStructure*>(next); at != nullptr; at = at->next)
    if (at->type == type) return reinterpret_cast<const T*>(at);
  return nullptr;
}
template <class T>
T* in_chain(void* next, XrStructureType type) noexcept {
  return const_cast<T*>(in_chain<T>(static_cast<const void*>(next), type));
}

/// Hides the first structure of a type from the chain of an output structure while this object
/// lives. A runtime without an extension ignores its structures, but layers that validate complain.
template <class Head>
class HiddenInChain {
public:
  /// With `hides` false, does nothing.
  HiddenInChain(Head& head, XrStructureType type, bool hides) noexcept {
    if (!hides) return;
    auto* before = reinterpret_cast<XrBaseOutStructure*>(&head);
    while (before->next != nullptr && before->next->type != type)
      before = before->next;
    if (before->next == nullptr) return;
    before_ = before;
    hidden_ = before->next;
    before->next = hidden_->next;
  }
  ~HiddenInChain() noexcept {
    if (before_ != nullptr) before_->next = hidden_;
  }
  HiddenInChain(const HiddenInChain&) = delete;
  HiddenInChain& operator=(const HiddenInChain&) = delete;

private:
  XrBaseOutStructure* before_ = nullptr;
  XrBaseOutStructure* hidden_ = nullptr;
};

/// Returns a chain of input structures without structures of this type at its beginning. One that
/// follows others stays, because those are constant and of unknown size.
inline const void* without_first(const void* next, XrStructureType type, bool hides) noexcept {
  auto* at = static_cast<const XrBaseInStructure*>(next);
  while (hides && at != nullptr && at->type == type)
    at = at->next;
  return at;
}

} // namespace nendo::openxr
