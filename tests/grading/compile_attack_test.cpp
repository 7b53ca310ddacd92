// Attacks on the compiler: files that a source must not read, and limits on its cost.
#include <unistd.h>

#include <fstream>

#include "tests/support/places.h"
#include "framework/grading/sandbox/protection.h"
#include "tests/grading/attack_fixture.h"

namespace tumble::grading {
namespace {

using Outcome = Compiled::Outcome;
namespace fs = std::filesystem;

class CompileAttack : public Attack {
 protected:
  void SetUp() override {
    Attack::SetUp();
    object_ = fs::temp_directory_path() / ("tumble-compile-" + std::to_string(::getpid()) + ".so");
  }
  void TearDown() override {
    fs::remove(object_);
    EXPECT_EQ(descendants_left(), 0);
  }
  Compiled compile(const std::string& text, const CompileLimits& limits = {}) {
    return compile_source(text, object_, limits);
  }
  fs::path object_;
};

// A right module, so that only the text that a test adds can cause an error.
const std::string kModule = R"(
#include "tests/modules/waist.h"
namespace tumble::waist {
double twice(double x) { return 2.0 * x; }
Everything echo(const Everything& value) { return value; }
double call_back(const std::function<double(double)>&, int) { return 0.0; }
std::string attack(const std::string& what) { return what; }
double missing(double) { return 0.0; }
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>&, const VectorXd& y,
              const std::string&) { return y; }
}
)";

TEST_F(CompileAttack, ErrorsNameTheStudentsFileAndLine) {
  const Compiled compiled = compile("int x = 1;\nint y = x +;\n" + kModule);
  EXPECT_EQ(compiled.outcome, Outcome::kRefused);
  EXPECT_EQ(compiled.said.substr(0, 20), "waist.cpp:2:12: erro") << compiled.said;
}

TEST_F(CompileAttack, MissingFunctionsAreNamed) {
  const Compiled compiled = compile(
      "#include \"tests/modules/waist.h\"\ndouble tumble::waist::twice(double x) { return x; }\n");
  EXPECT_EQ(compiled.outcome, Outcome::kRefused);
  EXPECT_NE(compiled.said.find("tumble::waist::echo"), std::string::npos) << compiled.said;
}

// Its pieces are compiled once, and linked from a library in each kind of sandbox.
TEST_F(CompileAttack, AFileThatSolvesASystemIsBuilt) {
  const Compiled compiled = compile(kModule + R"(
namespace tumble {
MatrixXd product(const MatrixXd& A, const MatrixXd& B) { return A * B.transpose(); }
VectorXd by_lu(const MatrixXd& A, const VectorXd& b) { return A.lu().solve(b); }
VectorXd by_ldlt(const MatrixXd& A, const VectorXd& b) { return A.ldlt().solve(b); }
VectorXd by_llt(const MatrixXd& A, const VectorXd& b) { return A.llt().solve(b); }
}
)");
  EXPECT_EQ(compiled.outcome, Outcome::kBuilt) << compiled.said;
  EXPECT_EQ(compiled.said, "");
}

TEST_F(CompileAttack, PrivateFilesCannotBeIncluded) {
  if (chosen_sandbox() == SandboxKind::kBare)
    GTEST_SKIP() << "bare does not protect the compiler: so it is not official";
  const std::string root = test::source_dir();
  for (const std::string& path :
       {root + "/solutions_private/a1_impulse/a1_impulse.cpp",
        std::string("solutions_private/a1_impulse/a1_impulse.cpp"),
        std::string("framework/../solutions_private/a1_impulse/a1_impulse.cpp"),
        root + "/README.md", std::string("../../../../../../..") + root + "/README.md",
        std::string("/etc/passwd"), std::string("assignments/a1_impulse/a1_impulse.cpp"),
        std::string("tests/modules/waist.cpp")}) {
    const Compiled compiled = compile("#include \"" + path + "\"\n" + kModule);
    EXPECT_EQ(compiled.outcome, Outcome::kRefused) << path;
    const bool is_refused = compiled.said.find("No such file or directory") != std::string::npos ||
                            compiled.said.find("Permission denied") != std::string::npos;
    EXPECT_TRUE(is_refused) << compiled.said;
  }
}

TEST_F(CompileAttack, PrivateFilesCannotBeSeenOrEmbedded) {
  if (chosen_sandbox() == SandboxKind::kBare)
    GTEST_SKIP() << "bare does not protect the compiler: so it is not official";
  const std::string root = test::source_dir();
  // Landlock refuses to open a file and does not hide it: then the file is refused by name.
  const Compiled seen =
      compile("#if __has_include(\"" + root +
              "/README.md\") || __has_include(\"solutions_private/CMakeLists.txt\")\n#error "
              "seen\n#endif\n" +
              kModule);
  EXPECT_EQ(seen.outcome,
            traits_of(chosen_sandbox()).hides_names ? Outcome::kBuilt : Outcome::kRefused)
      << seen.said;
  const Compiled embedded = compile(kModule + "asm(\".incbin \\\"" + root + "/README.md\\\"\");\n");
  EXPECT_EQ(embedded.outcome, Outcome::kRefused) << embedded.said;
  const Compiled environment = compile(kModule + "asm(\".incbin \\\"/proc/1/environ\\\"\");\n");
  EXPECT_EQ(environment.outcome, Outcome::kRefused) << environment.said;
}

TEST_F(CompileAttack, LinkAsASourceIsRefused) {
  const fs::path link =
      fs::temp_directory_path() / ("tumble-link-" + std::to_string(::getpid()) + ".cpp");
  fs::create_symlink(fs::path(test::source_dir()) / "tests/modules/waist.cpp", link);
  const Compiled compiled =
      compile_submission({test::source_dir(), "tests/modules/waist.h", link, object_, {}, "waist"});
  fs::remove(link);
  EXPECT_EQ(compiled.outcome, Outcome::kRefused);
  EXPECT_NE(compiled.said.find("is a link"), std::string::npos) << compiled.said;
}

TEST_F(CompileAttack, SourcesThatAreNotFilesAreRefused) {
  for (const char* path : {"/dev/zero", "/tmp", "/nowhere.cpp"})
    EXPECT_EQ(compile_submission(
                  {test::source_dir(), "tests/modules/waist.h", path, object_, {}, "waist"})
                  .outcome,
              Outcome::kRefused)
        << path;
}

TEST_F(CompileAttack, NamesThatLookLikeOptionsAreTreatedAsNames) {
  for (const char* name : {"-o.cpp", "@x.cpp", "a b;c'$(id).cpp"}) {
    const fs::path file = fs::temp_directory_path() / name;
    std::ofstream(file) << kModule;
    const Compiled compiled = compile_submission(
        {test::source_dir(), "tests/modules/waist.h", file, object_, {}, "waist"});
    fs::remove(file);
    EXPECT_EQ(compiled.outcome, Outcome::kBuilt) << name << ": " << compiled.said;
  }
}

TEST_F(CompileAttack, BombsAreStoppedByTheirLimits) {
  CompileLimits limits;
  limits.cpu_s = 3;
  limits.wall_s = 12.0;
  limits.memory_bytes = 600ull << 20;
  const char* const bombs[] = {
      // memory
      "#include \"/dev/zero\"\n",
      // file size
      "asm(\".fill 4000000000\");\n",
      // depth
      "template <int N> struct T { T<N * 2 + 1> a; T<N * 2 + 2> b; }; T<0> t;\n#pragma GCC "
      "diagnostic ignored \"-Wfatal-errors\"\n",
      "constexpr int f(long n) { int s = 0; for (long i = 0; i < n; ++i) s ^= static_cast<int>(i); "
      "return s; }\n"
      // evaluation
      "static_assert(f(1000000000000) == 0);\n",
  };
  for (const char* bomb : bombs) {
    const Compiled compiled = compile(std::string(bomb) + kModule, limits);
    EXPECT_TRUE(compiled.outcome == Outcome::kRefused ||
                compiled.outcome == Outcome::kOutOfResources)
        << bomb << compiled.said;
    EXPECT_FALSE(fs::exists(object_));
  }
}

TEST_F(CompileAttack, CpuTimeIsALimitAndWallTimeAloneIsABusyMachine) {
  CompileLimits limits;
  limits.cpu_s = 1;
  // 2^30 lines: more than a second on any machine.
  std::string text = "#include \"tests/modules/waist.h\"\n#define A0 int;\n";
  for (int i = 1; i <= 30; ++i)
    text += "#define A" + std::to_string(i) + " A" + std::to_string(i - 1) + " A" +
            std::to_string(i - 1) + "\n";
  const Compiled compiled = compile(text + "A30\n", limits);
  EXPECT_EQ(compiled.outcome, Outcome::kOutOfResources) << compiled.said;
  // Wall time alone is not the file's fault: it is to be compiled again.
  limits.cpu_s = 100;
  limits.wall_s = 1.0;
  const Compiled busy = compile(text + "A30\n", limits);
  EXPECT_EQ(busy.outcome, Outcome::kGraderFault) << busy.said;
  EXPECT_NE(busy.said.find("machine was too busy"), std::string::npos) << busy.said;
}

TEST_F(CompileAttack, CompilerThatWaitsForeverIsOutOfTime) {
  CompileLimits limits;
  limits.stall_s = 2.0;
  // a pipe that the compiler itself keeps open
  const Compiled compiled = compile(std::string("#include \"/dev/stdout\"\n") + kModule, limits);
  EXPECT_TRUE(compiled.outcome == Outcome::kRefused || compiled.outcome == Outcome::kOutOfResources)
      << compiled.said;
}

TEST_F(CompileAttack, BytesThatAreNotTextAreNamedWithARemedy) {
  std::string wide = "\xff\xfe";
  for (const char c : std::string("int x;\n")) wide += c, wide += '\0';
  const Compiled compiled = compile(wide);
  EXPECT_EQ(compiled.outcome, Outcome::kRefused);
  EXPECT_NE(compiled.said.find("UTF-16"), std::string::npos) << compiled.said;
  EXPECT_NE(compiled.said.find("Save it as UTF-8"), std::string::npos) << compiled.said;
}

// It would be a shared object without a module, of which each test says that it has crashed.
TEST_F(CompileAttack, AFileWithoutTheModulesHeaderDefinesNothing) {
  for (const char* text : {"", "\n\n", "// to do\n", "int main() { return 0; }\n"}) {
    const Compiled compiled = compile(text);
    EXPECT_EQ(compiled.outcome, Outcome::kRefused) << text;
    EXPECT_NE(compiled.said.find("waist.cpp:1:1: error: the file does not include "
                                 "\"tests/modules/waist.h\" and defines nothing of it"),
              std::string::npos)
        << compiled.said;
  }
}

}  // namespace
}  // namespace tumble::grading
