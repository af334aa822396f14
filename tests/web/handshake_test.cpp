#include <doctest/doctest.h>

#include "web/web_socket.hpp"

namespace handshake_test {

using namespace nendo::web;

namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

std::string figures(const Sha1Digest& digest) {
  constexpr std::string_view names = "0123456789ABCDEF";
  std::string text;
  for (const std::byte byte : digest) {
    text += names[std::to_integer<unsigned>(byte) >> 4U];
    text += names[std::to_integer<unsigned>(byte) & 15U];
  }
  return text;
}

} // namespace

TEST_SUITE("handshake") {
  TEST_CASE("SHA-1 makes the digests that RFC 3174 has") {
    CHECK(figures(sha1(bytes_of("abc"))) == "A9993E364706816ABA3E25717850C26C9CD0D89D");
    CHECK(figures(sha1(bytes_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"))) ==
          "84983E441C3BD26EBAAE4AA1F95129E5E54670F1");
    CHECK(figures(sha1(bytes_of(std::string(1'000'000, 'a')))) ==
          "34AA973CD4C4DAA4F61EEB2BDBAD27316534016F");
    std::string tens;
    for (int n = 0; n < 80; ++n)
      tens += "01234567";
    CHECK(figures(sha1(bytes_of(tens))) == "DEA356A2CDDD90C7A7ECEDC5EBB563934F460452");
    CHECK(figures(sha1({})) == "DA39A3EE5E6B4B0D3255BFEF95601890AFD80709");
  }

  TEST_CASE("base64 is RFC 4648's") {
    const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}};
    for (const auto& [plain, encoded] : vectors)
      CHECK(base64(bytes_of(plain)) == encoded);
    CHECK(base64(bytes_of("\xFB\xFF\xFE")) == "+//+");
  }

  TEST_CASE("the answer to a key is RFC 6455's, section 1.3") {
    CHECK(accept_of("dGhlIHNhbXBsZSBub25jZQ==") == "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  }

  TEST_CASE("a key is what 16 bytes make, and nothing else is one") {
    CHECK(is_socket_key("dGhlIHNhbXBsZSBub25jZQ=="));
    CHECK(is_socket_key(base64(bytes_of("0123456789abcdef"))));
    for (const auto* wrong : {"", "==", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25jZQ===",
                              "dGhlIHNhbXBsZSBub25jZR==", "dGhlIHNhbXBsZSBub25j\r\n==",
                              "dGhlIHNhbXBsZSBub25j====", "dGhlIHNhbXBsZSBub25jZQZQ"})
      CHECK_FALSE(is_socket_key(wrong));
  }
}

} // namespace handshake_test
