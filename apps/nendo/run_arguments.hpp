#pragma once
// The arguments of `nendo run` and `nendo view`.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

#include "session/overdub.hpp"
#include "session/setting_options.hpp"
#include "session/views.hpp"

namespace nendo::app::run_command {

/// What a window begins with.
enum class Begin : std::uint8_t {
  with_run,   ///< the run of the arguments
  with_start, ///< the screen on which the user chooses
};

struct RunArguments {
  session::RunOptions run;
  std::vector<std::string> models; ///< files, which are placed side by side
  std::string up;                  ///< empty: y
  std::string wire, knife;         ///< FROM:TO, the time of drawing; empty: on request
  std::string size;                ///< the model's size on the stage; empty: the mode's
  std::string switch_action = "none";
  session::SettingArguments settings;
  flow::LoopSettings asked; ///< the values of `settings`, set by check()
  std::string polynomial = "none";
  session::LoopArguments loop;
  session::ViewOptions view;
  session::OverdubArguments overdub;
  std::string decided_by_take; ///< the first option of the command line that a take decides
  std::vector<std::string> publish;
  std::string web;                     ///< [ADDR:]PORT; empty: none
  std::shared_ptr<web::Server> page{}; ///< the open server; null: `web` opens one
  bool studio = false;                 ///< the user can choose a next run, in a window or on a page
  bool not_injective = false;
  std::optional<std::uint32_t> refine_to;
  std::string out_puppet;
  bool force = false; ///< --out may be the model, and --out-puppet may exist
  Begin begin = Begin::with_run;
  std::shared_ptr<const RunArguments> usual{}; ///< the values without a command line
};

/// Checks them, completes `run`, and reads the puppet, the masks and the take that they name.
/// Errors: usage, and those of the files.
Result<void> check(RunArguments& arguments);
/// Error: usage, for options of a window that there is not.
Result<void> check_view(const RunArguments& arguments);

/// Reads the model, or that of the take to play over, which must be as it was recorded. Errors:
/// those of deform::read_mesh(), takes::find_recorded_model() and session::take_over_settings();
/// bad_input if it is another model, or cannot be refined as asked.
Result<deform::Mesh> read_model(RunArguments& arguments);

} // namespace nendo::app::run_command
