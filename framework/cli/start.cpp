// tumble start a1 FOLDER: a folder to work in, with the student's file and what is read beside it.
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/command.h"
#include "framework/cli/words.h"
#include "framework/core/files.h"
#include "framework/modules/names.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

std::string readme_of(const modules::ModuleName& name, const std::string& check,
                      const fs::path& root, bool has_tests) {
  return fmt::format(R"(# {title} ({id})

- `{folder}.cpp`: **your file**. Every function throws "not implemented" until you write it.
  Hand in this one file.
- `{folder}.h`: what each function must do: equation, frames, units, edge cases. A copy to read: a
  change has no effect.
- `{folder}.md`: the handout: theory with numbered equations, what to hand in, hints.
- `tests/`: the public tests, copies to read.
{tests}- `compile_flags.txt`: for editors that use clangd.

```
{check}
```
runs every public test, each with a verdict of its own: right, wrong, not attempted, crashed, out of
time or memory. Nothing has to be built before. `tumble --help` lists all commands, and
`tumble check --help` explains one.
All handouts, models and scenes are below `{root}`.
)",
                     fmt::arg("title", name.title), fmt::arg("id", name.id),
                     fmt::arg("folder", name.folder), fmt::arg("check", check),
                     fmt::arg("root", root.string()),
                     fmt::arg("tests", has_tests ? "- `" + name.folder +
                                                       "_tests.cpp`: a file for tests of your own; "
                                                       "its first line says how it is run.\n"
                                                 : ""));
}

// A file of tests to begin from; empty where the assignment has no header for tests.
std::string own_tests_of(const fs::path& root, const modules::ModuleName& name) {
  const std::string fixtures = "tests/" + name.folder + "/" + name.id + "_fixtures.h";
  if (!fs::exists(root / fixtures)) return "";
  return fmt::format(
      R"(// Your own tests of {id}:  tumble check {id} {folder}.cpp --my-tests {folder}_tests.cpp
// student() has the functions of {folder}.h. A test passes for every right solution, and fails for
// a wrong one. The public tests in tests/ show how one is written.
#include "{fixtures}"

namespace tumble::testing {{

TEST(Mine, SaysWhatMustHold) {{
  // a case whose answer you know, for example:
  //   EXPECT_NEAR(student()....., 9.0, 1e-12);
  FAIL() << "not written yet";
}}

}}  // namespace tumble::testing
)",
      fmt::arg("id", name.id), fmt::arg("folder", name.folder), fmt::arg("fixtures", fixtures));
}

std::string commands_of(const Command& command, const modules::ModuleName& name,
                        const fs::path& folder) {
  if (!command.is_installed)
    return fmt::format("{} check {} {}", (command.root / "tumble").string(), name.id,
                       (folder / (name.folder + ".cpp")).string());
  return fmt::format(
      "tumble check {0}                     # every public test\n"
      "tumble watch {0}                     # the same on every save\n"
      "tumble check {0} 'Suite.*'           # some of them",
      name.id);
}

void copy_new(const fs::path& from, const fs::path& to) {
  std::error_code failed;
  fs::copy(from, to, fs::copy_options::recursive | fs::copy_options::overwrite_existing, failed);
  if (failed)
    throw UserError(to.string(), "cannot be written: " + failed.message(),
                    "Name a folder that you may write to.");
}

void start(const Command& command, const std::string& id, const fs::path& word) {
  const modules::ModuleName& name = modules::find_name(assignment_names(), id);
  const fs::path folder = fs::absolute(word), public_files = command.root / "assignments",
                 own = folder / (name.folder + ".cpp");
  // Links count, too: nothing of a student's is ever replaced.
  if (fs::exists(fs::symlink_status(own)))
    throw UserError(own.string(), "is there already", "Name another folder, or move it away.");
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw UserError(folder.string(), "cannot be made: " + failed.message(),
                    "Name a folder that you may write to.");
  copy_new(public_files / name.folder / (name.folder + ".h"), folder / (name.folder + ".h"));
  copy_new(command.root / "tests" / name.folder, folder / "tests");
  copy_new(command.root / "handouts" / (name.folder + ".md"), folder / (name.folder + ".md"));
  if (const std::string tests = own_tests_of(command.root, name);
      !tests.empty() && !command.is_installed)
    write_whole(folder / (name.folder + "_tests.cpp"), tests);
  write_whole(folder / "README.md",
              readme_of(name, commands_of(command, name, folder), command.root,
                        fs::exists(folder / (name.folder + "_tests.cpp"))));
  write_whole(folder / "compile_flags.txt",
              "-std=c++20\n-I\n" + command.root.string() + "\n-isystem\n/usr/include/eigen3\n");
  // Last: a folder with this file is complete.
  copy_new(public_files / name.folder / (name.folder + ".cpp"), own);
  fs::permissions(own, fs::perms::owner_write, fs::perm_options::add);
  fmt::print("{} holds your file, {}\nnext:  {}\n", folder.string(), own.filename().string(),
             command.is_installed ? "cd " + word.string() + " && tumble check " + id
                                  : commands_of(command, name, folder));
}

}  // namespace

void add_start(CLI::App& app, Command& command) {
  auto id = std::make_shared<std::string>();
  auto folder = std::make_shared<std::string>();
  Verb verb(app, "start", "Make a folder to work in: your file, its header, its tests, a README");
  verb.option("assignment", *id, "Which, e.g. a1").required().type_name("ID");
  verb.option("folder", *folder, "Where; made where it is missing").required().type_name("FOLDER");
  verb.footer("A file of yours that is there already is never replaced.");
  verb.runs([&command, id, folder] { start(command, *id, *folder); });
}

}  // namespace tumble::cli
