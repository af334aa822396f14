#pragma once
// Large memory in huge pages. What cuts, joins or writes a large model fills memory once, and may
// spend more time on pages of 4 KiB than on the model (../../deform/CUTTING.md has figures).

namespace nendo::cli {

/// Lets the C library ask the kernel for huge pages, where the kernel gives them only to those who
/// ask (transparent_hugepage/enabled is "madvise"). The library reads that wish at a program's
/// start (GLIBC_TUNABLES, glibc.malloc.hugetlb=1, glibc 2.35 and newer), so this starts the program
/// once more, in the same process. Whoever sets glibc.malloc.hugetlb, to 0 for instance, is obeyed.
/// If it cannot be done, it returns, and the program continues as it is. Call it first in main().
void use_huge_pages(char** argv) noexcept;

} // namespace nendo::cli
