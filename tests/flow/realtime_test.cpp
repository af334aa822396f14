#include <nendo/flow/realtime.hpp>

#include <algorithm>
#include <thread>

#include <doctest/doctest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace realtime_test {

using namespace nendo;
using namespace nendo::flow;

namespace {

const Grant* find(const std::vector<Grant>& grants, std::string_view name) {
  const auto found = std::find_if(grants.begin(), grants.end(),
                                  [&](const Grant& grant) { return grant.name == name; });
  return found == grants.end() ? nullptr : &*found;
}

/// Runs `what` on a thread that has an ordinary user's rights, also if root runs the test: the
/// system call, other than the function of its name, changes one thread alone.
template <class What>
void as_ordinary_user(What&& what) {
  std::thread([&] {
    constexpr uid_t ordinary_user = 65534;
    if (::geteuid() == 0)
      REQUIRE(::syscall(SYS_setresuid, ordinary_user, ordinary_user, ordinary_user) == 0);
    what();
  }).join();
}

bool may_have_priorities() {
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  return limit.rlim_cur > 0;
}

} // namespace

TEST_SUITE("realtime") {
  TEST_CASE("CPUs are read from lists and ranges, each once, in order") {
    using Cpus = std::vector<unsigned>;
    CHECK(*parse_cpus("0", "--affinity") == Cpus{0});
    CHECK(*parse_cpus("0,0-0,0", "--affinity") == Cpus{0});
    if (::sysconf(_SC_NPROCESSORS_CONF) < 2) return;
    CHECK(*parse_cpus("1,0", "--affinity") == Cpus{0, 1});
    CHECK(*parse_cpus("0-1", "--affinity") == Cpus{0, 1});
  }

  TEST_CASE("what is no CPU of this machine is refused by the option's name") {
    for (const char* text : {"", "x", "-1", "0,", ",0", "0-", "1-0", "0x1", "99999", "0-99999",
                             "4294967296", "0 1", "0--1"}) {
      const auto cpus = parse_cpus(text, "--affinity");
      REQUIRE_FALSE(cpus);
      CHECK(cpus.error().code == Errc::usage);
      CHECK(cpus.error().message.find("--affinity") == 0);
    }
  }

  TEST_CASE("a thread has what was granted: CPU and timer slack") {
    std::thread([] {
      RealtimeOptions options;
      options.affinity = {0};
      const auto grants = make_thread_realtime(options);
      REQUIRE(find(grants, "affinity"));
      REQUIRE(find(grants, "timer_slack"));
      CHECK_FALSE(find(grants, "policy")); // it was not requested
      if (find(grants, "timer_slack")->granted) CHECK(::prctl(PR_GET_TIMERSLACK) == 1);
      if (!find(grants, "affinity")->granted) return;
      cpu_set_t set;
      ::pthread_getaffinity_np(::pthread_self(), sizeof set, &set);
      CHECK(CPU_COUNT(&set) == 1);
      CHECK(CPU_ISSET(0, &set));
    }).join();
  }

  TEST_CASE("a priority is had or refused, and what is said of it is true") {
    std::thread([] {
      RealtimeOptions options;
      options.priority = 7;
      const auto grants = make_thread_realtime(options);
      const Grant* policy = find(grants, "policy");
      REQUIRE(policy);
      int scheduler = 0;
      sched_param parameter{};
      ::pthread_getschedparam(::pthread_self(), &scheduler, &parameter);
      CHECK(policy->granted == (scheduler == SCHED_FIFO));
      CHECK(policy->granted == (parameter.sched_priority == 7));
      CHECK(policy->wanted == "SCHED_FIFO 7");
    }).join();
  }

  TEST_CASE("an ordinary user is refused in words, with the remedy, and nothing else happens") {
    if (may_have_priorities()) return;
    as_ordinary_user([] {
      RealtimeOptions options;
      options.priority = 80;
      options.lock_memory = true;
      rlimit memory{};
      ::getrlimit(RLIMIT_MEMLOCK, &memory);
      const RealtimeProcess process(options);
      const auto grants = make_thread_realtime(options);
      const auto lines = refusals(grants);
      REQUIRE(lines.size() == 1);
      CHECK(lines[0].find("SCHED_FIFO 80 refused (Operation not permitted)") == 0);
      CHECK(lines[0].find("rtprio") != std::string::npos);
      if (memory.rlim_cur != RLIM_INFINITY) {
        const Grant* lock = find(process.grants(), "memory_lock");
        REQUIRE(lock);
        CHECK_FALSE(lock->granted);
        CHECK(lock->remedy.find("memlock") != std::string::npos);
      }
      const InheritedPriority readers(reader_priority(80));
      CHECK_FALSE(readers.grant()->granted);
    });
  }

  TEST_CASE("what was not requested is neither done nor reported") {
    const RealtimeProcess process(RealtimeOptions{});
    CHECK(process.grants().empty());
    CHECK_FALSE(InheritedPriority(0).grant());
    CHECK(reader_priority(0) == 0);
    CHECK(reader_priority(max_priority) == 99);
  }

  TEST_CASE("threads inherit the readers' priority while it is lent, and not afterwards") {
    std::thread([] {
      const auto scheduler_of_new_thread = [] {
        int scheduler = -1;
        std::thread([&] {
          sched_param parameter{};
          ::pthread_getschedparam(::pthread_self(), &scheduler, &parameter);
        }).join();
        return scheduler;
      };
      {
        const InheritedPriority lent(9);
        REQUIRE(lent.grant());
        CHECK((scheduler_of_new_thread() == SCHED_FIFO) == lent.grant()->granted);
      }
      CHECK(scheduler_of_new_thread() == SCHED_OTHER);
    }).join();
  }
}

} // namespace realtime_test
