#pragma once
// The figures of the paper's Table 1 (Sato, Savchenko, Ohbuchi 2004), measured on an Athlon 64
// 3400+ with drawing. Rows are meshes and columns are radii, as in table1.hpp.

#include <array>
#include <cstddef>

namespace nendo::bench {

template <class T>
using Table1Figures = std::array<std::array<T, 5>, 4>;

inline constexpr std::array<std::size_t, 4> table1_triangles{2048, 8192, 32768, 65536};

/// For radius 60 and the third mesh the paper prints 115812, which does not fit its row and column;
/// 155812 differs in one digit and fits both.
inline constexpr Table1Figures<std::size_t> paper_evaluations{{
    {698, 2414, 7342, 10124, 10890},
    {2646, 9526, 28686, 39476, 42250},
    {10510, 37562, 113282, 155812, 166410},
    {20790, 74482, 225714, 309476, 330250},
}};

/// Frames per second.
inline constexpr Table1Figures<double> paper_type1{{
    {496.3, 502.1, 499.2, 427.4, 423.6},
    {162.6, 138.0, 119.7, 113.1, 112.0},
    {41.3, 34.8, 30.0, 28.2, 28.0},
    {20.0, 16.7, 14.4, 13.6, 13.4},
}};
inline constexpr Table1Figures<double> paper_type2{{
    {446.3, 427.6, 380.2, 367.0, 364.0},
    {132.6, 114.4, 101.5, 97.5, 96.1},
    {32.9, 28.2, 24.9, 23.9, 23.4},
    {15.9, 13.5, 11.9, 11.4, 10.9},
}};

} // namespace nendo::bench
