#include "explorer/fibre.hpp"

#include <array>
#include <cassert>
#include <cstddef>
#include <ucontext.h>
#include <utility>

// Sanitizers keep a model of each stack and must hear of every switch. GCC defines macros, Clang
// has
// __has_feature.
#if defined(__has_feature)
#define NENDO_ASAN __has_feature(address_sanitizer)
#define NENDO_TSAN __has_feature(thread_sanitizer)
#else
#ifdef __SANITIZE_ADDRESS__
#define NENDO_ASAN 1
#endif
#ifdef __SANITIZE_THREAD__
#define NENDO_TSAN 1
#endif
#endif
#if NENDO_ASAN
#include <sanitizer/common_interface_defs.h>
#endif
#if NENDO_TSAN
#include <sanitizer/tsan_interface.h>
#endif

namespace nendo::explorer {
namespace {

Fibre* entering = nullptr; // makecontext() passes no pointer

} // namespace

struct Fibre::Context {
  ucontext_t inside{};
  ucontext_t outside{};
  std::array<std::byte, std::size_t{256} * 1024> stack;
#if NENDO_ASAN
  void* inside_fake_stack = nullptr;
  void* outside_fake_stack = nullptr;
  const void* outside_stack = nullptr;
  std::size_t outside_stack_bytes = 0;
#endif
#if NENDO_TSAN
  void* inside_fibre = __tsan_create_fiber(0);
  void* outside_fibre = nullptr;
#endif
};

Fibre::Fibre() : context_(new Context) {
  [[maybe_unused]] const int failed = getcontext(&context_->inside);
  assert(failed == 0);
  context_->inside.uc_stack.ss_sp = context_->stack.data();
  context_->inside.uc_stack.ss_size = context_->stack.size();
  context_->inside.uc_link = nullptr; // it never returns
  makecontext(&context_->inside, &Fibre::enter, 0);
}

Fibre::~Fibre() {
  assert(done());
#if NENDO_TSAN
  __tsan_destroy_fiber(context_->inside_fibre);
#endif
}

void Fibre::start(std::function<void()> body) {
  assert(done());
  body_ = std::move(body);
}

void Fibre::resume() {
  entering = this;
#if NENDO_ASAN
  __sanitizer_start_switch_fiber(&context_->outside_fake_stack, context_->stack.data(),
                                 context_->stack.size());
#endif
#if NENDO_TSAN
  context_->outside_fibre = __tsan_get_current_fiber();
  __tsan_switch_to_fiber(context_->inside_fibre, 0);
#endif
  swapcontext(&context_->outside, &context_->inside);
#if NENDO_ASAN
  __sanitizer_finish_switch_fiber(context_->outside_fake_stack, nullptr, nullptr);
#endif
}

void Fibre::suspend() {
#if NENDO_ASAN
  __sanitizer_start_switch_fiber(&context_->inside_fake_stack, context_->outside_stack,
                                 context_->outside_stack_bytes);
#endif
#if NENDO_TSAN
  __tsan_switch_to_fiber(context_->outside_fibre, 0);
#endif
  swapcontext(&context_->inside, &context_->outside);
#if NENDO_ASAN
  __sanitizer_finish_switch_fiber(context_->inside_fake_stack, &context_->outside_stack,
                                  &context_->outside_stack_bytes);
#endif
}

void Fibre::enter() {
  Fibre& self = *entering;
#if NENDO_ASAN
  __sanitizer_finish_switch_fiber(nullptr, &self.context_->outside_stack,
                                  &self.context_->outside_stack_bytes);
#endif
  for (;;) {
    self.body_();
    self.body_ = nullptr;
    self.suspend();
  }
}

} // namespace nendo::explorer
