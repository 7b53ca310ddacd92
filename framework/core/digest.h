/// SHA-256 and HMAC-SHA-256 (OpenSSL's libcrypto): records identify bytes by a digest, and grading
/// verifies its own records by a code.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tumble {

/// @return SHA-256 (FIPS 180-4) of the bytes, 64 hex digits
std::string digest(std::string_view bytes);
/// The same, as 32 bytes.
std::string digest_bytes(std::string_view bytes);
/// Digest of a file's bytes, read in blocks; "missing" where the file cannot be read.
std::string digest_of_file(const std::filesystem::path& file);

/// @return HMAC-SHA-256 (RFC 2104) of the bytes under the key, 64 hex digits
std::string authentication_code(std::string_view key, std::string_view bytes);
/// Compares two codes in a time that does not depend on where they differ.
bool is_same_code(std::string_view a, std::string_view b);

/// @return `count` unpredictable bytes (getrandom)
std::string random_bytes(std::size_t count);

/// Bytes as lower-case hex digits.
std::string hex(std::string_view bytes);

}  // namespace tumble
