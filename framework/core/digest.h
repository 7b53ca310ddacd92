/// SHA-256 and HMAC-SHA-256 (OpenSSL's libcrypto): how records name bytes, and how grading trusts its own records.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tumble {

/// @return SHA-256 (FIPS 180-4) of the bytes, 64 hex digits
std::string digest(std::string_view bytes);
/// Of a file's bytes, read piece by piece; of no file the word "missing".
std::string digest_of_file(const std::filesystem::path& file);

/// @return HMAC-SHA-256 (RFC 2104) of the bytes under the key, 64 hex digits
std::string authentication_code(std::string_view key, std::string_view bytes);
/// Compares two codes in a time that does not depend on where they differ.
bool is_same_code(std::string_view a, std::string_view b);

/// @return `count` bytes that nobody can foresee (getrandom)
std::string random_bytes(std::size_t count);

/// Bytes as lower-case hex digits.
std::string hex(std::string_view bytes);

}  // namespace tumble
