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
#include "framework/modules/connection.h"
#include "framework/modules/show_arguments.h"
#include "framework/modules/wire.h"

namespace tumble::modules {

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
