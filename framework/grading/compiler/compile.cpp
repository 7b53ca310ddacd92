#include "framework/grading/compiler/compile.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/utf8.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/grading/sandbox/sandbox.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Ending = SandboxOutcome::Ending;
using Outcome = Compiled::Outcome;

constexpr std::size_t kObjectBytes = 32u << 20;  // a module is 200 kB
constexpr const char* kHeadersInside = "/headers";
constexpr const char* kSourceInside = "/submission";
constexpr const char* kPrecompiled = "precompiled.h";
constexpr const char* kKernels = "libkernels.a";

constexpr const char* kWorkerInside = "/worker.o";

// The compiler may fork its passes, and links to a temporary folder. The object leaves the sandbox
// through descriptor 3, not through a shared folder. Arguments: the file's name, then what
// kHeadersInside, kSourceInside, kTmpInside and kWorkerInside are called in the sandbox that runs
// it, the name that the module exports, and the library of precompiled.h, or nothing.
#define TUMBLE_COMPILE                                                                        \
  "cd \"$3\" && /usr/bin/g++ " TUMBLE_SUBMISSION_FLAGS                                        \
  " -Wall -Wextra -Wno-unused-parameter -fdiagnostics-color=never -fmax-errors=20 -I \"$2\" " \
  "-ffile-prefix-map=\"$2\"=/headers -ffile-prefix-map=\"$3\"=/submission "                   \
  "-isystem " TUMBLE_EIGEN_INCLUDE " -include \"$2/precompiled.h\" -x c++ \"$1\" -x none "
constexpr const char* kToSharedObject = TUMBLE_COMPILE
    "${7:+\"$7\"} -shared -Wl,-z,defs -o \"$4/module\" && exec cat \"$4/module\" >&3";
// Only the module's table stays visible to the worker: a main() or an operator new of the
// submission replaces nothing in it.
constexpr const char* kToWorker = TUMBLE_COMPILE
    "-c -o \"$4/own.o\" && ld -r --force-group-allocation \"$4/own.o\" ${7:+\"$7\"} -o "
    "\"$4/module.o\" && "
    "objcopy --keep-global-symbol=\"$6\" \"$4/module.o\""
    " && /usr/bin/g++ -static-pie \"$5\" \"$4/module.o\" -o \"$4/module\" && exec cat "
    "\"$4/module\" >&3";
// Own tests: dynamic, because GoogleTest and fmt are of the system. No table of a module is
// exported.
constexpr const char* kToTests =
    "cd \"$3\" && /usr/bin/g++ " TUMBLE_SUBMISSION_FLAGS
    " -Wall -Wextra -Wno-unused-parameter -fdiagnostics-color=never -fmax-errors=20 -I \"$2\" "
    "-ffile-prefix-map=\"$2\"=/headers -ffile-prefix-map=\"$3\"=/submission "
    "-isystem " TUMBLE_EIGEN_INCLUDE
    " -include \"$2/precompiled.h\" -include \"$2/own_tests.h\" -x c++ \"$1\" -x none \"$5\" "
    "${7:+\"$7\"} -lgtest -lfmt -lcrypto -o \"$4/module\" && exec cat \"$4/module\" >&3";
#undef TUMBLE_COMPILE

// To WebAssembly, with every library inside: no import but those of modules/in_page.h and of WASI.
// eigen_assert ends the call, as where it is graded, without its words.
#define TUMBLE_COMPILE_FOR_PAGE                                                             \
  "cd \"$3\" && /usr/bin/clang++-14 --target=wasm32-wasi -std=c++20 -O2 -ffp-contract=off " \
  "-fno-finite-loops -fexceptions "                                                         \
  "'-Deigen_assert(x)=((x)?(void)0:__builtin_trap())' -w -fno-color-diagnostics "           \
  "-ferror-limit=20 -I \"$2\" -isystem " TUMBLE_EIGEN_INCLUDE " -x c++ -c \"$1\" -o "
constexpr const char* kToBridge =
    TUMBLE_COMPILE_FOR_PAGE "\"$4/module\" && exec cat \"$4/module\" >&3";
constexpr const char* kToPage = TUMBLE_COMPILE_FOR_PAGE
    "\"$4/own.o\" -DTUMBLE_BUILDING_MODULE && /usr/bin/clang++-14 --target=wasm32-wasi "
    "-mexec-model=reactor -Wl,--no-entry "
    "-Wl,--strip-all -Wl,--gc-sections -Wl,--threads=1 -Wl,-z,stack-size=1048576 "
    "-Wl,--max-memory=67108864 \"$4/own.o\" \"$5\" -o \"$4/module\" && exec cat \"$4/module\" >&3";
#undef TUMBLE_COMPILE_FOR_PAGE

const char* command_of(CompileJob::Form form, bool links_worker) {
  switch (form) {
    case CompileJob::Form::kBridge: return kToBridge;
    case CompileJob::Form::kPage: return kToPage;
    case CompileJob::Form::kTests: return kToTests;
    case CompileJob::Form::kModule: break;
  }
  return links_worker ? kToWorker : kToSharedObject;
}

// Headers of the tree that a text includes, directly or indirectly, restricted to those that
// students have.
void collect_headers(const fs::path& root, const std::string& text, std::set<std::string>& found,
                     const std::string& tests = "") {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const std::string name = included_in_quotes(line);
    const bool is_of_tests =
        !tests.empty() && (name.starts_with(tests) || name == "tests/support/story.h");
    const bool students =
        name.starts_with("framework/") || name.starts_with("assignments/") || is_of_tests;
    if (!students || !name.ends_with(".h") || name.find("..") != std::string::npos) continue;
    if (!fs::is_regular_file(root / name) || !found.insert(name).second) continue;
    collect_headers(root, text_of(root / name), found, tests);
  }
}

// The precompiled header of this build, and the library that it needs; without them compilation
// takes longer. Copying the header's 250 MB would take 0.1 to 0.4 s of each compilation.
// @param is_unwritable  what runs inside cannot change a file of this user
// @return whether there is a library
bool stage_precompiled(Stage& headers, const fs::path& build, bool is_unwritable, SandboxJob& job) {
  const fs::path folder = build.empty() ? fs::path(TUMBLE_SUBMISSION_SDK)
                                        : build / fs::path(TUMBLE_SUBMISSION_SDK).filename();
  const std::string name = std::string(kPrecompiled) + ".gch",
                    text = text_of(folder / kPrecompiled);
  const fs::path binary = folder / name;
  const bool is_made = fs::exists(binary) && fs::exists(folder / kKernels);
  headers.add_text(is_made ? text : "#define TUMBLE_NO_KERNELS\n" + text, kPrecompiled);
  if (!is_made) return false;
  headers.add_file(folder / kKernels, kKernels);
  if (is_unwritable && headers.link_file(binary, name)) return true;
  if (job.kind == SandboxKind::kNamespaces && headers.can_be_shown(binary)) {
    headers.add_text("", name);  // what it is bound over
    job.binds.push_back({fs::canonical(binary), std::string(kHeadersInside) + "/" + name});
  } else {
    headers.add_file(binary, name);
  }
  return true;
}

// One of bin/ of the build tree.
fs::path program(const fs::path& build, const std::string& name) {
  const fs::path file =
      (build.empty() ? fs::canonical("/proc/self/exe").parent_path() : build / "bin") / name;
  if (!fs::exists(file))
    throw UserError(file.string(), "is not built",
                    "Build the target " + file.stem().string() + ".");
  return file;
}

// Everything from the pipe, up to one byte above the limit, which shows that the limit was
// exceeded.
std::string drain(int fd) {
  std::string bytes;
  char buffer[1 << 16];
  while (bytes.size() <= kObjectBytes) {
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    bytes.append(buffer, static_cast<std::size_t>(n));
  }
  return bytes;
}

bool says(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words)
    if (text.find(word) != std::string::npos) return true;
  return false;
}

Compiled judge(const SandboxOutcome& outcome, const std::string& object,
               const CompileLimits& limits) {
  const std::string& said = outcome.printed;
  switch (outcome.ending) {
    case Ending::kNotStarted:
    case Ending::kStopped: return {Outcome::kGraderFault, "the sandbox did not start: " + said};
    case Ending::kWallLimit:
      return {Outcome::kGraderFault,
              "the machine was too busy: the compiler had not finished after " +
                  std::to_string(static_cast<int>(limits.wall_s)) +
                  " s, and had computed for less than " + std::to_string(limits.cpu_s) +
                  " s. Run it again when the machine is less busy"};
    case Ending::kStalled:
      return {Outcome::kOutOfResources,
              "the compiler made no progress: it waits for something, such as an #include of "
              "something that is not a file"};
    case Ending::kDiskLimit:
      return {Outcome::kOutOfResources, "the compiler ran out of room for files\n" + said};
    case Ending::kOutputLimit:
      return {
          Outcome::kOutOfResources,
          "the compiler's messages exceeded their limit; the first were:\n" + said.substr(0, 2000)};
    case Ending::kSignal: return {Outcome::kOutOfResources, "a limit ended the compiler\n" + said};
    case Ending::kExited: break;
  }
  if (outcome.code == 0 && object.size() > kObjectBytes)
    return {Outcome::kOutOfResources, "the compiled module is larger than 32 MiB"};
  if (outcome.code == 0 && !object.empty()) return {Outcome::kBuilt, said};
  if (says(said, {"out of memory", "virtual memory exhausted", "CPU time limit", "File size limit",
                  "No space left", "file too large", "Killed"}))
    return {Outcome::kOutOfResources,
            "the compiler ran out of time, memory or room for files\n" + said};
  if (outcome.code == 127)
    return {Outcome::kGraderFault, "the compiler cannot be started: " + said};
  return {Outcome::kRefused, said};
}

SandboxJob sandbox_job(const CompileLimits& limits) {
  SandboxJob job;
  job.kind = chosen_sandbox();
  job.limits.wall_s = limits.wall_s;
  job.limits.cpu_s = limits.cpu_s;
  job.limits.stall_s = limits.stall_s;
  job.limits.memory_bytes = limits.memory_bytes;
  job.limits.tmp_bytes = 128ull << 20;
  job.limits.processes = 16;
  return job;
}

}  // namespace

Compiled compile_submission(const CompileJob& job) {
  std::error_code ignored;
  fs::remove(job.object, ignored);
  if (!fs::exists(job.root / job.header))
    throw UserError((job.root / job.header).string(), "there is no such header",
                    "It declares the functions of the module.");
  const std::string name = job.source.filename().string();
  std::string why;
  const auto source = read_plain_file(job.source, job.limits.source_bytes, why);
  if (!source) return {Outcome::kRefused, name + ": " + why};
  if (const auto no_text = why_no_text(*source))
    return {Outcome::kRefused,
            name + ":1:1: error: the file " + no_text->problem + ". " + no_text->remedy};

  const bool is_native = job.form == CompileJob::Form::kModule,
             is_tests = job.form == CompileJob::Form::kTests;
  const std::string header = job.header.string(),
                    tests = is_tests ? "tests/" + job.header.parent_path().filename().string() + "/"
                                     : "";
  std::set<std::string> needed;
  collect_headers(job.root, *source, needed, tests);
  if (is_native && !needed.contains(header))
    if (const std::string why = why_nothing(name, *source, job.header); !why.empty())
      return {Outcome::kRefused, why};
  if (needed.insert(header).second) collect_headers(job.root, text_of(job.root / header), needed);

  const SandboxUser user = SandboxUser::lease();
  Stage headers(&user), submission(&user), tools(&user);
  for (const std::string& file : needed) headers.add_file(job.root / file, file);
  SandboxJob inside = sandbox_job(job.limits);
  const bool is_unwritable = inside.kind == SandboxKind::kNamespaces || user.uid().has_value();
  inside.binds = {{headers.path(), kHeadersInside}, {submission.path(), kSourceInside}};
  const bool has_kernels =
      (is_native || is_tests) && stage_precompiled(headers, job.build, is_unwritable, inside);
  if (is_tests)
    headers.add_text("#undef TUMBLE_BUILDING_MODULE\n#include <gtest/gtest.h>\n", "own_tests.h");
  submission.add_text(*source, name);

  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return {Outcome::kGraderFault, "no descriptor left for a compiler"};
  if (traits_of(inside.kind).needs_init)
    inside.init = tools.add_file(program(job.build, "sandbox_init"), "init", true);
  // A name such as "-o" or "@file" must not be read as an option.
  const bool plain_name = std::isalnum(static_cast<unsigned char>(name[0])) != 0 || name[0] == '_';
  const bool links_worker = traits_of(inside.kind).links_worker && is_native;
  if (links_worker || is_tests)
    inside.binds.push_back(
        {tools.add_file(program(job.build, (is_tests ? "own_tests_" : "worker_") + job.id + ".o"),
                        "worker.o"),
         kWorkerInside});
  if (job.form == CompileJob::Form::kPage)
    inside.binds.push_back({tools.add_file(job.bridge, "bridge.o"), kWorkerInside});
  inside.command = {"/usr/bin/sh",
                    "-c",
                    command_of(job.form, links_worker),
                    "compile",
                    plain_name ? name : "./" + name,
                    kHeadersInside,
                    kSourceInside,
                    kTmpInside,
                    kWorkerInside,
                    "tumble_functions_" + job.id,
                    has_kernels ? std::string(kHeadersInside) + "/" + kKernels : ""};
  inside.uid = user.uid();
  inside.channel = ends[1];
  Sandbox sandbox = Sandbox::start(inside);
  ::close(ends[1]);
  const std::string object = drain(ends[0]);
  ::close(ends[0]);
  Compiled compiled = judge(sandbox.wait(), object, job.limits);
  if (compiled.outcome != Outcome::kBuilt) return compiled;
  std::ofstream out(job.object, std::ios::binary);
  out << object;
  out.close();
  if (!out) throw UserError(job.object.string(), "cannot be written");
  return compiled;
}

}  // namespace tumble::grading
