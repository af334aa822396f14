// The nendo program: one command a file.

#include <exception>
#include <iostream>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <nendo/base/result.hpp>

#include "commands.hpp"

namespace {

int run(int argc, char** argv) {
  using namespace nendo::app;
  // The drivers' log lines must not mix with what a command prints.
  spdlog::set_default_logger(spdlog::stderr_color_mt("nendo"));
  spdlog::set_pattern("nendo: %v");
  return run_program(argc, argv,
                     "Nendo: data gloves that shape 3-D models.\n"
                     "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 no such glove or no answer, "
                     "4 no permission, 5 bad input file.",
                     [](Command& program) {
                       add_run(program);
                       add_view(program);
                       add_monitor(program);
                       add_calibrate(program);
                       add_poses(program);
                       add_devices(program);
                       add_doctor(program);
                       add_udev(program);
                       add_info(program);
                       add_calibration(program);
                       add_deform(program);
                       add_picture(program);
                       add_emulate(program);
                       add_record(program);
                       add_replay(program);
                       add_recording(program);
                       add_export(program);
                       add_edit(program);
                       add_stress(program);
                       add_bench(program);
                       add_manual(program);
                     });
}

} // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) { // out of memory, mostly
    std::cerr << "nendo: " << error.what() << '\n';
    return static_cast<int>(nendo::Errc::failed);
  }
}
