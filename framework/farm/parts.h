/// Independent pieces of one work (chains of a scene, points of a sweep), each made by itself,
/// perhaps by another process or on another machine. The result of each lies in a file of its own,
/// written whole by a rename, so that what is finished outlives whoever made it and a later start
/// takes it over:
///   FOLDER/NAME.part    "tumble part KEY DIGEST", a new line, then the result's bytes
///   FOLDER/NAME.error   the same, with what kept the piece from being made
/// A file of another key, or one whose bytes are not those of its digest, counts as missing.
#pragma once

#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace tumble::farm {

class KeptParts {
 public:
  /// @param key  a digest of all that decides the results: program, scene, options, laws
  KeptParts(std::filesystem::path folder, std::string key)
      : folder_(std::move(folder)), key_(std::move(key)) {}

  /// From here until this object ends no other command makes the same pieces in the folder: it
  /// could forget what this one has finished. Each shard is held by itself.
  /// @param shard  "2/8"; empty: the whole
  /// @throws UserError when another command holds it, or nothing can be written there
  void hold(const std::string& shard);

  /// The bytes of a finished piece; nothing where it is missing.
  std::optional<std::string> result(const std::string& name) const;
  bool has(const std::string& name) const { return result(name).has_value(); }
  /// @throws UserError when the file cannot be written
  void put(const std::string& name, std::string_view bytes) const;
  /// The piece is made again.
  void forget(const std::string& name) const;

  /// Leaves an exception for the process that waits for the piece.
  void put_error(const std::string& name, std::exception_ptr error) const;
  /// Throws it there, as the class that it was: UserError, NotImplemented, or a runtime_error.
  void rethrow_error(const std::string& name) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::optional<std::string> read(const std::filesystem::path& file) const;
  void write(const std::filesystem::path& file, std::string_view bytes) const;

  std::filesystem::path folder_;
  std::string key_;
  std::shared_ptr<const int> held_;  // descriptor of the locked file
};

}  // namespace tumble::farm
