#include "line/fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace nendo::emulator {
namespace {

constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

} // namespace

FaultInjector::FaultInjector(const std::vector<Fault>& faults, std::uint32_t seed) : random_(seed) {
  for (Chance& chance : chances_)
    chance.misses = never;
  for (const Fault& fault : faults) {
    if (fault.rate > 0.0) {
      chance(fault.kind) = {fault.rate, draw_misses(fault.rate)};
      continue;
    }
    schedule_.push_back({fault.at, {fault, false}});
    const bool ends = fault.kind == FaultKind::eg || fault.kind == FaultKind::swap ||
                      fault.kind == FaultKind::press ||
                      (fault.kind == FaultKind::stick && fault.lasting > Time{});
    if (ends) schedule_.push_back({fault.at + fault.lasting, {fault, true}});
    if (fault.kind == FaultKind::silence) silences_.push_back(fault);
  }
  std::stable_sort(schedule_.begin(), schedule_.end(),
                   [](const Due& a, const Due& b) { return a.at < b.at; });
  std::reverse(schedule_.begin(), schedule_.end());
}

std::optional<FaultInjector::Time> FaultInjector::next_due() const noexcept {
  if (schedule_.empty()) return std::nullopt;
  return schedule_.back().at;
}

std::optional<FaultInjector::Event> FaultInjector::next_event(Time now) {
  if (schedule_.empty() || schedule_.back().at > now) return std::nullopt;
  Event event = std::move(schedule_.back().event);
  schedule_.pop_back();
  if (!event.over) count(event.fault.kind);
  return event;
}

// Draws from the geometric distribution by its inverse. The standard library's distribution gives
// other numbers with each implementation.
std::uint64_t FaultInjector::draw_misses(double rate) {
  if (rate >= 1.0) return 0;
  const double uniform = static_cast<double>(random_() >> 11U) * 0x1p-53; // 0 <= uniform < 1
  const double misses = std::floor(std::log1p(-uniform) / std::log1p(-rate));
  return misses < 1e18 ? static_cast<std::uint64_t>(misses) : never;
}

bool FaultInjector::strikes(FaultKind kind) {
  Chance& chance = this->chance(kind);
  if (chance.misses == never) return false;
  if (chance.misses > 0) {
    --chance.misses;
    return false;
  }
  chance.misses = draw_misses(chance.rate);
  count(kind);
  return true;
}

bool FaultInjector::silent(Time now) const noexcept {
  return std::any_of(silences_.begin(), silences_.end(), [now](const Fault& fault) {
    return now >= fault.at && now < fault.at + fault.lasting;
  });
}

void FaultInjector::pass(std::span<const std::byte> message, bool record, Time now, Wire& wire) {
  bool touched = true;
  const bool swallowed = silent(now) || (record && strikes(FaultKind::lose));
  if (!swallowed) {
    touched = std::exchange(joined_, false);
    if (record && strikes(FaultKind::burst)) {
      constexpr std::uint64_t max_bytes = 64;
      for (std::uint64_t left = 1 + random_() % max_bytes; left > 0; --left)
        wire.push_back(random_byte());
      touched = true;
    }
    touched |= pass_noisy(message, wire);
  }
  if (!record) return;
  ++records_;
  if (touched) ++records_faulted_;
}

// Passes a message through the noise. Returns whether a fault touched it.
bool FaultInjector::pass_noisy(std::span<const std::byte> message, Wire& wire) {
  constexpr std::array kinds{FaultKind::drop, FaultKind::flip, FaultKind::insert};
  const std::uint64_t size = message.size();
  if (std::all_of(kinds.begin(), kinds.end(),
                  [&](FaultKind kind) { return chance(kind).misses >= size; })) {
    for (const FaultKind kind : kinds) {
      if (chance(kind).misses != never) chance(kind).misses -= size;
    }
    wire.insert(wire.end(), message.begin(), message.end());
    return false;
  }
  for (std::size_t k = 0; k < message.size(); ++k) {
    const bool inserted = strikes(FaultKind::insert);
    const bool dropped = strikes(FaultKind::drop);
    const bool flipped = strikes(FaultKind::flip);
    if (inserted) wire.push_back(random_byte());
    const auto bit = flipped ? std::byte{1} << static_cast<int>(random_() % 8) : std::byte{0};
    if (!dropped) wire.push_back(message[k] ^ bit);
    if (k + 1 == message.size()) joined_ = dropped || flipped;
  }
  return true;
}

void FaultInjector::pass_junk(Wire& wire) {
  using namespace std::string_view_literals;
  constexpr auto junk = "AT\r\r\nAT+GCAP\r\r\ne?\0e?\0ATI\r"sv;
  for (const char c : junk)
    wire.push_back(static_cast<std::byte>(c));
  joined_ = true;
}

} // namespace nendo::emulator
