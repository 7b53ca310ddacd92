// Finished pieces on disk: taken over whole, of their own work only, or not at all.
#include "framework/farm/parts.h"

#include <unistd.h>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/not_implemented.h"

namespace tumble::farm {
namespace {

namespace fs = std::filesystem;

class PartsOnDisk : public ::testing::Test {
 protected:
  PartsOnDisk()
      : folder(fs::temp_directory_path() / ("tumble parts " + std::to_string(::getpid()))) {}
  ~PartsOnDisk() override { fs::remove_all(folder); }
  fs::path folder;
};

TEST_F(PartsOnDisk, AreReadAsTheyWereWritten) {
  const KeptParts parts(folder, "key");
  EXPECT_FALSE(parts.has("a"));
  const std::string bytes("one\ntwo\0three\n", 14);
  parts.put("a", bytes);
  EXPECT_EQ(parts.result("a"), bytes);
  parts.put("empty", "");
  EXPECT_EQ(parts.result("empty"), "");
  parts.forget("a");
  EXPECT_FALSE(parts.has("a"));
}

TEST_F(PartsOnDisk, OfAnotherWorkAreMissing) {
  KeptParts(folder, "key").put("a", "bytes");
  EXPECT_FALSE(KeptParts(folder, "another").has("a"));
  EXPECT_TRUE(KeptParts(folder, "key").has("a"));
}

TEST_F(PartsOnDisk, ThatAreTornAreMissing) {
  const KeptParts parts(folder, "key");
  parts.put("a", "bytes that a machine without power left half of");
  const std::string whole = text_of(folder / "a.part");
  for (const std::size_t length : {whole.size() - 1, whole.size() / 2, std::size_t{5}}) {
    write_whole(folder / "a.part", whole.substr(0, length));
    EXPECT_FALSE(parts.has("a")) << length;
  }
  write_whole(folder / "a.part", whole + "x");
  EXPECT_FALSE(parts.has("a"));
}

TEST_F(PartsOnDisk, LeaveAnErrorAsTheClassThatItWas) {
  const KeptParts parts(folder, "key");
  parts.rethrow_error("a");  // there is none
  parts.put_error("a", std::make_exception_ptr(UserError("a file", "is\nbroken", "mend it")));
  try {
    parts.rethrow_error("a");
    FAIL() << "nothing was thrown";
  } catch (const UserError& error) {
    EXPECT_EQ(error.where(), "a file");
    EXPECT_EQ(error.problem(), "is\nbroken");
    EXPECT_EQ(error.remedy(), "mend it");
  }
  parts.put_error("a", std::make_exception_ptr(NotImplemented("propose", "handouts/a5.md")));
  EXPECT_THROW(parts.rethrow_error("a"), NotImplemented);
  parts.put_error("a", std::make_exception_ptr(PreconditionError("ours")));
  EXPECT_THROW(parts.rethrow_error("a"), std::runtime_error);
  EXPECT_FALSE(parts.has("a"));
}

// Two commands at once would forget each other's pieces.
TEST_F(PartsOnDisk, AreOfOneCommandAtATimeAndEachShardByItself) {
  {
    KeptParts first(folder, "key");
    first.hold("");
    EXPECT_THROW(KeptParts(folder, "another").hold(""), UserError);
    KeptParts(folder, "key").hold("1/2");
    KeptParts shard(folder, "key");
    shard.hold("2/2");
    EXPECT_THROW(KeptParts(folder, "key").hold("2/2"), UserError);
  }
  KeptParts(folder, "key").hold("");
}

}  // namespace
}  // namespace tumble::farm
