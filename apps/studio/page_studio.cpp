#include "studio/page_studio.hpp"

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include <nendo/base/text.hpp>

#include "cli/cli.hpp"
#include "cli/model_files.hpp"
#include "studio/opened_files.hpp"
#include "studio/page_calibration.hpp"
#include "studio/page_dialogs.hpp"
#include "studio/page_figures.hpp"
#include "studio/page_run.hpp"
#include "studio/page_timeline.hpp"
#include "studio/start_choices.hpp"
#include "studio/studio_flow.hpp"
#include "web/page_form.hpp"

namespace nendo::studio {
namespace {

namespace fs = std::filesystem;
constexpr const char* screen_names[] = {"start", "shaping", "shaping", "timeline", "calibration"};

class PageStudio final : public StudioFlow {
public:
  PageStudio(std::shared_ptr<web::Server> server, StudioOptions options)
      : StudioFlow(std::move(options)), server_(std::move(server)), timeline_(*server_) {}

  std::optional<Shape> choose() override {
    cli::install_stop_signals();
    view_.reset(); // and the timeline beside the run
    if (std::exchange(has_run_, false)) server_->present_nothing();
    while (!is_over_ && !next_ && !cli::stop_requested()) {
      const auto due = std::chrono::steady_clock::now() + picture_time;
      show_one();
      std::this_thread::sleep_until(due);
    }
    leave_screen();
    server_->set_figures(PageFigures().message());
    return take_next();
  }

  session::Observer* observe(const session::RunOptions& run, bool asks_to_save) override {
    view_ = std::make_unique<PageRun>(*server_, timeline_, cli::short_name(run.mesh), asks_to_save);
    has_run_ = true;
    received_.clear(); // it can be read
    return view_.get();
  }

  void show_error(const std::string& message) override {
    next_.reset();
    error_ = message;
    std::error_code ignored;
    if (!received_.empty()) fs::remove(std::exchange(received_, {}), ignored);
  }

  Result<void> end() override { return {}; }

private:
  Screen screen() const {
    return shows_timeline_ ? Screen::timeline : calibration_ ? Screen::calibration : Screen::start;
  }

  void show_one() {
    form_.begin(server_->next_input(web::FormKind::screen));
    follow_safely(describe_bar(form_, screen(), shows_timeline_ ? timeline_.title() : ""));
    show_dialog();
    const Screen now = screen(); // the bar and the dialog may lead to another one
    PageFigures figures;
    if (now == Screen::timeline) follow_shown(timeline_.update(form_));
    if (now == Screen::calibration) follow_shown(calibration_->update(form_, figures));
    if (now == Screen::start) show_start(figures);
    server_->set_figures(figures.message());
    if (form_.has_new_pictures()) server_->set_pictures(form_.pictures());
    server_->set_form(web::FormKind::screen,
                      form_.message(screen_names[static_cast<std::size_t>(now)]));
    if (const auto file = server_->take_file()) open_received(*file);
  }

  void follow_shown(const Result<Wish>& wish) {
    if (!wish) show_error(wish.error().message);
    follow_seen(wish ? *wish : Wish{Go{Screen::start}});
  }

  void show_dialog() {
    if (timeline_.is_asking()) {
      const auto wish = timeline_.ask(form_);
      wish ? follow_safely(*wish) : show_error(wish.error().message);
    } else if (is_wish(waiting_)) {
      ask();
    } else if (!error_.empty()) {
      if (show_message(form_, error_)) error_.clear();
    } else if (dialog_.is_open()) {
      follow_safely(dialog_.describe(form_));
    }
  }

  void ask() {
    const auto answer = ask_to_discard(form_, "the poses");
    if (!answer) return;
    const Wish wish = std::exchange(waiting_, {});
    *answer == Answer::discard ? follow_seen(wish) : remove_sent(wish);
  }

  void show_start(PageFigures& figures) {
    if (!start_)
      start_ = std::make_unique<StartChoices>(StartOptions{options_.gloves, options_.calibration});
    figures.add(start_->update());
    figures.look_by({0.0, 12.0}, 0.48, 0.4, 0.04);
    form_.part("ways");
    const Wish of_ways = start_->describe_ways(
        form_, "Or drop one on this page: a model, a puppet, a recording, a timeline.");
    form_.part("hands");
    form_.title("Your hands", "");
    const Wish of_hands = start_->describe_hands(form_);
    follow_safely(is_wish(of_hands) ? of_hands : of_ways);
  }

  /// Asks before edits of the timeline, or poses of a calibration, are lost.
  void follow_safely(const Wish& wish) {
    if (!timeline_.lets(wish)) return;
    if (!is_wish(wish) || !calibration_ || !calibration_->has_unkept_poses())
      return follow_seen(wish);
    remove_sent(std::exchange(waiting_, wish));
  }

  void follow_seen(const Wish& wish) {
    if (is_wish(wish)) received_.clear(); // the user has seen the file, and left it
    follow(wish);
  }

  Wish left_for() const override { return view_ ? view_->left_for() : Wish{}; }
  bool has_edits_to_lose() const override { return timeline_.has_edits_to_lose(); }
  NamedGlove found_glove() const override { return start_ ? start_->found_glove() : NamedGlove{}; }

  void leave_screen() override {
    if (calibration_) learns_for_ = calibration_->learns_for();
    remove_sent(std::exchange(waiting_, {}));
    start_.reset();
    calibration_.reset();
    timeline_.leave();
    shows_timeline_ = false;
    form_.forget_images();
  }

  void enter_timeline(const std::string& file) override {
    leave_screen();
    shows_timeline_ = true;
    // The timeline removes a file that was sent, if it cannot be read.
    if (!file.empty()) timeline_.open({file, !std::exchange(received_, {}).empty()});
  }

  void enter_calibration(const NamedGlove& glove) override {
    calibration_ = std::make_unique<PageCalibration>(glove);
  }

  /// A puppet that is new is made in the window.
  void begin_run(const Shape& shape) override {
    std::error_code ignored;
    const bool is_for_model = !shape.model.empty() && !shape.puppet.empty();
    if (is_for_model && !fs::exists(shape.puppet, ignored))
      return show_error(printable(fs::path(shape.model).filename().string()) +
                        ": has no puppet yet; make one in the window of nendo studio, or choose "
                        "Moai, Face or Spot");
    next_ = shape;
  }

  void open(const Open& wanted) override {
    const std::string& file = wanted.file;
    if (file.empty()) return dialog_.open();
    dialog_.close();
    received_ = wanted.was_sent ? file : "";
    if (const auto fine = check_there(file); !fine) return show_error(fine.error().message);
    begin_with(file);
  }

  void open_received(const web::Server::File& file) {
    received_.clear();
    dialog_.close();
    const auto stored = store_sent(file.name, file.bytes, timeline_.out());
    if (!stored) return show_error(stored.error().message);
    follow_safely(Open{*stored, true});
  }

  std::shared_ptr<web::Server> server_;
  web::PageForm form_;
  PageTimeline timeline_;
  std::unique_ptr<StartChoices> start_;
  std::unique_ptr<PageCalibration> calibration_;
  std::unique_ptr<PageRun> view_;
  std::string error_;    ///< shown until it is closed
  std::string received_; ///< a file that was sent, removed if it cannot be read; empty: none
  Wish waiting_;         ///< where the user goes once the poses of the calibration are discarded
  bool shows_timeline_ = false;
  OpenDialog dialog_;
  bool has_run_ = true; ///< the server has another loop
};

} // namespace

Result<std::unique_ptr<Studio>> open_page_studio(const StudioOptions& options,
                                                 std::shared_ptr<web::Server> server) {
  return std::unique_ptr<Studio>(std::make_unique<PageStudio>(std::move(server), options));
}

} // namespace nendo::studio
