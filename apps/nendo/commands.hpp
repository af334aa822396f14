#pragma once
// The commands of the program. Each has a file and a namespace of its own. add() describes the
// command to the program.

#include "cli/command.hpp"

namespace nendo::app {

/// The first lines of --help: what the program is, and its exit codes.
extern const char* const program_summary;
/// Describes all commands, in the order of --help.
void add_commands(cli::Command& program);

namespace bench_command {
void add(cli::Command& program);
/// Becomes the nendo-bench that stands beside this program. `arguments` begin with the word after
/// the program's name, which is "bench", and end with a null pointer. Returns an exit code only if
/// there is no nendo-bench.
int start(char** arguments);
} // namespace bench_command
namespace calibrate_command {
void add(cli::Command& program);
}
namespace calibration_command {
void add(cli::Command& program);
}
namespace calibration_exchange {
/// Adds the commands import and export to `nendo calibration`.
void add(cli::Command& calibration);
} // namespace calibration_exchange
namespace cut_command {
void add(cli::Command& program);
}
namespace deform_command {
void add(cli::Command& program);
}
namespace demo_command {
void add(cli::Command& program);
}
namespace devices_command {
void add(cli::Command& program);
}
namespace doctor_command {
void add(cli::Command& program);
}
namespace edit_command {
void add(cli::Command& program);
}
namespace emulate_command {
void add(cli::Command& program);
}
namespace export_command {
void add(cli::Command& program);
}
namespace info_command {
void add(cli::Command& program);
}
namespace join_command {
void add(cli::Command& program);
}
namespace monitor_command {
void add(cli::Command& program);
}
namespace picture_command {
void add(cli::Command& program);
}
namespace poses_command {
void add(cli::Command& program);
}
namespace puppet_command {
void add(cli::Command& program);
}
namespace record_command {
void add(cli::Command& program);
}
namespace recording_command {
void add(cli::Command& program);
}
namespace repair_command {
void add(cli::Command& program);
}
namespace replay_command {
void add(cli::Command& program);
}
namespace run_command {
void add(cli::Command& program);
void add_view(cli::Command& program); ///< `nendo view`: the same run in a window
} // namespace run_command
namespace stress_command {
void add(cli::Command& program);
}
namespace udev_command {
void add(cli::Command& program);
}

} // namespace nendo::app
