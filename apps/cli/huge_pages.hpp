#pragma once
// Huge pages for commands that fill large memory.

namespace nendo::cli {

/// Makes the C library request huge pages if the kernel gives them only on request
/// (transparent_hugepage/enabled is "madvise"). For commands that fill large memory once, where
/// faults of 4 KiB pages can take more time than the model (../../deform/CUTTING.md has
/// measurements). The library reads the option at program start (GLIBC_TUNABLES,
/// glibc.malloc.hugetlb=1, glibc 2.35 and newer), so this executes the program again, in the same
/// process. Keeps an existing value of glibc.malloc.hugetlb, such as 0. On failure it returns,
/// without effect. Call it first in main().
void use_huge_pages(char** argv) noexcept;

} // namespace nendo::cli
