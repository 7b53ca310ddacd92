/// The worker's side of a proxied module: reads calls, runs them, sends the answers. Runs inside
/// the sandbox.
#pragma once

#include <exception>
#include <tuple>
#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/modules/channel.h"
#include "framework/modules/wire.h"

namespace tumble::modules {
namespace detail {

/// The functions of a module from bytes to bytes, and the channel that calls them.
struct Server {
  Channel& channel;
  std::vector<std::function<Bytes(Reader&)>> functions;

  /// Runs one call and sends the answer. A C++ exception of a function is an answer; a signal is
  /// not.
  /// @throws ChannelClosed when the judge has closed the channel
  void answer(const Message& call) {
    const auto say = [&](MessageKind kind, const std::string& text) {
      Writer writer;
      writer.value(text);
      channel.send(kind, writer.bytes);
    };
    try {
      Reader reader(call.payload);
      std::uint32_t index = 0;
      reader.value(index);
      channel.send(MessageKind::kReturn, functions.at(index)(reader));
    } catch (const ChannelClosed&) {
      throw;
    } catch (const NotImplemented& missing) {
      say(MessageKind::kNotImplemented, missing.handout());
    } catch (const std::exception& error) {
      say(MessageKind::kException, error.what());
    } catch (...) {
      say(MessageKind::kException, "an object that is not a std::exception");
    }
  }
};

template <class T>
struct CallbackStub;

template <class R, class... A>
struct CallbackStub<std::function<R(A...)>> {
  static std::function<R(A...)> make(Server& server, std::uint32_t which) {
    return [&server, which](A... arguments) -> R {
      Writer writer;
      writer.value(which);
      (writer.value(static_cast<const std::decay_t<A>&>(arguments)), ...);
      server.channel.send(MessageKind::kCallback, writer.bytes);
      Message answer = server.channel.receive();
      // The callback may itself call this module: an integrator's derivative is a function of the
      // same module.
      for (; answer.kind == MessageKind::kCall; answer = server.channel.receive())
        server.answer(answer);
      if (answer.kind != MessageKind::kCallbackReturn)
        throw ChannelClosed("the judge ended the call");
      Reader reader(answer.payload);
      R result;
      reader.value(result);
      return result;
    };
  }
};

template <class T>
void read_argument(Server& server, Reader& reader, T& argument) {
  if constexpr (is_function<T>::value) {
    std::uint32_t which = 0;
    reader.value(which);
    argument = CallbackStub<T>::make(server, which);
  } else {
    reader.value(argument);
  }
}

template <class R, class... A>
std::function<Bytes(Reader&)> served(Server& server, const std::function<R(A...)>& function) {
  return [&server, &function](Reader& reader) {
    std::tuple<std::decay_t<A>...> arguments;
    std::apply([&](auto&... a) { (read_argument(server, reader, a), ...); }, arguments);
    Writer writer;
    writer.value(std::apply(function, arguments));
    return std::move(writer.bytes);
  };
}

}  // namespace detail

/// Answers calls until the judge closes the channel.
template <class Module>
void serve(const Module& module, Channel& channel) {
  detail::Server server{channel, {}};
  Module::visit(module, [&](const char*, const auto& field) {
    server.functions.push_back(detail::served(server, field));
  });
  try {
    for (;;) server.answer(channel.receive());
  } catch (const ChannelClosed&) {
    return;
  }
}

}  // namespace tumble::modules
