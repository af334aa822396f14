#pragma once
// What a parser finds in a stream besides records. A parser's push() hands each finding to its sink
// in the order of the stream; a sink that does not take a kind of finding is not told of it.

#include <type_traits>

namespace nendo::driver {

/// A frame that was no good record, or one that a check refused.
struct BadRecord {};

/// A whole record that says that no glove is plugged in.
struct Unplugged {};

/// Calls `sink(finding)` if the sink takes findings of this kind.
template <class Sink, class Finding>
void report(Sink& sink, const Finding& finding) {
  if constexpr (std::is_invocable_v<Sink&, const Finding&>) sink(finding);
}

/// Makes one sink of several functions, one a kind of finding.
template <class... Functions>
struct FindingSink : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
FindingSink(Functions...) -> FindingSink<Functions...>;

} // namespace nendo::driver
