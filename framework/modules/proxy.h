/// Third implementation of a module: a table whose functions run in another process. Derived from
/// the signatures, without a line per function. Functions passed as arguments are called back
/// across the boundary, run here, and are counted here.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/channel.h"
#include "framework/modules/show_arguments.h"
#include "framework/modules/wire.h"

namespace tumble::modules {

/// The interface that a proxy needs to the owner of the other process.
class Connection {
 public:
  virtual ~Connection() = default;
  /// The channel to a running worker; starts one where none runs. Called once per call, before
  /// anything is sent. A callback may call the module again: such calls nest.
  virtual Channel& begin_call(const char* function) = 0;
  /// The worker has answered: it waits for the next call.
  virtual void end_call() {}
  /// A call before it is sent, a question to a function argument with what it was answered, and the
  /// call's answer, as they travel. Arguments begin behind the number of the function; functions
  /// among them are numbers.
  virtual void note_call(const char*, const Bytes& /*call*/) {}
  virtual void note_callback(const Bytes& /*question*/, const Bytes& /*answer*/) {}
  virtual void note_answer(const Bytes& /*answer*/) {}
  /// The call ends without its answer because a callback threw; the worker still waits inside the
  /// call.
  virtual void abandon_call() {}
  /// Called before each callback runs. False: a budget is used up (of evaluations, or of time), and
  /// the call ends by end_at_budget().
  virtual bool count_callback() = 0;
  /// Must throw; the call is over.
  [[noreturn]] virtual void end_at_budget(const char* function) {
    refuse(function, "used up its budget");
    throw std::runtime_error(function);  // unreachable: refuse throws
  }
  /// A callback has run, and its answer is sent next: the worker resumes the call.
  virtual void resume_call() {}
  virtual Channel::Clock::time_point deadline() const = 0;
  /// The arguments of the call that is about to fail, each in words.
  virtual void note_arguments(const char* /*function*/, const std::vector<std::string>&) {}
  /// The worker gave no answer: turn the transport error into a verdict. Must throw; the call is
  /// over.
  [[noreturn]] virtual void fail(const char* function, std::exception_ptr transport_error) = 0;
  /// The worker answered with an exception, or with bytes that are not a valid answer.
  [[noreturn]] virtual void refuse(const char* function, const std::string& what) = 0;
  [[noreturn]] virtual void not_implemented(const char* function, const std::string& handout) = 0;
  /// The worker returned a vector of the wrong size, or passed one to a callback; the call is over.
  /// `story` says which one, and the size needed.
  [[noreturn]] virtual void wrong_size(const char* function, const std::string& story) {
    refuse(function, story);
    throw WrongSize(story);  // unreachable: refuse throws
  }
};

namespace detail {

template <class R, class... A>
Bytes run_callback(const std::function<R(A...)>& f, Reader& reader) {
  std::tuple<std::decay_t<A>...> arguments;
  std::apply([&](auto&... a) { (reader.value(a), ...); }, arguments);
  reader.expect_end();
  Writer writer;
  writer.value(std::apply(f, arguments));
  return std::move(writer.bytes);
}

template <class Module, class R, class... A>
R call(Connection& connection, std::uint32_t index, const char* name, const A&... arguments) {
  std::vector<std::function<Bytes(Reader&)>> callbacks;
  Writer writer;
  writer.value(index);
  const auto write = [&](const auto& a) {
    using T = std::decay_t<decltype(a)>;
    if constexpr (is_function<T>::value) {
      writer.value(static_cast<std::uint32_t>(callbacks.size()));
      const auto refuse = [](const std::string& story) { throw WrongSize(story); };
      callbacks.push_back([f = asked_rightly(a, name, refuse, arguments...)](Reader& reader) {
        return run_callback(f, reader);
      });
    } else {
      writer.value(a);
    }
  };
  (write(arguments), ...);

  Channel& channel = connection.begin_call(name);
  connection.note_call(name, writer.bytes);
  const auto deadline = connection.deadline();
  const auto transport = [&](auto&& action) {
    try {
      return action();
    } catch (const ChannelClosed&) {
      connection.note_arguments(name, show_arguments(arguments...));
      connection.fail(name, std::current_exception());
    } catch (const ChannelTimeout&) {
      connection.note_arguments(name, show_arguments(arguments...));
      connection.fail(name, std::current_exception());
    } catch (const WireError& error) {
      connection.note_arguments(name, show_arguments(arguments...));
      connection.refuse(
          name, std::string("answered with bytes that are not a valid answer: ") + error.what());
    }
    throw;  // unreachable: fail and refuse throw
  };
  transport([&] {
    channel.send(MessageKind::kCall, writer.bytes, deadline);
    return 0;
  });
  for (;;) {
    const Message message = transport([&] { return channel.receive(deadline); });
    Reader reader(message.payload);
    switch (message.kind) {
      case MessageKind::kReturn:
        return transport([&] {
          R result;
          reader.value(result);
          reader.expect_end();
          if (const std::string problem =
                  answer_sizes<Module>().problem(index, name, result, arguments...);
              !problem.empty())
            connection.wrong_size(name, problem);
          connection.note_answer(message.payload);
          connection.end_call();
          return result;
        });
      case MessageKind::kCallback: {
        if (!connection.count_callback()) {
          connection.note_arguments(name, show_arguments(arguments...));
          connection.end_at_budget(name);
        }
        const Bytes answer = transport([&] {
          std::uint32_t which = 0;
          reader.value(which);
          if (which >= callbacks.size()) throw WireError("a callback that was never passed");
          try {
            return callbacks[which](reader);
          } catch (const WireError&) {
            throw;
          } catch (const WrongSize& wrong) {
            connection.wrong_size(name, wrong.what());
            throw;  // unreachable: wrong_size throws
          } catch (...) {
            connection.abandon_call();
            throw;
          }
        });
        connection.note_callback(message.payload, answer);
        connection.resume_call();
        transport([&] {
          channel.send(MessageKind::kCallbackReturn, answer, deadline);
          return 0;
        });
        break;
      }
      case MessageKind::kNotImplemented: {
        const std::string handout = transport([&] {
          std::string text;
          reader.value(text);
          return text;
        });
        connection.not_implemented(name, handout);
        break;
      }
      case MessageKind::kException: {
        const std::string what = transport([&] {
          std::string text;
          reader.value(text);
          return text;
        });
        connection.note_arguments(name, show_arguments(arguments...));
        connection.refuse(name, "threw an exception: " + what);
        break;
      }
      default:
        connection.note_arguments(name, show_arguments(arguments...));
        connection.refuse(name, "answered with a message of unknown kind");
    }
  }
}

template <class Module, class R, class... A>
std::function<R(A...)> proxy_function(Connection& connection, std::uint32_t index, const char* name,
                                      const std::function<R(A...)>*) {
  return [&connection, index, name](A... arguments) -> R {
    return call<Module, R>(connection, index, name, arguments...);
  };
}

}  // namespace detail

/// A table whose functions run at the other end of `connection`, which must outlive it.
template <class Module>
Module make_proxy(Connection& connection) {
  Module module;
  std::uint32_t index = 0;
  Module::visit(module, [&](const char* name, auto& field) {
    field = detail::proxy_function<Module>(connection, index++, name, &field);
  });
  return module;
}

}  // namespace tumble::modules
