#pragma once
// The commands of the program. Each has a file and a namespace of its own, and a function add_X()
// that describes it to the program.

#include "cli/command.hpp"

namespace nendo::app {

/// The first lines of --help: what the program is, and its exit codes.
extern const char* const program_summary;
/// Describes all commands, in the order of --help.
void add_commands(cli::Command& program);
/// `nendo bench`: becomes the nendo-bench that is beside this program. `arguments` begin with the
/// word after the program's name, which is "bench", and end with a null pointer. Returns an exit
/// code only if there is no nendo-bench.
int start_bench(char** arguments);

void add_calibrate(cli::Command& program);
void add_calibration(cli::Command& program);
void add_cut(cli::Command& program);
void add_deform(cli::Command& program);
void add_demo(cli::Command& program);
void add_devices(cli::Command& program);
void add_doctor(cli::Command& program);
void add_edit(cli::Command& program);
void add_emulate(cli::Command& program);
void add_export(cli::Command& program);
void add_info(cli::Command& program);
void add_join(cli::Command& program);
void add_monitor(cli::Command& program);
void add_picture(cli::Command& program);
void add_poses(cli::Command& program);
void add_puppet(cli::Command& program);
void add_record(cli::Command& program);
void add_recording(cli::Command& program);
void add_repair(cli::Command& program);
void add_replay(cli::Command& program);
void add_run(cli::Command& program);
void add_serve(cli::Command& program);
void add_stress(cli::Command& program);
void add_studio(cli::Command& program); ///< `nendo studio`: a window that begins with a choice
void add_udev(cli::Command& program);
void add_view(cli::Command& program); ///< `nendo view`: the same as run in a window
/// Adds the command view to `nendo edit`.
void add_timeline_view(cli::Command& edit);
/// Adds the command tracker to `nendo calibrate`.
void add_calibrate_tracker(cli::Command& calibrate);
/// Adds the commands import and export to `nendo calibration`.
void add_calibration_exchange(cli::Command& calibration);

} // namespace nendo::app
