// Submissions compiled for a page: what the module may import, hostile sources, and whether it
// computes the numbers that the judge computes.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>
#include <sstream>

#include <fmt/format.h>

#include "tests/support/places.h"
#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/core/files.h"
#include "framework/grading/compiler/page_module.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/modules/load.h"
#include "framework/modules/wire.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::source_dir(), kBuild = test::binary_dir();

const PageCompiler& a1_compiler() {
  static const PageCompiler compiler(kRoot, kBuild, "a1", "a1_impulse");
  return compiler;
}

class PageModuleTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const auto missing = missing_page_packages(); !missing.empty())
      GTEST_SKIP() << "this machine lacks " << missing.front() << " and what else of "
                   << kPagePackages << " it lacks";
    ASSERT_EQ(a1_compiler().obstacle(), "");
  }
  PageModule compiled(const std::string& text) const {
    const fs::path source = folder_.path() / "a1_impulse.cpp";
    write_whole(source, text);
    return a1_compiler().compile(source);
  }
  // The stub, with something before it: a whole module.
  PageModule stub_after(const std::string& text) const {
    return compiled(text + "\n" + text_of(kRoot / "assignments/a1_impulse/a1_impulse.cpp"));
  }
  PrivateFolder folder_;
};

TEST_F(PageModuleTest, AStubImportsNothingButTheWayOut) {
  const PageModule module = stub_after("");
  ASSERT_EQ(module.why_not, "");
  EXPECT_EQ(imports_of(module.wasm), std::vector<std::string>{"tumble.threw"});
}

TEST_F(PageModuleTest, APrintingModuleAsksTheSystemForNoMoreThanWasi) {
  const PageModule module = stub_after("#include <iostream>\nstatic int x = (std::cout << 1, 0);");
  ASSERT_EQ(module.why_not, "");
  const auto imports = imports_of(module.wasm);
  ASSERT_TRUE(imports);
  for (const std::string& import : *imports)
    EXPECT_TRUE(import == "tumble.threw" || import.starts_with("wasi_snapshot_preview1."))
        << import;
}

TEST_F(PageModuleTest, AFunctionThatNoPageHasIsRefusedByItsName) {
  const PageModule module = stub_after(
      "extern \"C\" __attribute__((import_module(\"window\"), import_name(\"fetch\"))) void f();\n"
      "__attribute__((used)) void g() { f(); }");
  EXPECT_EQ(module.wasm, "");
  EXPECT_EQ(module.why_not, "it calls window.fetch, which no page has");
}

TEST_F(PageModuleTest, PrivateFilesCannotBeIncluded) {
  if (chosen_sandbox() == SandboxKind::kBare)
    GTEST_SKIP() << "bare does not protect the compiler: so it is not official";
  for (const std::string& path : {(kRoot / "solutions_private/a1_impulse/a1_impulse.cpp").string(),
                                  (kRoot / "README.md").string(), std::string("/etc/passwd"),
                                  std::string("solutions_private/a1_impulse/a1_impulse.cpp")}) {
    const PageModule module = stub_after("#include \"" + path + "\"");
    EXPECT_EQ(module.wasm, "") << path;
    const bool is_refused = module.why_not.find("file not found") != std::string::npos ||
                            module.why_not.find("Permission denied") != std::string::npos;
    EXPECT_TRUE(is_refused) << module.why_not;
  }
}

// Limits as for grading: 30 s of CPU time and 1.5 GiB; a template that doubles reaches one of them.
TEST_F(PageModuleTest, ATemplateBombEndsWithAMessage) {
  const PageModule module = stub_after(
      "template <int N> struct B { B<N - 1> a; B<N - 2> b; static constexpr int v = "
      "B<N - 1>::v + B<N - 2>::v; };\n"
      "template <class A, int N> struct T { using L = T<T<A, 0>, N - 1>; using R = T<T<A, 1>, "
      "N - 1>; static constexpr int v = L::v + R::v; };\n"
      "template <class A> struct T<A, 0> { static constexpr int v = 1; };\n"
      "static_assert(T<int, 40>::v > 0);");
  EXPECT_EQ(module.wasm, "");
  EXPECT_NE(module.why_not, "");
}

TEST_F(PageModuleTest, ASecondTumbleCallDoesNotLink) {
  const PageModule module = stub_after("extern \"C\" unsigned tumble_call(unsigned) { return 0; }");
  EXPECT_EQ(module.wasm, "");
  EXPECT_NE(module.why_not.find("duplicate symbol"), std::string::npos) << module.why_not;
}

TEST(ImportsOf, BytesThatAreNoModuleAreRefused) {
  const std::string head("\0asm\1\0\0\0", 8);
  EXPECT_EQ(imports_of(""), std::nullopt);
  EXPECT_EQ(imports_of("\177ELF----"), std::nullopt);
  EXPECT_EQ(imports_of(head), std::vector<std::string>{});
  EXPECT_EQ(imports_of(head + std::string("\2\377", 2)), std::nullopt);      // an endless size
  EXPECT_EQ(imports_of(head + std::string("\2\2\1\377", 4)), std::nullopt);  // ends in a name
  EXPECT_EQ(imports_of(head + std::string("\2\7\1\1a\1b\2\0", 9)), std::nullopt);  // a memory
  EXPECT_EQ(imports_of(head + std::string("\2\7\1\1a\1b\0\0", 9)), std::vector<std::string>{"a.b"});
}

// ---- The numbers ----

/// Calls with arguments by lot, as bytes, with the answers of a module of this processor.
class Calls {
 public:
  explicit Calls(const a1::Module& module) : module_(module) {}

  void add_one_of_each() {
    const Body a = body(), b = body();
    Contact contact{vector(), vector().normalized()};
    const double e = number() / 2 + 0.5;
    add("relative_normal_velocity", module_.relative_normal_velocity(contact, a, b), contact, a, b);
    add("collision_impulse", module_.collision_impulse(contact, a, b, e), contact, a, b, e);
    add("resolve_collision", module_.resolve_collision(contact, a, b, e), contact, a, b, e);
    const Vector3d impulse = vector(), point = vector();
    add("apply_impulse", module_.apply_impulse(a, impulse, point), a, impulse, point);
    add("angular_acceleration", module_.angular_acceleration(a, impulse), a, impulse);
    add("linear_acceleration", module_.linear_acceleration(a, impulse), a, impulse);
    add("wrench_of_point_force", module_.wrench_of_point_force(impulse, point, a.com_world),
        impulse, point, a.com_world);
  }
  std::string bytes;

 private:
  double number() { return std::uniform_real_distribution<double>(-1.0, 1.0)(lots_); }
  Vector3d vector() { return {number(), number(), number()}; }
  Body body() {
    Body body;
    const Vector3d moments = vector().cwiseAbs() + Vector3d::Constant(0.1);
    body.inertia = {2.0, 0.5, moments.asDiagonal(), moments.cwiseInverse().asDiagonal()};
    body.com_world = vector();
    body.world_from_body = Quaterniond(number(), number(), number(), number()).normalized();
    body.velocity_world = vector();
    body.omega_world = vector();
    return body;
  }
  void piece(const void* data, std::size_t size) {
    const auto length = static_cast<std::uint32_t>(size);
    bytes.append(reinterpret_cast<const char*>(&length), sizeof length);
    bytes.append(static_cast<const char*>(data), size);
  }
  template <class R, class... A>
  void add(const std::string& name, const R& answer, const A&... arguments) {
    modules::Writer given, got;
    (given.value(arguments), ...);
    got.value(answer);
    piece(name.data(), name.size());
    piece(given.bytes.data(), given.bytes.size());
    piece(got.bytes.data(), got.bytes.size());
  }
  const a1::Module& module_;
  std::mt19937_64 lots_{21};
};

std::string printed_by(const std::string& command) {
  std::string text;
  std::array<char, 4096> piece;
  FILE* pipe = ::popen(command.c_str(), "r");
  while (std::fgets(piece.data(), piece.size(), pipe) != nullptr) text += piece.data();
  return ::pclose(pipe) == 0 ? text : "";
}

// The two compilers order the same sums in other ways (packed pairs here, none there), so numbers
// differ by roundings: 64 eps of the answer's largest number (or of 1, the size of the arguments,
// where terms cancel) admits every order of the at most 30 operations in one number of a1. A slip
// such as a forgotten factor is off by more than 1e-3.
constexpr double kRounding = 64 * 2.220446049250313e-16;

TEST_F(PageModuleTest, TheReferenceComputesInThePageWhatItComputesHere) {
  const fs::path source = kRoot / "solutions_private/a1_impulse/a1_impulse.cpp",
                 object = kBuild / "modules/a1_reference.so";
  if (!fs::exists(source) || !fs::exists(object)) GTEST_SKIP() << "this tree has no reference";
  if (printed_by("node --version 2>&1").empty()) GTEST_SKIP() << "node is not installed";
  const PageModule module = a1_compiler().compile(source);
  ASSERT_EQ(module.why_not, "");
  write_whole(folder_.path() / "module.wasm", module.wasm);
  const modules::AnyModule native = modules::module_of<a1::Module>(
      modules::load_functions({"a1", "a1_impulse", "Impulse"}, object));
  Calls calls(*static_cast<const a1::Module*>(native.get()));
  constexpr int kRounds = 1000;
  for (int i = 0; i < kRounds; ++i) calls.add_one_of_each();
  write_whole(folder_.path() / "calls", calls.bytes);
  const std::string said = printed_by(
      fmt::format("node '{0}/tests/grading/page_module.mjs' '{0}' '{1}/module.wasm' '{1}/calls'",
                  kRoot.string(), folder_.path().string()));
  std::istringstream lines(said);
  int functions = 0;
  std::string name;
  double worst = 0.0;
  for (int count = 0, equal = 0; lines >> name >> count >> equal >> worst; ++functions) {
    EXPECT_EQ(count, kRounds) << name;
    EXPECT_LE(worst, kRounding) << name;
    fmt::print("  {}: {} of {} answers bit for bit, the others within {:.2g}\n", name, equal, count,
               worst);
  }
  EXPECT_EQ(functions, 7) << said;
}

}  // namespace
}  // namespace tumble::grading
