#pragma once
// Gloves that shape a model, as a program that embeds Nendo sets them up: open the gloves, place
// the hands, run the loop on a thread of its own.

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace vtk_hands {

struct ShapingOptions {
  std::array<std::string, 2> gloves; ///< GLOVE arguments: left, right; empty: no such hand
  nendo::flow::Mode mode = nendo::flow::Mode::type1;
};

class LiveShaping {
public:
  /// Opens the gloves, waits for a sample from each, and starts the loop. A glove on somebody's
  /// hand gets the calibration that `nendo calibrate` has stored for it, any other an average
  /// hand's. Blocks for some seconds at most. Errors: those of open_glove(); no_device (a glove
  /// sends nothing).
  static nendo::Result<std::unique_ptr<LiveShaping>> begin(const nendo::deform::Mesh& model,
                                                           const ShapingOptions& options);
  ~LiveShaping();
  LiveShaping(const LiveShaping&) = delete;
  LiveShaping& operator=(const LiveShaping&) = delete;

  nendo::flow::DeformLoop& loop() noexcept { return *loop_; }
  /// Returns true if all gloves are recordings that have ended.
  bool has_ended() const noexcept;

private:
  struct Hand;
  LiveShaping() = default;
  static nendo::Result<std::unique_ptr<Hand>> open(const std::string& glove, nendo::Side side);

  std::vector<std::unique_ptr<Hand>> hands_;
  std::unique_ptr<nendo::flow::DeformLoop> loop_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

} // namespace vtk_hands
