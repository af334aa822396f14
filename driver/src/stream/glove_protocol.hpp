#pragma once
// What differs between kinds of gloves.

#include <nendo/driver/glove.hpp>

#include "stream/stream_parser.hpp"
#include "stream/stream_protocol.hpp"

namespace nendo::driver {

class GloveProtocol : public DeviceProtocol<GloveSample, GloveInfo> {
public:
  /// Shows `feedback` while the glove streams. If the device went away, the next read reports it.
  virtual void set_feedback(Transport& transport, const Feedback& feedback,
                            const ReplyDeadline& limit) noexcept {
    (void)transport, (void)feedback, (void)limit;
  }
};

} // namespace nendo::driver
