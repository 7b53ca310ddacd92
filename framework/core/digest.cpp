#include "framework/core/digest.h"

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

namespace tumble {
namespace {

using Bytes = std::array<unsigned char, EVP_MAX_MD_SIZE>;

// An incremental SHA-256.
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw std::runtime_error("libcrypto has no SHA-256");
  }
  void add(std::string_view bytes) {
    if (EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1)
      throw std::runtime_error("SHA-256 failed");
  }
  std::string end() {
    Bytes bytes{};
    unsigned size = 0;
    if (EVP_DigestFinal_ex(context_.get(), bytes.data(), &size) != 1)
      throw std::runtime_error("SHA-256 failed");
    return {reinterpret_cast<const char*>(bytes.data()), size};
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string hex(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string digest_bytes(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.end();
}

std::string digest(std::string_view bytes) { return hex(digest_bytes(bytes)); }

std::string digest_of_file(const std::filesystem::path& file) {
  std::error_code failed;
  // a pipe would wait for a writer
  if (!std::filesystem::is_regular_file(file, failed)) return "missing";
  std::ifstream in(file, std::ios::binary);
  if (!in) return "missing";
  Sha256 hash;
  std::array<char, 1 << 16> piece;
  while (in.read(piece.data(), piece.size()) || in.gcount() > 0)
    hash.add({piece.data(), static_cast<std::size_t>(in.gcount())});
  return in.bad() ? "missing" : hex(hash.end());
}

std::string authentication_code(std::string_view key, std::string_view bytes) {
  Bytes code{};
  unsigned size = 0;
  if (HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
           reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), code.data(),
           &size) == nullptr)
    throw std::runtime_error("libcrypto has no HMAC-SHA-256");
  return hex({reinterpret_cast<const char*>(code.data()), size});
}

bool is_same_code(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string random_bytes(std::size_t count) {
  std::string bytes(count, '\0');
  for (std::size_t got = 0; got < count;) {
    const ssize_t n = ::getrandom(bytes.data() + got, count - got, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw std::runtime_error("the system gives no random bytes");
    got += static_cast<std::size_t>(n);
  }
  return bytes;
}

}  // namespace tumble
