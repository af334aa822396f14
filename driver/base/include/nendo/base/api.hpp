#pragma once
// NENDO_API marks what a library defines and programs may use. Shared libraries hide all other
// names, so that no program depends on a private part. Most headers have it by way of result.hpp.

#define NENDO_API __attribute__((visibility("default")))
