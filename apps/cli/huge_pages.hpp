#pragma once
// Large memory in huge pages. What cuts, joins or writes a large model fills memory once, and may
// spend more time on pages of 4 KiB than on the model (../../deform/CUTTING.md has figures).

namespace nendo::cli {

/// Lets the C library ask the kernel for huge pages, if the kernel gives them only on request
/// (transparent_hugepage/enabled is "madvise"). The library reads that option at a program's start
/// (GLIBC_TUNABLES, glibc.malloc.hugetlb=1, glibc 2.35 and newer), so this starts the program once
/// more, in the same process. An existing value of glibc.malloc.hugetlb, such as 0, is kept. If it
/// cannot be done, it returns, and the program continues as it is. Call it first in main().
void use_huge_pages(char** argv) noexcept;

} // namespace nendo::cli
