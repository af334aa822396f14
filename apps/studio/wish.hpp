#pragma once
// What the user wants to do next in the studio.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <nendo/base/side.hpp>

namespace nendo::studio {

/// The screens, each a tab at the top.
enum class Screen : std::uint8_t { start, shaping, puppet, timeline, calibration };

/// A tab of the bar.
struct Tab {
  std::string_view name;
  Screen screen;
  std::string_view help;
};
inline constexpr std::array tabs{
    Tab{"Start", Screen::start, "Gloves, models and modes."},
    Tab{"Shaping", Screen::shaping, "Hands shape the model."},
    Tab{"Puppet", Screen::puppet, "Edits what the fingers play."},
    Tab{"Timeline", Screen::timeline, "Edits a recording by its key poses."},
    Tab{"Calibration", Screen::calibration, "A glove learns your hand."},
};

/// The hands of a run that has no gloves named on the command line.
enum class Hands : std::uint8_t {
  found,  ///< the machine's gloves, or simulated hands that move
  moving, ///< simulated hands that move
  still,  ///< simulated hands that only the mouse moves
};

/// A run with this model.
struct Shape {
  std::string model{};  ///< a file; empty: the usual one of the mode or the puppet
  std::string mode{};   ///< the name of a flow::Mode; empty: the usual one
  std::string puppet{}; ///< a puppet's file, which may be new, or a shipped puppet; empty: none
  Hands hands = Hands::found;
  std::string learns_for{}; ///< the wearer whose gloves it continues to learn; empty: no wearer
};
/// A glove, as the arguments of open_glove().
struct NamedGlove {
  std::string spec{};         ///< empty: none
  std::optional<Side> side{}; ///< the hand that wears it; nothing: the one that it is made for
};
/// Another screen.
struct Go {
  Screen screen = Screen::start;
  NamedGlove glove{}; ///< the one to calibrate; none: not chosen yet
};
/// A model, a puppet, a recording or a timeline, by its name's ending.
struct Open {
  std::string file;
  bool was_sent = false; ///< a browser sent it; it is removed if it is not opened
};
struct Quit {};

/// std::monostate: to stay here.
using Wish = std::variant<std::monostate, Shape, Go, Open, Quit>;

inline bool is_wish(const Wish& wish) noexcept {
  return !std::holds_alternative<std::monostate>(wish);
}

/// The user's answer to a question before something is lost.
enum class Answer : std::uint8_t { save, discard, stay };

} // namespace nendo::studio
