#include "nendo/run_in_studio.hpp"

#include <memory>
#include <utility>

#include "cli/cli.hpp"
#include "nendo/run_once.hpp"
#include "studio/page_studio.hpp"
#include "studio/studio.hpp"

namespace nendo::app::run_command {
namespace {

/// What the user chose in the window, with what the command line says about hands, timing and
/// outputs that are not files.
RunArguments arguments_for(const studio::Shape& shape, const RunArguments& first) {
  RunArguments next = first.usual ? *first.usual : first;
  next.run.left = first.run.left;
  next.run.right = first.run.right;
  next.run.wrists = first.run.wrists;
  next.run.calibration = first.run.calibration;
  next.run.length = first.run.length;
  next.run.undo_memory_mb = first.run.undo_memory_mb;
  next.run.loop.rate_hz = first.run.loop.rate_hz;
  next.loop = first.loop;
  next.view = first.view;
  next.publish = first.publish;
  next.web = first.web;
  if (!shape.model.empty()) next.models = {shape.model};
  if (!shape.mode.empty()) next.settings.choose(flow::setting::mode, shape.mode);
  next.run.puppet_file = shape.puppet;
  if (!shape.learns_for.empty()) {
    next.run.calibration.adapt = true;
    next.run.calibration.user = shape.learns_for;
  }
  const bool is_still = shape.hands == studio::Hands::still;
  if (shape.hands == studio::Hands::found) return next;
  next.run.left = is_still ? "sim:rest" : shape.puppet.empty() ? "sim" : "sim:faces";
  next.run.right = next.run.left;
  return next;
}

std::vector<studio::NamedGlove> named_gloves(const session::RunOptions& run) {
  std::vector<studio::NamedGlove> gloves;
  if (!run.left.empty()) gloves.push_back({run.left, Side::left});
  if (!run.right.empty()) gloves.push_back({run.right, Side::right});
  return gloves;
}

class StudioRuns {
public:
  StudioRuns(const RunArguments& first, std::optional<studio::FirstTimeline> timeline)
      : first_(first), timeline_(std::move(timeline)) {}

  int run() {
    int code = 0;
    if (const auto fine = check_view(first_); !fine) return cli::report(fine.error());
    if (first_.begin == Begin::with_run && !timeline_) {
      RunArguments arguments = first_;
      const auto done = run_one(arguments);
      if (!done) return cli::report(done.error());
      code = *done;
      if (!studio_->goes_on()) return end(code);
    } else if (const auto opened = open(); !opened) {
      return cli::report(opened.error());
    }
    while (const auto shape = studio_->choose()) {
      RunArguments arguments = arguments_for(*shape, first_);
      const auto done = run_one(arguments);
      if (!done) {
        studio_->show_error(done.error().message);
        continue;
      }
      code = *done;
      if (!studio_->goes_on()) break;
    }
    return end(code);
  }

private:
  Result<void> open() {
    if (studio_) return {};
    studio::StudioOptions options{first_.view, std::move(timeline_), named_gloves(first_.run),
                                  first_.run.calibration};
    auto opened = first_.view.window ? studio::open_studio(options) : open_on_page(options);
    if (!opened) return opened.error();
    studio_ = *std::move(opened);
    return {};
  }

  Result<std::unique_ptr<studio::Studio>> open_on_page(const studio::StudioOptions& options) {
    auto page = session::open_web_server(first_.web);
    if (!page) return page.error();
    page_ = *std::move(page);
    return studio::open_page_studio(options, page_);
  }

  /// The window opens when the model is read, so that errors of the command line come first.
  Result<int> run_one(RunArguments& arguments) {
    // With a file, a duration or a number of pictures, the run has its end on the command line.
    const bool asks_to_save =
        arguments.run.out.empty() && arguments.view.frames == 0 && arguments.run.duration_s <= 0.0;
    return run_once(arguments, [&](const RunArguments& complete) -> Result<session::Observer*> {
      if (const auto opened = open(); !opened) return opened.error();
      arguments.page = page_;
      return studio_->observe(complete.run, asks_to_save);
    });
  }

  int end(int code) {
    const auto ended = studio_->end();
    return ended ? code : cli::report(ended.error());
  }

  const RunArguments& first_;
  std::optional<studio::FirstTimeline> timeline_;
  std::shared_ptr<web::Server> page_; ///< null: the studio is a window
  std::unique_ptr<studio::Studio> studio_;
};

} // namespace

int run_in_studio(const RunArguments& arguments, std::optional<studio::FirstTimeline> timeline) {
  return StudioRuns(arguments, std::move(timeline)).run();
}

} // namespace nendo::app::run_command
