#pragma once
// The commands that a FASTRAK and its older relative ISOTRAK II share, and how either is found: its
// answer to `S` is awaited at each rate of the line. The sources are those of fastrak_protocol.hpp.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "stream/text_dialogue.hpp"

namespace nendo::driver::polhemus {

// Commands of one letter, which act at once [M 34-83].
inline constexpr std::string_view stop_command = "c";   ///< ends the stream [M 41]
inline constexpr std::string_view stream_command = "C"; ///< [M 41]
inline constexpr std::string_view text_command = "F";   ///< records as text, the default [M 47]
inline constexpr std::string_view binary_command = "f"; ///< [M 47]
inline constexpr std::string_view centimetres_command = "u"; ///< [S]
inline constexpr std::string_view status_command = "S";      ///< [M 68]

// The filters of position and attitude [M appendix E, V]. That these numbers switch them off is
// stated for LIBERTY [V].
inline constexpr std::array<std::string_view, 2> filters_off{"x0,1,0,0\r", "v0,1,0,0\r"};
inline constexpr std::array<std::string_view, 2> filters_on{"x0.2,0.2,0.8,0.8\r",
                                                            "v0.2,0.2,0.8,0.8\r"};

/// Returns a command's letter, the station as a digit of up to 12, and the parameters.
std::string station_command(char letter, std::uint16_t station, std::string_view parameters);

/// Sends a command, and waits a little: no source says how many fit into a tracker's buffer.
void send_slowly(TextDialogue& dialogue, std::string_view command);

/// Ends any stream and asks for the status at each of `bauds` in turn, and once more after the CR
/// that a tracker may wait for, until `is_status(what was heard)`. Returns the rate. Takes 3.1 s
/// for five rates without an answer, less than open_budget; 2.1 s for one.
std::optional<int> greet(Transport& transport, TextDialogue& dialogue,
                         const std::vector<int>& bauds,
                         const std::function<bool(const std::string&)>& is_status);

/// The error for a port where no tracker of that name answers.
Error stranger(const std::string& source, const std::string& name, const std::vector<int>& bauds,
               bool is_silent);
/// The error for a station without a receiver; `others` has those with one, e.g. "1, 2".
Error not_plugged_in(const std::string& source, std::uint16_t station, const std::string& others);

} // namespace nendo::driver::polhemus
