#include "framework/core/stack_samples.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include <cxxabi.h>
#include <dlfcn.h>
#include <elf.h>
#include <execinfo.h>
#include <link.h>
#include <sys/time.h>

#include "framework/core/error.h"

namespace tumble {

// Not of the unnamed namespace: StackSamples::Stacks holds them.
struct SampledStack {
  int depth = 0;
  std::array<void*, 64> functions;  // from the innermost
};

namespace {

constexpr int kDeepest = std::tuple_size_v<decltype(SampledStack::functions)>;
constexpr std::size_t kMostSamples = 1 << 15;  // minutes of CPU time; later samples are dropped
// innermost frames, which belong to the signal's delivery
constexpr int kSignalFrames = 2;
constexpr suseconds_t kInterval_us = 1000;  // requested; the system rounds it up to its own tick

// ---- Names of functions -------------------------------------------------------------------------

struct Function {
  std::uintptr_t begin, end;  // as loaded
  std::string name;
};

// "void a::(unnamed)::f<b>(c)" is "a::f".
std::string plain_name(const char* symbol) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> whole(
      abi::__cxa_demangle(symbol, nullptr, nullptr, &status), &std::free);
  std::string name = status == 0 ? whole.get() : symbol;
  const std::string unnamed = "(anonymous namespace)::";
  for (std::size_t at; (at = name.find(unnamed)) != std::string::npos;)
    name.erase(at, unnamed.size());
  name.erase(std::min(name.find_first_of("(<"), name.size()));
  return name.substr(name.rfind(' ') + 1);
}

template <class Record>
const Record* records(const std::string& file, std::size_t offset, std::size_t bytes) {
  return offset + bytes <= file.size() ? reinterpret_cast<const Record*>(file.data() + offset)
                                       : nullptr;
}

// Functions of one ELF file, local ones included, sorted by address.
std::vector<Function> functions_of(const std::filesystem::path& path, std::uintptr_t loaded_at) {
  std::ifstream in(path, std::ios::binary);
  const std::string file((std::istreambuf_iterator<char>(in)), {});
  std::vector<Function> found;
  const auto* head = records<Elf64_Ehdr>(file, 0, sizeof(Elf64_Ehdr));
  if (head == nullptr || std::memcmp(head->e_ident, ELFMAG, SELFMAG) != 0 ||
      head->e_ident[EI_CLASS] != ELFCLASS64)
    return found;
  const auto* sections =
      records<Elf64_Shdr>(file, head->e_shoff, std::size_t{head->e_shnum} * sizeof(Elf64_Shdr));
  if (sections == nullptr) return found;
  const std::uintptr_t shift = head->e_type == ET_DYN ? loaded_at : 0;
  for (int k = 0; k < head->e_shnum; ++k) {
    const Elf64_Shdr& table = sections[k];
    if ((table.sh_type != SHT_SYMTAB && table.sh_type != SHT_DYNSYM) ||
        table.sh_link >= head->e_shnum)
      continue;
    const Elf64_Shdr& names = sections[table.sh_link];
    const auto* symbols = records<Elf64_Sym>(file, table.sh_offset, table.sh_size);
    if (symbols == nullptr || records<char>(file, names.sh_offset, names.sh_size) == nullptr)
      continue;
    for (std::size_t i = 0; i < table.sh_size / sizeof(Elf64_Sym); ++i) {
      const Elf64_Sym& symbol = symbols[i];
      if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC || symbol.st_size == 0 ||
          symbol.st_name >= names.sh_size)
        continue;
      found.push_back({shift + symbol.st_value, shift + symbol.st_value + symbol.st_size,
                       file.data() + names.sh_offset + symbol.st_name});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Function& x, const Function& y) { return x.begin < y.begin; });
  return found;
}

std::vector<std::vector<Function>> functions_of_all() {
  std::vector<std::vector<Function>> files;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* to) {
        const bool is_program = info->dlpi_name[0] == '\0';
        static_cast<std::vector<std::vector<Function>>*>(to)->push_back(
            functions_of(is_program ? "/proc/self/exe" : info->dlpi_name, info->dlpi_addr));
        return 0;
      },
      &files);
  return files;
}

const Function* function_at(const std::vector<std::vector<Function>>& files,
                            std::uintptr_t address) {
  for (const auto& functions : files) {
    auto after = std::upper_bound(functions.begin(), functions.end(), address,
                                  [](std::uintptr_t x, const Function& f) { return x < f.begin; });
    if (after != functions.begin() && address < std::prev(after)->end) return &*std::prev(after);
  }
  return nullptr;
}

// Length of the longest of these prefixes that the name begins with; 0 where there is none.
std::size_t matching_prefix(const std::vector<std::string>& prefixes, const std::string& name) {
  std::size_t longest = 0;
  for (const std::string& prefix : prefixes)
    if (name.starts_with(prefix)) longest = std::max(longest, prefix.size());
  return longest;
}

}  // namespace

struct StackSamples::Stacks {
  std::vector<SampledStack> all = std::vector<SampledStack>(kMostSamples);
  std::atomic<std::size_t> taken = 0;
};

namespace {

// Globals: a signal handler has no argument through which to reach its buffer.
std::atomic<std::vector<SampledStack>*> writing = nullptr;
std::atomic<std::size_t>* writing_at = nullptr;

void take_sample(int) {
  const int kept = errno;
  if (std::vector<SampledStack>* all = writing.load(std::memory_order_acquire)) {
    const std::size_t k = writing_at->fetch_add(1, std::memory_order_relaxed);
    if (k < all->size()) (*all)[k].depth = backtrace((*all)[k].functions.data(), kDeepest);
  }
  errno = kept;
}

void set_timer(suseconds_t interval_us) {
  const itimerval every{{0, interval_us}, {0, interval_us}};
  setitimer(ITIMER_PROF, &every, nullptr);
}

}  // namespace

StackSamples::StackSamples() : stacks_(std::make_unique<Stacks>()) {
  // the first call of backtrace loads a library, which a signal handler must not do
  std::array<void*, 4> unused;
  backtrace(unused.data(), static_cast<int>(unused.size()));
}

StackSamples::~StackSamples() {
  if (writing.load() == &stacks_->all) end();
}

void StackSamples::begin() {
  require(writing.load() == nullptr, "only one StackSamples may take samples at a time");
  writing_at = &stacks_->taken;
  writing.store(&stacks_->all, std::memory_order_release);
  struct sigaction action {};
  action.sa_handler = take_sample;
  action.sa_flags = SA_RESTART;
  sigaction(SIGPROF, &action, nullptr);
  set_timer(kInterval_us);
}

// The handler stays installed: a pending signal without a handler would end the program.
void StackSamples::end() {
  set_timer(0);
  writing.store(nullptr, std::memory_order_release);
}

StackSamples::Shares StackSamples::shares(const std::vector<Part>& parts,
                                          const std::vector<std::string>& without) const {
  const auto files = functions_of_all();
  constexpr int kNone = -1, kLeftOut = -2;
  std::map<void*, int> known;  // part by address
  const auto part_at = [&](void* address, bool is_innermost) {
    const auto [place, is_new] = known.try_emplace(address, kNone);
    if (!is_new) return place->second;
    // A caller's frame holds its return address, which may already belong to the next function:
    // look one byte before it.
    const Function* function =
        function_at(files, reinterpret_cast<std::uintptr_t>(address) - (is_innermost ? 0 : 1));
    if (function == nullptr) return kNone;
    const std::string name = plain_name(function->name.c_str());
    if (matching_prefix(without, name) > 0) return place->second = kLeftOut;
    std::size_t longest = 0;
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (const std::size_t letters = matching_prefix(parts[p].functions, name);
          letters > longest) {
        longest = letters;
        place->second = static_cast<int>(p);
      }
    return place->second;
  };
  Shares shares;
  shares.of_part.assign(parts.size(), 0.0);
  for (std::size_t k = 0; k < std::min(stacks_->taken.load(), kMostSamples); ++k) {
    const SampledStack& stack = stacks_->all[k];
    int part = kNone;
    for (int i = kSignalFrames; i < stack.depth && part != kLeftOut; ++i)
      if (const int its = part_at(stack.functions[static_cast<std::size_t>(i)], i == kSignalFrames);
          its == kLeftOut || part == kNone)
        part = its;
    if (part == kLeftOut) continue;
    ++shares.samples;
    (part == kNone ? shares.rest : shares.of_part[static_cast<std::size_t>(part)]) += 1.0;
  }
  if (shares.samples == 0) return shares;
  shares.rest /= static_cast<double>(shares.samples);
  for (double& share : shares.of_part) share /= static_cast<double>(shares.samples);
  return shares;
}

bool StackSamples::is_known(const std::string& beginning) {
  for (const auto& functions : functions_of_all())
    for (const Function& function : functions)
      if (plain_name(function.name.c_str()).starts_with(beginning)) return true;
  return false;
}

}  // namespace tumble
