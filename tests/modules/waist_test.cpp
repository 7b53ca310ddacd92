// The waist without a sandbox: values that cross it, and bytes that must be refused.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <limits>
#include <map>
#include <random>
#include <thread>

#include "framework/modules/call_counts.h"
#include "framework/modules/proxy.h"
#include "framework/modules/serve.h"
#include "tests/modules/waist.h"

namespace tumble {
namespace {

using modules::Bytes;
using modules::Channel;
using modules::MessageKind;
using waist::Everything;

Everything sample() {
  Everything value;
  value.number = std::numeric_limits<double>::denorm_min();
  value.count = -3;
  value.text = std::string("nul \0 inside", 12);
  value.turn = Quaterniond(0.5, -0.5, 0.5, -0.5);
  value.matrix = Eigen::MatrixXd::Random(3, 5);
  value.inner.resize(2);
  value.inner[1] = {true, waist::Colour::kBlue, 0.25,
                    Vector3d(1.0, -0.0, std::numeric_limits<double>::infinity())};
  return value;
}

Bytes bytes_of(const Everything& value) {
  modules::Writer writer;
  writer.value(value);
  return writer.bytes;
}

TEST(Wire, EveryKindOfValueIsRestoredBitForBit) {
  const Bytes bytes = bytes_of(sample());
  modules::Reader reader(bytes);
  Everything back;
  reader.value(back);
  EXPECT_NO_THROW(reader.expect_end());
  EXPECT_EQ(bytes_of(back), bytes);
  EXPECT_EQ(back.text.size(), 12u);
  EXPECT_TRUE(std::signbit(back.inner[1].point.y()));
}

// The arguments in the story of a crash; functions are not on the wire.
TEST(Arguments, AreShownAlikeDirectlyAndFromBytes) {
  const std::vector<waist::Inner> list(6, {true, waist::Colour::kBlue, 0.25, Vector3d(1, -2, 0.5)});
  const std::function<double(double)> f = [](double x) { return x; };
  const Eigen::VectorXd long_vector = Eigen::VectorXd::LinSpaced(20, 1, 20);
  const std::vector<std::string> shown = modules::show_arguments(
      f, -3, std::string("a"), Quaterniond(0.5, -0.5, 0.5, -0.5), long_vector, list);
  ASSERT_EQ(shown.size(), 6u);
  const std::vector<std::string> short_ones(shown.begin(), shown.end() - 1),
      needed = {"a function", "-3", "\"a\"", "(0.5, -0.5, 0.5, -0.5)",
                "(20: 1, 2, 3, 4, 5, 6, 7, 8, ...)"};
  EXPECT_EQ(short_ones, needed);
  EXPECT_TRUE(
      shown.back().starts_with("[6: {flag: true, colour: 7, weight: 0.25, point: (1, -2, 0.5)}, {"))
      << shown.back();
  modules::Writer writer;
  modules::write_arguments(writer, f, -3, std::string("a"), Quaterniond(0.5, -0.5, 0.5, -0.5),
                           long_vector, list);
  using Function = std::function<double(double)>;
  EXPECT_EQ(
      (modules::show_written_arguments<const Function&, int, const std::string&, const Quaterniond&,
                                       const Eigen::VectorXd&, const std::vector<waist::Inner>&>(
          writer.bytes)),
      shown);
  // a story must stay readable
  EXPECT_LT(modules::show_arguments(std::string(5000, 'x')).at(0).size(), 700u);
}

TEST(Wire, MessageCutAnywhereIsRefused) {
  const Bytes bytes = bytes_of(sample());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    modules::Reader reader(cut);
    Everything back;
    EXPECT_THROW(reader.value(back), modules::WireError)
        << size << " of " << bytes.size() << " bytes";
  }
}

TEST(Wire, CountsThatTheMessageCannotHoldAllocateNothing) {
  const Bytes huge(4, 0xff);  // a count of 2^32 - 1, then nothing
  modules::Reader as_text(huge), as_list(huge);
  std::string text;
  std::vector<double> list;
  EXPECT_THROW(as_text.value(text), modules::WireError);
  EXPECT_THROW(as_list.value(list), modules::WireError);
  EXPECT_LT(text.capacity() + list.capacity(), 100u);
}

// 2^31 x 2^30 numbers of 8 bytes are 2^64 bytes, which 64 bits hold as 0.
TEST(Wire, MatrixWhoseSizeDoesNotFitInto64BitsIsRefused) {
  for (const auto& [rows, cols] : {std::pair{1U << 31, 1U << 30}, {1U << 30, 1U << 31}}) {
    modules::Writer writer;
    writer.value(std::uint32_t{rows});
    writer.value(std::uint32_t{cols});
    modules::Reader reader(writer.bytes);
    Eigen::MatrixXd matrix;
    EXPECT_THROW(reader.value(matrix), modules::WireError) << rows << " x " << cols;
    EXPECT_EQ(matrix.size(), 0);
  }
}

TEST(Wire, MutatedMessagesAreReadOrRefusedAndNeverCrash) {
  const Bytes right = bytes_of(sample());
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = right;
    for (int k = 0; k < 3; ++k)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    modules::Reader reader(bytes);
    Everything back;
    try {
      reader.value(back);
    } catch (const modules::WireError&) {
    }
  }
}

// A proxy whose worker is a thread of this process.
class Loop : public modules::Connection {
 public:
  Loop() {
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_), 0);
    near_ = std::make_unique<Channel>(Channel::End::kAsks, ends_[0], ends_[0]);
    worker_ = std::thread([this] {
      Channel far(Channel::End::kAnswers, ends_[1], ends_[1]);
      modules::serve(module_, far);
    });
  }
  ~Loop() override {
    ::shutdown(ends_[0], SHUT_RDWR);
    worker_.join();
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  Channel& begin_call(const char*) override { return *near_; }
  bool count_callback() override {
    ++callbacks;
    return true;
  }
  Channel::Clock::time_point deadline() const override {
    return Channel::Clock::now() + std::chrono::seconds(10);
  }
  void fail(const char* function, std::exception_ptr) override {
    throw std::runtime_error(std::string("no answer from ") + function);
  }
  void refuse(const char* function, const std::string& what) override {
    throw std::runtime_error(function + (' ' + what));
  }
  void not_implemented(const char* function, const std::string& handout) override {
    throw NotImplemented(function, handout);
  }

  int callbacks = 0;

 private:
  waist::Module module_ = waist::Module::of(waist::Module::linked());
  int ends_[2];
  std::unique_ptr<Channel> near_;
  std::thread worker_;
};

TEST(CallCounts, CountCallsByFunctionAlsoThoseWithinACall) {
  modules::CallCounts counts({"twice", "echo", "call_back", "attack", "missing", "step"});
  const waist::Module counted =
      modules::watched(waist::Module::of(waist::Module::linked()), counts);
  counted.call_back([&](double x) { return counted.twice(x); }, 3);
  EXPECT_THROW(counted.missing(1.0), NotImplemented);
  const auto all = [&] {
    std::vector<std::uint64_t> numbers;
    for (std::size_t k = 0; k < counts.functions().size(); ++k) numbers.push_back(counts.count(k));
    return numbers;
  };
  EXPECT_EQ(all(), (std::vector<std::uint64_t>{3, 0, 1, 0, 1, 0}));
  counts.clear();
  EXPECT_EQ(all(), std::vector<std::uint64_t>(6));
}

TEST(CallCounts, OnlyFunctionsThatBindingCopiesAreLaws) {
  const auto bind = [](const waist::Module& module, Laws& laws) {
    laws.baumgarte_acceleration = [missing = module.missing](double, double, double x) {
      return missing(x);
    };
    laws.ends_in_contact = [twice = module.twice](double, double, double x) {
      return twice(x) > 0;
    };
  };
  EXPECT_EQ(modules::functions_of_laws<waist::Module>(bind),
            (std::vector<std::string>{"twice", "missing"}));
}

TEST(Proxy, AnswersAsTheLinkedModuleDoes) {
  Loop loop;
  const auto module = modules::make_proxy<waist::Module>(loop);
  EXPECT_EQ(module.twice(0.1), waist::twice(0.1));
  const Everything value = sample();
  EXPECT_EQ(bytes_of(module.echo(value)), bytes_of(value));
}

TEST(Proxy, CallbacksRunInTheJudgeAndAreCounted) {
  Loop loop;
  const auto module = modules::make_proxy<waist::Module>(loop);
  int seen = 0;
  // 10 (0 + 1 + 2 + 3 + 4)
  EXPECT_EQ(module.call_back([&](double x) { return ++seen, 10.0 * x; }, 5), 100.0);
  EXPECT_EQ(seen, 5);
  EXPECT_EQ(loop.callbacks, 5);
}

TEST(Proxy, CallbackMayCallTheModuleAgain) {
  Loop loop;
  const auto module = modules::make_proxy<waist::Module>(loop);
  const auto inner = [&](double x) {
    return module.call_back([&](double y) { return module.twice(x + y); }, 2);
  };
  EXPECT_EQ(module.call_back(inner, 3), 18.0);  // sum over x = 0, 1, 2 and y = 0, 1 of 2 (x + y)
  EXPECT_EQ(module.twice(1.0), 2.0);
}

TEST(Proxy, StubIsNotImplementedAcrossTheBoundaryAndTheChannelStaysOpen) {
  Loop loop;
  const auto module = modules::make_proxy<waist::Module>(loop);
  EXPECT_THROW(module.missing(1.0), NotImplemented);
  EXPECT_EQ(module.twice(4.0), 8.0);
}

std::string refusal_of(const waist::Module& module, const std::string& what) {
  try {
    module.step([](double, const VectorXd& y) { return VectorXd(-y); }, VectorXd::Ones(13), what);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

TEST(Proxy, WrongSizesAreRefusedWithTheSizeNeeded) {
  for (const auto& [what, words] : std::map<std::string, std::string>{
           {"ask 0",
            "step step: the derivative was called with 0 numbers, but 13 are needed (a vector that "
            "was never set has none)"},
           {"ask 14", "step step: the derivative was called with 14 numbers, but 13 are needed"},
           {"answer 0", "step step returned 0 numbers, but 13 are needed"},
           {"answer 100000", "step step returned 100000 numbers, but 13 are needed"}}) {
    Loop loop;
    EXPECT_EQ(refusal_of(modules::make_proxy<waist::Module>(loop), what), words);
  }
  Loop loop;
  EXPECT_EQ(refusal_of(modules::make_proxy<waist::Module>(loop), "right"), "");
}

TEST(Proxy, MessagesAboveTheSizeLimitAreRefusedByTheSender) {
  for (const std::string what : {"ask 10000000", "answer 10000000"}) {
    Loop loop;
    const std::string words = refusal_of(modules::make_proxy<waist::Module>(loop), what);
    EXPECT_NE(words.find("an argument or answer of 80000"), std::string::npos) << words;
  }
}

TEST(Channel, DeadlineCanBeExtendedAndThenPasses) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  Channel channel(Channel::End::kAsks, ends[0], ends[0]);
  int asked = 0;
  channel.extend_by([&](Channel::Clock::time_point passed) {
    return ++asked < 3 ? Channel::Clock::now() + std::chrono::milliseconds(5) : passed;
  });
  EXPECT_THROW(channel.receive(Channel::Clock::now()), modules::ChannelTimeout);
  EXPECT_EQ(asked, 3);
  ::close(ends[0]);
  ::close(ends[1]);
}

// Both ends in one thread: what the far one sends is there before the near one asks for it.
struct Sockets {
  Sockets() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, fds), 0); }
  ~Sockets() { ::close(fds[0]), ::close(fds[1]); }
  int fds[2];
};
struct Ends : Sockets {
  Channel near{Channel::End::kAsks, fds[0], fds[0]}, far{Channel::End::kAnswers, fds[1], fds[1]};
};

TEST(Channel, AnAnswerToTheLatestQuestionIsTaken) {
  Ends ends;
  for (int i = 0; i < 100; ++i) {
    ends.near.send(modules::MessageKind::kCall, {});
    ends.far.receive();
    ends.far.send(modules::MessageKind::kReturn, {1, 2});
    EXPECT_EQ(ends.near.receive().payload.size(), 2u);
  }
}

TEST(Channel, AnAnswerBeforeItsQuestionIsRefused) {
  Ends ends;
  ends.far.send(modules::MessageKind::kReturn, {});
  ends.near.send(modules::MessageKind::kCall, {});
  EXPECT_THROW(ends.near.receive(), modules::WireError);
}

TEST(Channel, ASecondAnswerToOneQuestionIsRefused) {
  Ends ends;
  ends.near.send(modules::MessageKind::kCall, {});
  ends.far.receive();
  for (int i = 0; i < 2; ++i) ends.far.send(modules::MessageKind::kReturn, {});
  EXPECT_NO_THROW(ends.near.receive());
  ends.near.send(modules::MessageKind::kCall, {});
  EXPECT_THROW(ends.near.receive(), modules::WireError);
}

TEST(Channel, WaitWithoutAMessageEndsAtTheDeadline) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  Channel channel(Channel::End::kAsks, ends[0], ends[0]);
  EXPECT_THROW(channel.receive(Channel::Clock::now() + std::chrono::milliseconds(20)),
               modules::ChannelTimeout);
  ::close(ends[1]);
  EXPECT_THROW(channel.receive(Channel::Clock::now() + std::chrono::milliseconds(20)),
               modules::ChannelClosed);
  ::close(ends[0]);
}

}  // namespace
}  // namespace tumble
