#include "support/sleep_only.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

namespace nendo::test {
namespace {

thread_local StoppedCalls stopped;

// SECCOMP_RET_TRAP: the call was not made, and its result is what the handler leaves in its
// register.
void on_stopped_call(int, siginfo_t* info, void* context) {
  ++stopped.count;
  stopped.last = info->si_syscall;
  auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
  registers.gregs[REG_RAX] = -ENOSYS;
#elif defined(__aarch64__)
  registers.regs[0] = static_cast<unsigned long long>(-ENOSYS);
#endif
}

constexpr sock_filter allow_if(unsigned number, unsigned char to_allow) {
  return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number, to_allow, 0);
}

} // namespace

bool allow_sleep_only() noexcept {
  struct sigaction action{};
  action.sa_sigaction = on_stopped_call;
  action.sa_flags = SA_SIGINFO;
  if (::sigaction(SIGSYS, &action, nullptr) != 0) return false;
  std::array<sock_filter, 8> rules{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      allow_if(SYS_clock_nanosleep, 5),
      allow_if(SYS_getrusage, 4),
      allow_if(SYS_rt_sigreturn, 3),
      allow_if(SYS_exit, 2),
      allow_if(SYS_exit_group, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  const sock_fprog program{static_cast<unsigned short>(rules.size()), rules.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

StoppedCalls stopped_calls() noexcept {
  return stopped;
}

void end_thread() noexcept {
  for (;;)
    ::syscall(SYS_exit, 0);
}

} // namespace nendo::test
