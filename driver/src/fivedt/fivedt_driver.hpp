#pragma once
// The 5DT Data Glove 5 at a serial port, wired or wireless.

#include <memory>
#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver::fivedt {

/// Opens `5dt:PATH?baud=19200|9600&hand=left|right&left_first=thumb|pinky`, as the table of drivers
/// wants it. `left_first` is the finger with which the samples of left gloves begin, see
/// fivedt_protocol.hpp; those of right ones begin with the thumb. At 19200 baud the glove is asked
/// for its hand and its name. At 9600 it is a wireless one, to which nothing is ever sent: its
/// samples prove that it is there, and `hand`, or else `side`, tells the hand. Each finger has one
/// flexion, in the slot of its MCP. May block for 4 s. Errors: usage, no_device, no_permission.
Result<std::unique_ptr<Glove>> open_fivedt(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver::fivedt
