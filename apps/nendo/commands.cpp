#include "nendo/commands.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "cli/cli.hpp"

namespace nendo::app {

const char* const program_summary =
    "Nendo: data gloves that shape 3-D models.\n"
    "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 no such glove or no answer, "
    "4 no permission, 5 bad input file.";

void add_commands(cli::Command& program) {
  add_demo(program);
  add_studio(program);
  add_run(program);
  add_view(program);
  add_serve(program);
  add_monitor(program);
  add_calibrate(program);
  add_poses(program);
  add_devices(program);
  add_doctor(program);
  add_udev(program);
  add_info(program);
  add_calibration(program);
  add_puppet(program);
  add_deform(program);
  add_cut(program);
  add_join(program);
  add_repair(program);
  add_picture(program);
  add_emulate(program);
  add_record(program);
  add_replay(program);
  add_recording(program);
  add_export(program);
  add_edit(program);
  add_stress(program);
  program
      .add_command("bench",
                   "Measures this program on this machine: latency, faults, load, loop, rings, "
                   "hands, calibration, fields, deformation, clay")
      .set_footer("It starts nendo-bench, which a build without benchmarks does not have.");
}

int start_bench(char** arguments) {
  std::error_code unknown;
  const auto program =
      std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / "nendo-bench";
  ::execv(program.c_str(), arguments);
  if (errno != ENOENT)
    return cli::report({Errc::failed, program.string() + ": " + std::strerror(errno)});
  return cli::report({Errc::failed, "nendo-bench is not beside nendo; build it with cmake --build "
                                    "--preset release --target nendo-bench, or install the "
                                    "package"});
}

} // namespace nendo::app
