#pragma once
// Small programs that use a lock-free class as its contract allows, with the laws that must hold in
// every execution of them.

#include <functional>
#include <string>
#include <vector>

#include "explorer/explorer.hpp"

namespace nendo::explorer {

struct Scenario {
  std::string name;
  std::function<Program()> make;
};

std::vector<Scenario> spsc_ring_scenarios();
std::vector<Scenario> triple_buffer_scenarios();
std::vector<Scenario> seq_lock_scenarios();
std::vector<Scenario> job_offer_scenarios();
std::vector<Scenario> shared_slots_scenarios();

} // namespace nendo::explorer
