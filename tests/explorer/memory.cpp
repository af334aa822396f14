#include "explorer/memory.hpp"

#include <algorithm>
#include <cassert>

namespace nendo::explorer {
namespace {

using Kind = Operation::Kind;

constexpr std::uint64_t stamp_gap = std::uint64_t{1} << 40U;

bool acquires(std::memory_order order) {
  return order == std::memory_order_acquire || order == std::memory_order_acq_rel;
}
bool releases(std::memory_order order) {
  return order == std::memory_order_release || order == std::memory_order_acq_rel;
}

} // namespace

void View::join(const View& other) {
  for (std::size_t n = 0; n < seen.size(); ++n)
    seen[n] = std::max(seen[n], other.seen[n]);
  for (std::size_t n = 0; n < happened.size(); ++n)
    happened[n] = std::max(happened[n], other.happened[n]);
}

void Memory::spawn(std::size_t threads) {
  assert(threads < max_threads);
  spawned_ = threads;
  for (std::size_t n = 1; n <= threads; ++n)
    threads_[n].now = threads_[0].now;
}

void Memory::join_all() {
  for (std::size_t n = 1; n <= spawned_; ++n)
    threads_[0].now.join(threads_[n].now);
}

std::size_t Memory::new_location(Value initial) {
  assert(locations_.size() < max_locations);
  locations_.push_back({Message{initial, stamp_gap, false, {}}});
  return locations_.size() - 1;
}

Value Memory::apply(std::size_t thread, const Operation& operation, const Choose& choose) {
  if (operation.order == std::memory_order_seq_cst) fault_ = "seq_cst is not modelled";
  Location& messages = locations_[operation.location];
  Thread& self = threads_[thread];
  const bool updates = operation.kind == Kind::exchange || operation.kind == Kind::add;
  const bool reads = updates || operation.kind == Kind::load;

  // What it reads, or what it is put behind: nothing older than what the thread knows of.
  std::vector<std::size_t> allowed;
  for (std::size_t at = messages.size(); at-- > 0;) {
    if (messages[at].stamp < self.now.seen[operation.location]) break;
    const bool followed = at + 1 < messages.size() && messages[at + 1].of_update;
    if (operation.kind == Kind::load || !followed) allowed.push_back(at);
  }
  const std::size_t at = allowed[choose(allowed.size())];
  ++self.now.happened[thread];
  self.now.seen[operation.location] = messages[at].stamp;
  const Value read = messages[at].value;
  if (reads) (acquires(operation.order) ? self.now : self.to_acquire).join(messages[at].released);
  if (operation.kind == Kind::load) return read;

  Message message;
  message.value = operation.kind == Kind::add ? read + operation.value : operation.value;
  message.of_update = updates;
  const bool last = at + 1 == messages.size();
  const std::uint64_t next = last ? messages[at].stamp + 2 * stamp_gap : messages[at + 1].stamp;
  message.stamp = messages[at].stamp + (next - messages[at].stamp) / 2;
  assert(message.stamp != messages[at].stamp);
  self.now.seen[operation.location] = message.stamp;
  message.released = releases(operation.order) ? self.now : self.released;
  if (updates) message.released.join(messages[at].released); // the release sequence continues
  messages.insert(messages.begin() + static_cast<std::ptrdiff_t>(at) + 1, message);
  return read;
}

void Memory::fence(std::size_t thread, std::memory_order order) {
  if (order == std::memory_order_seq_cst) fault_ = "seq_cst is not modelled";
  Thread& self = threads_[thread];
  if (acquires(order)) self.now.join(self.to_acquire);
  if (releases(order)) self.released = self.now;
}

std::size_t Memory::new_plain(std::size_t thread) {
  plains_.push_back({});
  access(thread, plains_.size() - 1, Access::write);
  return plains_.size() - 1;
}

void Memory::access(std::size_t thread, std::size_t plain, Access access) {
  View& now = threads_[thread].now;
  Plain& self = plains_[plain];
  bool ordered = self.written <= now.happened[self.writer];
  if (access == Access::write) {
    for (std::size_t n = 0; n < max_threads; ++n)
      ordered = ordered && self.read[n] <= now.happened[n];
  }
  if (!ordered && fault_.empty()) {
    fault_ = std::string("data race: thread ") + std::to_string(thread) +
             (access == Access::write ? " writes" : " reads") + " plain object " +
             std::to_string(plain);
  }
  const std::uint32_t step = ++now.happened[thread];
  if (access == Access::write) {
    self.writer = thread;
    self.written = step;
  } else {
    self.read[thread] = step;
  }
}

} // namespace nendo::explorer
