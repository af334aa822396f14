#include "gloves/screen_text.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include <nendo/driver/record_counts.hpp>

namespace nendo::gloves {
namespace {

/// Returns a number in few characters, so that the text behind it stays on the line.
std::string short_number(std::uint64_t number) {
  if (number < 100'000) return std::to_string(number);
  if (number < 100'000'000) return std::to_string(number / 1000) + "k";
  return std::to_string(number / 1'000'000) + "M";
}

// Losses on the line and losses in the program have names of their own, as everywhere.
std::string losses(double asked_hz, const driver::StreamStats& stats) {
  const driver::RecordCounts counts = driver::counts_of(stats);
  std::string text;
  const auto add = [&](std::uint64_t count, std::string_view what) {
    text.append(text.empty() ? "" : ", ").append(short_number(count)).append(" ").append(what);
  };
  const auto add_any = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) add(count, what);
  };
  const bool any_lost = counts.missed > 0 || counts.refused > 0 || counts.bad > 0;
  const bool nothing_lost = !any_lost && counts.counts_missed;
  if (any_lost && counts.counts_missed) add(counts.sent(), "sent");
  add(counts.delivered, nothing_lost ? "delivered, nothing lost" : "delivered");
  if (any_lost && counts.counts_missed) add(counts.missed, "missed");
  if (any_lost) {
    add(counts.refused, "refused");
    add_any(counts.bad, "bad");
  }
  add_any(counts.clamped, "values out of range");
  if (!counts.counts_missed) {
    const bool slow = !driver::rate_shortfall(asked_hz, stats).empty();
    text += slow ? ", losses on the line: some" : ", losses on the line unknown";
  }
  add_any(stats.silences, "silences");
  add_any(stats.reopened, "reopened");
  return text;
}

} // namespace

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, std::clamp(value, -1e9, 1e9));
  return text;
}

std::string right_aligned(const std::string& text, int width) {
  const int blanks = std::max(0, width - static_cast<int>(text.size()));
  return std::string(static_cast<std::size_t>(blanks), ' ') + text;
}

std::string cut(std::string text, int width) {
  const auto most = static_cast<std::size_t>(std::max(width, 0));
  if (text.size() <= most) return text;
  text.resize(most);
  if (most > 0) text.back() = '~';
  return text;
}

std::string both_ends(const std::string& left, const std::string& right, int width) {
  const int space = width - static_cast<int>(right.size()) - 2;
  if (right.empty() || space < 20) return cut(left, width);
  std::string line = cut(left, space);
  line.resize(static_cast<std::size_t>(space) + 2, ' ');
  return line + right;
}

std::string stream_text(const StreamState& state) {
  constexpr double silent_after_s = 0.5;
  std::string text;
  if (state.stats.rate_hz > 0.0) text = fixed(state.stats.rate_hz, 1) + "/s, ";
  if (!driver::rate_shortfall(state.asked_hz, state.stats).empty()) {
    text = "only " + fixed(state.stats.rate_hz, 1) + " of " + fixed(state.asked_hz, 1) + "/s, ";
  }
  if (!state.age_s) {
    text += state.none_yet;
  } else if (*state.age_s > silent_after_s) {
    text += "silent for " + fixed(*state.age_s, 1) + " s";
  } else {
    text += fixed(1000.0 * std::max(*state.age_s, 0.0), 0) + " ms old";
  }
  return text + ", " + losses(state.asked_hz, state.stats);
}

std::string stream_line(const StreamState& state, const std::string& keys, int width) {
  const std::string text = stream_text(state);
  // --help lists the keys; losses are shown only here.
  const bool keys_fit = text.size() + 2 + keys.size() <= static_cast<std::size_t>(width);
  return both_ends(text, keys_fit ? keys : "", width);
}

} // namespace nendo::gloves
