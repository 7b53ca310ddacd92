/// From a source that somebody handed in to WebAssembly that a page runs.
///
/// It is compiled in the sandbox, with the limits of compile.h, by clang-14 and wasm-ld-14 with
/// wasi-libc and libc++: packages that a machine may lack. What comes out is data to this program:
/// of its bytes only the head and the imports are read. The browser checks the rest and gives the
/// module no more than modules/in_page.h says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/files.h"

namespace tumble::grading {

/// Debian's packages that compile for pages, in one line for apt-get.
inline constexpr const char* kPagePackages =
    "clang-14 lld-14 wasi-libc libc++-14-dev-wasm32 libclang-rt-14-dev-wasm32";

/// Packages of kPagePackages that this machine lacks, by their files; empty: all are there.
std::vector<std::string> missing_page_packages();

struct PageModule {
  std::string wasm;     // the module's bytes; empty where it could not be made
  std::string why_not;  // what the compiler said, cut short, or another obstacle
};

/// Functions that a module imports, as "module.name", in its order.
/// @return nothing where the bytes are no module of WebAssembly, or say so in no known way
/// Source: WebAssembly core specification 1.0, section 5.5
std::optional<std::vector<std::string>> imports_of(std::string_view wasm);

/// Compiles modules of one assignment for pages.
class PageCompiler {
 public:
  /// Compiles the page's side of the waist, once.
  /// @param root, build, id, folder  as for build_module
  /// @throws UserError when the module's header is missing
  PageCompiler(std::filesystem::path root, std::filesystem::path build, std::string id,
               std::string folder);

  /// Why nothing can be compiled here; empty where it can.
  const std::string& obstacle() const { return obstacle_; }

  /// Never throws because of the source. Cost: 2 s of CPU time
  PageModule compile(const std::filesystem::path& source) const;

 private:
  PrivateFolder folder_;
  std::filesystem::path root_, build_;
  std::string id_, name_, obstacle_;
};

}  // namespace tumble::grading
