#include "support/restraint.hpp"

#include <cerrno>
#include <cstddef>

#include <dlfcn.h>
#include <pthread.h>

namespace {

// Plain thread-locals of an executable need no allocation of their own.
thread_local bool counting = false;
thread_local nendo::test::RestraintCounts counts;

#if NENDO_COUNTS_RESTRAINT
void count_allocation() noexcept {
  if (counting) ++counts.allocations;
}
void count_lock() noexcept {
  if (counting) ++counts.locks;
}

template <class Function>
Function next(const char* name) noexcept {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}
#endif

} // namespace

namespace nendo::test {

Restraint::Restraint() noexcept {
  ::counts = {};
  counting = true;
}
Restraint::~Restraint() noexcept {
  counting = false;
}
RestraintCounts Restraint::counts() const noexcept {
  return ::counts;
}

} // namespace nendo::test

#if NENDO_COUNTS_RESTRAINT
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): glibc's own names
// glibc's own entry points, and these definitions in the program take their callers' place. They
// are not hidden, so that shared libraries find them.
#pragma GCC visibility push(default)
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  count_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  count_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  count_allocation();
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count_allocation();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count_allocation();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
void free(void* pointer) {
  if (counting && pointer != nullptr) ++counts.frees;
  __libc_free(pointer);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static const auto real = next<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  count_lock();
  return real(mutex);
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static const auto real = next<int (*)(pthread_mutex_t*)>("pthread_mutex_trylock");
  count_lock();
  return real(mutex);
}
int pthread_cond_signal(pthread_cond_t* condition) {
  static const auto real = next<int (*)(pthread_cond_t*)>("pthread_cond_signal");
  count_lock();
  return real(condition);
}
int pthread_cond_broadcast(pthread_cond_t* condition) {
  static const auto real = next<int (*)(pthread_cond_t*)>("pthread_cond_broadcast");
  count_lock();
  return real(condition);
}
int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static const auto real = next<int (*)(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
  count_lock();
  return real(condition, mutex);
}
}
#pragma GCC visibility pop
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
#endif
