// Every execution of the scenarios keeps their laws, and whatever is made weaker breaks one.

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "explorer/scenarios.hpp"

using namespace nendo::explorer;

namespace {

using Order = std::memory_order;

struct Mutant {
  std::string name;
  Mutation mutation;
};

/// Each order that is not relaxed, made weaker in each way there is; each relaxed store, all plain
/// reads and all plain writes, moved behind what publishes them.
std::vector<Mutant> mutants_of(const std::vector<Site>& sites, bool plain) {
  std::vector<Mutant> mutants;
  if (plain) {
    mutants = {{"plain reads after the next release", {Mutation::Kind::late_reads, {}, {}}},
               {"plain writes after the next release", {Mutation::Kind::late_writes, {}, {}}}};
  }
  const auto weaken = [&](const Site& site, Order order) {
    mutants.push_back(
        {describe(site) + " made " + name_of(order), {Mutation::Kind::weaker, site, order}});
  };
  for (const Site& site : sites) {
    if (site.order == Order::acq_rel) {
      weaken(site, Order::acquire);
      weaken(site, Order::release);
    } else if (site.order != Order::relaxed) {
      weaken(site, Order::relaxed);
    }
    if (site.kind == Site::Kind::store && site.order == Order::relaxed) {
      mutants.push_back({describe(site) + " after the next release",
                         {Mutation::Kind::late_store, site, site.order}});
    }
  }
  return mutants;
}

/// Proves the scenarios, then finds every mutant of `header` in them. Prints what it did.
void prove(const std::string& header, const std::vector<Scenario>& scenarios) {
  std::vector<Site> sites;
  bool plain = false;
  for (const Scenario& scenario : scenarios) {
    const Verdict verdict = explore(scenario.make);
    REQUIRE_MESSAGE(verdict.fault.empty(), scenario.name, ": ", verdict.fault, "\n", verdict.trace);
    MESSAGE(header, ", ", scenario.name, ": holds in all ", verdict.executions, " executions");
    plain = plain || verdict.accesses > 0;
    for (const Site& site : verdict.sites) {
      const bool known = std::find(sites.begin(), sites.end(), site) != sites.end();
      if (!known && std::string(site.file).ends_with("/" + header)) sites.push_back(site);
    }
  }
  const std::vector<Mutant> mutants = mutants_of(sites, plain);
  for (const Mutant& mutant : mutants) {
    Verdict verdict;
    for (std::size_t n = 0; n < scenarios.size() && verdict.fault.empty(); ++n)
      verdict = explore(scenarios[n].make, {mutant.mutation, true});
    CHECK_MESSAGE(!verdict.fault.empty(), "not found: ", mutant.name);
    MESSAGE(mutant.name, ": ", verdict.fault);
  }
  MESSAGE(header, ": ", mutants.size(), " mutants");
}

} // namespace

TEST_SUITE("proofs") {
  TEST_CASE("the ring that refuses keeps its laws, and needs every order that it states") {
    prove("spsc_ring.hpp", spsc_ring_scenarios());
  }

  TEST_CASE("the triple buffer keeps its laws, and needs every order that it states") {
    prove("triple_buffer.hpp", triple_buffer_scenarios());
  }

  TEST_CASE("the sequence lock keeps its laws, and needs every order that it states") {
    prove("seq_lock.hpp", seq_lock_scenarios());
  }

  TEST_CASE("the offer of a job keeps its laws, and needs every order that it states") {
    prove("job_offer.hpp", job_offer_scenarios());
  }

  TEST_CASE("shared slots keep their laws, and need every order that they state") {
    prove("shared_slots.hpp", shared_slots_scenarios());
  }
}
