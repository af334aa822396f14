#pragma once
// A recording or a timeline that plays on a page, beside a run or without one. Main thread; its
// file is read in another one.

#include <future>
#include <memory>
#include <optional>
#include <string>

#include <nendo/flow/frame.hpp>

#include "studio/wish.hpp"
#include "takes/take.hpp"
#include "web/page_form.hpp"
#include "web/server.hpp"

namespace nendo::studio {

using forms::Form;

class PageReplay {
public:
  /// Begins to read the file; empty: the page says how to get one.
  PageReplay(web::Server& server, std::string file);
  /// The page shows what it showed before.
  ~PageReplay();
  PageReplay(const PageReplay&) = delete;
  PageReplay& operator=(const PageReplay&) = delete;

  /// Plays on, and describes the controls. Takes at most some 20 ms. Returns what was clicked.
  /// Errors: those of takes::read_take().
  Result<Wish> update(web::PageForm& form);

private:
  struct Opened {
    takes::Take take;
    std::unique_ptr<takes::FrameSource> frames;
  };
  static Result<Opened> opened(const std::string& file);
  void take_controls(web::PageForm& form);
  void go_to(double time_s);
  Error no_frame() const;
  Result<void> play_on();
  void present();
  void show();

  web::Server& server_;
  std::string file_;
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
