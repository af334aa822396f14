#pragma once
// The commands of nendo bench. Each has a file and a namespace of its own.

#include "cli/command.hpp"

namespace nendo::bench {

void add_bench(cli::Command& program);

namespace calibration_bench {
void add(cli::Command& bench);
}
namespace clay_bench {
void add(cli::Command& bench);
}
namespace cut_bench {
void add(cli::Command& bench);
}
namespace deform_bench {
void add(cli::Command& bench);
}
namespace faults_bench {
void add(cli::Command& bench);
}
namespace hand_bench {
void add(cli::Command& bench);
}
namespace join_bench {
void add(cli::Command& bench);
}
namespace models_bench {
void add(cli::Command& bench);
}
namespace latency_bench {
void add(cli::Command& bench);
}
namespace rt_bench {
void add(cli::Command& bench);
}
namespace scale_bench {
void add(cli::Command& bench);
}
namespace soak_bench {
void add(cli::Command& bench);
}
namespace solve_bench {
void add(cli::Command& bench);
}
namespace table1_bench {
void add(cli::Command& bench);
}
namespace wearers_bench {
void add(cli::Command& bench);
}

} // namespace nendo::bench
