#pragma once
// NENDO_API exports a symbol from a shared library. All other symbols are hidden, so that no
// program depends on private code. Most headers include this file through result.hpp.

#define NENDO_API __attribute__((visibility("default")))
