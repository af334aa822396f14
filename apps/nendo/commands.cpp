#include "nendo/commands.hpp"

namespace nendo::app {

const char* const program_summary =
    "Nendo: data gloves that shape 3-D models.\n"
    "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 no such glove or no answer, "
    "4 no permission, 5 bad input file.";

void add_commands(cli::Command& program) {
  demo_command::add(program);
  run_command::add(program);
  run_command::add_view(program);
  monitor_command::add(program);
  calibrate_command::add(program);
  poses_command::add(program);
  devices_command::add(program);
  doctor_command::add(program);
  udev_command::add(program);
  info_command::add(program);
  calibration_command::add(program);
  puppet_command::add(program);
  deform_command::add(program);
  cut_command::add(program);
  join_command::add(program);
  repair_command::add(program);
  picture_command::add(program);
  emulate_command::add(program);
  record_command::add(program);
  replay_command::add(program);
  recording_command::add(program);
  export_command::add(program);
  edit_command::add(program);
  stress_command::add(program);
  bench_command::add(program);
}

} // namespace nendo::app
