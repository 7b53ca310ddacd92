#include "framework/grading/compiler/page_module.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/grading/compiler/build_module.h"
#include "framework/grading/compiler/compile.h"
#include "framework/grading/compiler/compiler_words.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// bytes: a1 has 50,000, with all of iostream 400,000; a page carries it, packed to a third
constexpr std::size_t kLargest = 1u << 20;

constexpr const char* kOwnImports[] = {"tumble.threw", "tumble.callback"};
// WASI: of a program that prints or asks for the time. The page answers each with an error.
constexpr const char* kSystemImports = "wasi_snapshot_preview1.";

/// Reads a module's bytes, which a hostile source has made.
class WasmReader {
 public:
  explicit WasmReader(std::string_view bytes) : left_(bytes) {}
  bool is_good() const { return good_; }
  bool at_end() const { return left_.empty(); }

  std::uint8_t byte() { return left_.empty() ? fail() : static_cast<std::uint8_t>(take(1)[0]); }

  // unsigned LEB128 of 32 bits
  std::uint32_t number() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const std::uint8_t next = byte();
      value |= std::uint64_t{next & 127u} << shift;
      if (next < 128) return value <= UINT32_MAX ? static_cast<std::uint32_t>(value) : fail();
    }
    return fail();
  }

  std::string_view text(std::size_t length) {
    if (length > left_.size()) return fail(), std::string_view();
    return take(length);
  }

 private:
  std::string_view take(std::size_t length) {
    const std::string_view taken = left_.substr(0, length);
    left_.remove_prefix(length);
    return taken;
  }
  std::uint8_t fail() {
    good_ = false;
    left_ = {};
    return 0;
  }
  std::string_view left_;
  bool good_ = true;
};

constexpr std::uint8_t kImportSection = 2;

// A function has the number of its type. This program lets nothing else be imported: a table,
// memory or global of a name that no page gives.
bool read_imports(std::string_view section, std::vector<std::string>& imports) {
  WasmReader in(section);
  for (std::uint32_t left = in.number(); left > 0 && in.is_good(); --left) {
    const std::string module(in.text(in.number()));
    const std::string name(in.text(in.number()));
    if (in.byte() != 0) return false;
    in.number();
    imports.push_back(module + '.' + name);
  }
  return in.is_good() && in.at_end();
}

std::string refusal(const std::string& wasm) {
  if (wasm.size() > kLargest)
    return fmt::format("it makes {} kB of WebAssembly; a page takes up to {} kB",
                       wasm.size() / 1000, kLargest / 1000);
  const auto imports = imports_of(wasm);
  if (!imports) return "what the compiler made is no module of WebAssembly that a page runs";
  for (const std::string& import : *imports)
    if (std::find(std::begin(kOwnImports), std::end(kOwnImports), import) ==
            std::end(kOwnImports) &&
        !import.starts_with(kSystemImports))
      return fmt::format("it calls {}, which no page has", import.substr(0, 200));
  return "";
}

}  // namespace

std::vector<std::string> missing_page_packages() {
  constexpr const char* kFiles[][2] = {
      {"clang-14", "/usr/bin/clang++-14"},
      {"lld-14", "/usr/bin/wasm-ld-14"},
      {"wasi-libc", "/usr/lib/wasm32-wasi/libc.a"},
      {"libc++-14-dev-wasm32", "/usr/lib/wasm32-wasi/libc++.a"},
      {"libclang-rt-14-dev-wasm32",
       "/usr/lib/llvm-14/lib/clang/14.0.6/lib/wasi/libclang_rt.builtins-wasm32.a"}};
  std::vector<std::string> missing;
  for (const auto& [package, file] : kFiles)
    if (!fs::exists(file)) missing.emplace_back(package);
  return missing;
}

std::optional<std::vector<std::string>> imports_of(std::string_view wasm) {
  using namespace std::string_view_literals;
  if (!wasm.starts_with("\0asm\1\0\0\0"sv)) return std::nullopt;
  WasmReader in(wasm.substr(8));
  std::vector<std::string> imports;
  while (!in.at_end()) {
    const std::uint8_t section = in.byte();
    const std::string_view content = in.text(in.number());
    if (!in.is_good()) return std::nullopt;
    if (section == kImportSection && !read_imports(content, imports)) return std::nullopt;
  }
  return imports;
}

PageCompiler::PageCompiler(fs::path root, fs::path build, std::string id, std::string folder)
    : root_(std::move(root)),
      build_(std::move(build)),
      id_(std::move(id)),
      name_(std::move(folder)) {
  if (const auto missing = missing_page_packages(); !missing.empty()) {
    obstacle_ =
        fmt::format("the grader's machine lacks {}. apt-get install --no-install-recommends {}",
                    fmt::join(missing, " "), kPagePackages);
    return;
  }
  const fs::path source = folder_.path() / "bridge.cpp";
  write_whole(source, fmt::format("#include \"{}\"\n#include \"framework/modules/in_page.h\"\n"
                                  "TUMBLE_IN_PAGE({});\n",
                                  header_in(name_).string(), id_));
  CompileJob job{root_, header_in(name_), source, folder_.path() / "bridge.o", {}, id_, build_};
  job.form = CompileJob::Form::kBridge;
  const Compiled compiled = compile_submission(job);
  if (compiled.outcome != Compiled::Outcome::kBuilt)
    obstacle_ =
        "the page's side of the module cannot be compiled: " + compiled.said.substr(0, 2000);
}

PageModule PageCompiler::compile(const fs::path& source) const {
  if (!obstacle_.empty()) return {"", obstacle_};
  const PrivateFolder place;
  CompileJob job{root_, header_in(name_), source, place.path() / "module.wasm", {}, id_, build_};
  job.form = CompileJob::Form::kPage;
  job.bridge = folder_.path() / "bridge.o";
  const Compiled compiled = compile_submission(job);
  if (compiled.outcome != Compiled::Outcome::kBuilt)
    return {"", "clang does not compile it for a page: " +
                    compiler_story(compiled.said, source, root_ / header_in(name_))};
  const std::string wasm = text_of(job.object);
  if (const std::string why = refusal(wasm); !why.empty()) return {"", why};
  return {wasm, ""};
}

}  // namespace tumble::grading
