#pragma once
// The commands of the program, one a file: each function describes its own to the program.

#include "command.hpp"

namespace nendo::app {

void add_bench(Command& program);
void add_calibrate(Command& program);
void add_calibration(Command& program);
void add_deform(Command& program);
void add_devices(Command& program);
void add_doctor(Command& program);
void add_edit(Command& program);
void add_emulate(Command& program);
void add_export(Command& program);
void add_info(Command& program);
void add_manual(Command& program);
void add_monitor(Command& program);
void add_picture(Command& program);
void add_poses(Command& program);
void add_record(Command& program);
void add_recording(Command& program);
void add_replay(Command& program);
void add_run(Command& program);
void add_stress(Command& program);
void add_udev(Command& program);
void add_view(Command& program);

} // namespace nendo::app
