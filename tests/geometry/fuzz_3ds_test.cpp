// 20 000 damaged files from one seed: none may crash the loader, hang it for 2 s, or make it take
// 512 MiB, and every accepted file must be usable. Child processes read the files in batches, so
// that a crash costs one file and names it.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/load_3ds.h"
#include "framework/geometry/mass_properties.h"
#include "models/catalogue.h"
#include "tests/geometry/file_3ds.h"

namespace tumble::testing {
namespace {

constexpr int kFiles = 20'000;
constexpr int kBatch = 2'000;
constexpr int kHang = 2;                     // s of wall-clock time per file
constexpr long kMostKilobytes = 512 * 1024;  // of memory in use at once
// limit of address space, to protect the machine; sanitizers need more
constexpr rlim_t kMostAddresses = rlim_t{4} << 30;

/// A file with everything that check_3ds inspects: materials, smoothing groups, matrices, nodes
/// with parents, a camera.
std::string rich_file() {
  const TriangleMesh box = models::catalogue().front().objects.front().mesh;
  std::string groups, material = std::string("red") + '\0' + u16(6);
  for (int f = 0; f < 12; ++f) groups += u32(1u << (f / 2));
  for (int f = 0; f < 6; ++f) material += u16(static_cast<std::uint16_t>(f));
  const std::string faces = chunk(0x4120, models::face_list(box.faces).substr(6) +
                                              chunk(0x4130, material) + chunk(0x4150, groups));
  const auto object = [&](const std::string& name) {
    return models::object_chunk(name,
                                models::vertex_list(box.vertices) + faces +
                                    matrix_chunk(Eigen::Affine3d(Eigen::Translation3d(1, 2, 3))));
  };
  const std::string camera =
      chunk(0x4000, std::string("cam") + '\0' + chunk(0x4700, numbers({1, 2, 3, 0, 0, 0, 0, 45})));
  Node first{"one"}, second{"two"};
  first.pivot = {0.5, 0, 0};
  second.number = 1;
  second.parent = 0;
  second.angle = 0.7;
  const std::string red = chunk(0xAFFF, chunk(0xA000, std::string("red") + '\0') +
                                            chunk(0xA020, chunk(0x0011, "\xFF\x01\x02")));
  return models::file_3ds(red + object("one") + object("two") + camera,
                          keyframer(node_chunk(first) + node_chunk(second)));
}

std::vector<std::string> seeds() {
  std::vector<std::string> files{rich_file(), rich_file()};
  for (const auto& models : {models::catalogue(), models::broken_catalogue()}) {
    for (const models::Model& model : models) {
      std::string bytes = models::write_3ds(model.objects);
      if (bytes.size() < 3000) files.push_back(std::move(bytes));
    }
  }
  return files;
}

void overwrite(std::string& bytes, std::size_t at, const std::string& with) {
  for (std::size_t i = 0; i < with.size() && at + i < bytes.size(); ++i) bytes[at + i] = with[i];
}

/// Numbers that often break programs.
std::string odd_number(Random& random) {
  const std::uint32_t odd[] = {
      0,      1,          5,          6,          7,          0x7F,       0xFF,       0x7FFF,
      0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7F800000, 0x7FC00000, 0xFF7FFFFF, 0x00000001};
  const std::uint32_t value = odd[random.below(std::size(odd))];
  return random.below(2) == 0 ? u16(static_cast<std::uint16_t>(value)) : u32(value);
}

/// The place of a chunk's id, which its length and count follow.
std::size_t place_of_a_chunk(const std::string& bytes, Random& random) {
  static const std::uint16_t ids[] = {0x4D4D, 0x3D3D, 0x4000, 0x4100, 0x4110, 0x4120,
                                      0x4130, 0x4150, 0x4160, 0xB000, 0xB002, 0xB010,
                                      0xB013, 0xB020, 0xB021, 0xB030};
  const std::size_t at =
      bytes.find(u16(ids[random.below(std::size(ids))]), random.below(bytes.size()));
  return at == std::string::npos ? random.below(bytes.size()) : at;
}

void mutate_once(std::string& bytes, Random& random) {
  if (bytes.empty()) return;
  const std::size_t at = random.below(bytes.size());
  const std::size_t length = 1 + random.below(std::min<std::size_t>(64, bytes.size()));
  switch (random.below(12)) {
    // truncate
    case 0: bytes.resize(at); break;
    case 1: bytes[at] = static_cast<char>(random.below(256)); break;
    case 2: overwrite(bytes, at, odd_number(random)); break;
    // a chunk's length
    case 3: overwrite(bytes, place_of_a_chunk(bytes, random) + 2, odd_number(random)); break;
    // a count, or the first datum
    case 4: overwrite(bytes, place_of_a_chunk(bytes, random) + 6, odd_number(random)); break;
    case 5: bytes.insert(at, bytes.substr(random.below(bytes.size()), length)); break;
    case 6: bytes.erase(at, length); break;
    case 7: overwrite(bytes, at, bytes.substr(random.below(bytes.size()), length)); break;
    // a coordinate, an index, a key
    default: {
      const std::size_t inside = place_of_a_chunk(bytes, random) + 8 + random.below(64);
      if (random.below(2) == 0)
        overwrite(bytes, inside, odd_number(random));
      else
        overwrite(bytes, inside, std::string(1, static_cast<char>(random.below(256))));
    }
  }
}

std::string damaged_file(int number, const std::vector<std::string>& seeds) {
  Random random(0x3D5 + static_cast<std::uint64_t>(number));
  std::string bytes = seeds[random.below(seeds.size())];
  const std::uint64_t mutations = 1 + random.below(4);
  for (std::uint64_t i = 0; i < mutations; ++i) mutate_once(bytes, random);
  // Half of the files get a correct length again, so that the loader reaches damage deeper inside.
  if (bytes.size() >= 6 && random.below(2) == 0)
    overwrite(bytes, 2, u32(static_cast<std::uint32_t>(bytes.size())));
  return bytes;
}

/// How many files had which outcome; shared between the processes.
struct Tally {
  volatile int next;  // the file being read
  volatile int accepted, refused, unusable;
  volatile int first_unusable;
};

bool is_usable(const LoadedFile& file) {
  for (const LoadedObject& object : file.objects) {
    if (!object.report.is_closed()) continue;
    const MassProperties mass = compute_mass_properties(object.report.mesh);
    if (!(mass.volume > 0.0) || !std::isfinite(mass.volume) || !mass.com_mesh.allFinite() ||
        !(mass.principal_moments.minCoeff() > 0.0) || !mass.principal_moments.allFinite())
      return false;
  }
  return !file.objects.empty();
}

void read_files(Tally& tally, int end, const std::vector<std::string>& seeds) {
  for (int file = tally.next; file < end; ++file) {
    tally.next = file;
    const std::string bytes = damaged_file(file, seeds);
    const itimerval limit{{0, 0}, {kHang, 0}};
    setitimer(ITIMER_REAL, &limit, nullptr);  // SIGALRM ends a process that hangs
    bool usable = true;
    try {
      usable = is_usable(parse_3ds(bytes, "damaged.3ds"));
      tally.accepted = tally.accepted + 1;
    } catch (const UserError&) {
      tally.refused = tally.refused + 1;
    } catch (...) {
      usable = false;
    }
    if (usable) continue;
    if (tally.unusable == 0) tally.first_unusable = file;
    tally.unusable = tally.unusable + 1;
  }
  tally.next = end;
}

TEST(Fuzz3ds, TwentyThousandDamagedFilesNeitherCrashNorHangNorExhaustMemory) {
  const std::vector<std::string> files = seeds();
  // one file, written out and read in this process: for a debugger
  if (const char* only = std::getenv("TUMBLE_FUZZ_FILE")) {
    std::ofstream("damaged.3ds", std::ios::binary) << damaged_file(std::atoi(only), files);
    EXPECT_TRUE(is_usable(load_3ds("damaged.3ds")));
    return;
  }
  void* shared =
      mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  Tally& tally = *new (shared) Tally{};
  long peak_kilobytes = 0;
  int deaths = 0;
  while (tally.next < kFiles && deaths < 5) {
    const int end = std::min(kFiles, (tally.next / kBatch + 1) * kBatch);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
#ifndef __SANITIZE_ADDRESS__
      const rlimit addresses{kMostAddresses, kMostAddresses};
      setrlimit(RLIMIT_AS, &addresses);
#endif
      read_files(tally, end, files);
      _exit(0);
    }
    int status = 0;
    rusage usage{};
    ASSERT_EQ(wait4(child, &status, 0, &usage), child);
    peak_kilobytes = std::max(peak_kilobytes, usage.ru_maxrss);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    ++deaths;
    ADD_FAILURE() << "file " << tally.next
                  << (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM ? " took longer than 2 s"
                                                                         : " ended the process, ")
                  << (WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "exit");
    const int after = tally.next + 1;
    tally.next = after;
  }
  EXPECT_EQ(tally.unusable, 0) << "the first is file " << tally.first_unusable;
  EXPECT_LT(peak_kilobytes, kMostKilobytes);
  // Files are accepted and refused: a mutator that damages no file, or every file, would test
  // nothing.
  EXPECT_GT(tally.accepted, kFiles / 20);
  EXPECT_GT(tally.refused, kFiles / 4);
  std::printf("%d files: %d accepted, %d refused; peak memory %ld MiB\n", kFiles,
              tally.accepted + 0, tally.refused + 0, peak_kilobytes / 1024);
  munmap(shared, sizeof(Tally));
}

}  // namespace
}  // namespace tumble::testing
