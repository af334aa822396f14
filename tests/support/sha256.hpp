#pragma once
// SHA-256 (FIPS 180-4), for tests that compute hashes of their own.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace nendo::test {

/// The first 32 bits of the fractions of the roots of the first primes.
template <std::size_t count>
std::array<std::uint32_t, count> root_bits(long double (*root)(long double)) {
  std::array<std::uint32_t, count> bits{};
  std::size_t at = 0;
  for (int number = 2; at < count; ++number) {
    bool is_prime = true;
    for (int divisor = 2; divisor * divisor <= number; ++divisor)
      is_prime = is_prime && number % divisor != 0;
    if (!is_prime) continue;
    const long double value = root(static_cast<long double>(number));
    bits[at++] = static_cast<std::uint32_t>((value - std::floor(value)) * 4294967296.0L);
  }
  return bits;
}

/// Returns the hash in hexadecimal digits.
inline std::string sha256(std::string_view text) {
  auto state = root_bits<8>([](long double x) { return std::sqrt(x); });
  const auto constants = root_bits<64>([](long double x) { return std::cbrt(x); });
  std::string message(text);
  message += '\x80';
  while (message.size() % 64 != 56)
    message += '\0';
  for (int shift = 56; shift >= 0; shift -= 8)
    message += static_cast<char>(std::uint64_t{8} * text.size() >> shift & 0xFFU);
  for (std::size_t block = 0; block < message.size(); block += 64) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t at = 0; at < 64; ++at)
      w[at / 4] = w[at / 4] << 8U | static_cast<unsigned char>(message[block + at]);
    for (std::size_t t = 16; t < 64; ++t) {
      const std::uint32_t a = w[t - 15], b = w[t - 2];
      w[t] = w[t - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3U) + w[t - 7] +
             (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10U);
    }
    auto [a, b, c, d, e, f, g, h] = state;
    for (std::size_t t = 0; t < 64; ++t) {
      const std::uint32_t t1 = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                               ((e & f) ^ (~e & g)) + constants[t] + w[t];
      const std::uint32_t t2 =
          (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
      h = std::exchange(g, std::exchange(f, std::exchange(e, d + t1)));
      d = std::exchange(c, std::exchange(b, std::exchange(a, t1 + t2)));
    }
    const std::array<std::uint32_t, 8> sums{a, b, c, d, e, f, g, h};
    for (std::size_t at = 0; at < 8; ++at)
      state[at] += sums[at];
  }
  std::string digits;
  for (const std::uint32_t word : state)
    for (int shift = 28; shift >= 0; shift -= 4)
      digits += "0123456789abcdef"[word >> shift & 0xFU];
  return digits;
}

} // namespace nendo::test
