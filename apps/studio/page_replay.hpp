#pragma once
// A recording or a timeline that plays on a page, beside a run or without one. Main thread; its
// file is read in another one.

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <nendo/flow/frame.hpp>

#include "studio/wish.hpp"
#include "takes/take.hpp"
#include "web/model_message.hpp"
#include "web/page_form.hpp"
#include "web/server.hpp"

namespace nendo::studio {

using forms::Form;

/// Readings whose replays are no longer shown. The destructor of a reading's future waits for its
/// end, and the page would not change meanwhile. The destructor of this waits as well, because no
/// thread may read on while the program ends.
class LeftReadings {
public:
  template <class T>
  void add(std::future<T> reading) {
    if (!reading.valid()) return;
    readings_.push_back([left = reading.share()] {
      return left.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    });
  }

  /// Returns whether all but one have ended, so that another file may be read. Else someone who
  /// opens and leaves replays quickly would fill the memory.
  bool have_ended() {
    std::erase_if(readings_, [](const auto& has_ended) { return has_ended(); });
    return readings_.size() <= 1;
  }

private:
  std::vector<std::function<bool()>> readings_; ///< each returns whether it has ended
};

class PageReplay {
public:
  /// `file` is read once `left` have ended; empty: the page says how to get one. `left`, which must
  /// outlive this, gets what is still being read at the end. Of a model with more than `most`
  /// vertices nothing is shown.
  PageReplay(web::Server& server, LeftReadings& left, std::string file,
             std::size_t most = web::max_vertices);
  /// The page shows what it showed before. Does not wait for the file.
  ~PageReplay();
  PageReplay(const PageReplay&) = delete;
  PageReplay& operator=(const PageReplay&) = delete;

  /// Plays on, and describes the controls. Takes at most some 20 ms. Returns what was clicked.
  /// Errors: those of takes::read_take() and session::check_for_browsers().
  Result<Wish> update(web::PageForm& form);

private:
  struct Opened {
    takes::Take take;
    std::unique_ptr<takes::FrameSource> frames;
  };
  static Result<Opened> opened(const std::string& file, const std::stop_token& stop);
  void begin_reading();
  void take_controls(web::PageForm& form);
  void go_to(double time_s);
  Error no_frame() const;
  Result<void> play_on();
  Result<void> present();
  Result<void> show();

  web::Server& server_;
  LeftReadings& left_readings_;
  std::string file_;
  std::size_t most_;
  std::stop_source stop_; ///< requested when the readings are left
  std::future<Result<Opened>> reading_;
  std::optional<Opened> opened_;
  std::future<Result<std::unique_ptr<takes::FrameSource>>> rewinding_;
  std::shared_ptr<web::FrameStream> stream_; ///< frames of the model that is shown
  std::uint32_t version_ = 0;
  flow::Frame shown_;
  bool plays_ = true;
  double time_s_ = 0.0; ///< the time to be shown
  HostTime updated_{};
};

} // namespace nendo::studio
