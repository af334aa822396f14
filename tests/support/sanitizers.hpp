#pragma once
// Which sanitizer a test is compiled with. GCC tells about them by these names, and Clang by
// __has_feature.

#if defined(__has_feature)
#define NENDO_HAS_FEATURE(feature) __has_feature(feature)
#else
#define NENDO_HAS_FEATURE(feature) 0
#endif

#if defined(__SANITIZE_THREAD__) || NENDO_HAS_FEATURE(thread_sanitizer)
#define NENDO_WATCHES_THREADS 1
#else
#define NENDO_WATCHES_THREADS 0
#endif

#if defined(__SANITIZE_ADDRESS__) || NENDO_HAS_FEATURE(address_sanitizer)
#define NENDO_WATCHES_MEMORY 1
#else
#define NENDO_WATCHES_MEMORY 0
#endif
