/// The worker's side of a proxied module: reads calls, runs them, answers. Runs inside the sandbox.
#pragma once

#include <exception>
#include <tuple>
#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/modules/channel.h"
#include "framework/modules/wire.h"

namespace tumble::modules {
namespace detail {

template <class T>
struct CallbackStub;

template <class R, class... A>
struct CallbackStub<std::function<R(A...)>> {
  static std::function<R(A...)> make(Channel& channel, std::uint32_t which) {
    return [&channel, which](A... arguments) -> R {
      Writer writer;
      writer.value(which);
      (writer.value(static_cast<const std::decay_t<A>&>(arguments)), ...);
      channel.send(MessageKind::kCallback, writer.bytes);
      const Message answer = channel.receive();
      if (answer.kind != MessageKind::kCallbackReturn) throw ChannelClosed("the judge ended the call");
      Reader reader(answer.payload);
      R result;
      reader.value(result);
      return result;
    };
  }
};

template <class T>
void read_argument(Channel& channel, Reader& reader, T& argument) {
  if constexpr (is_function<T>::value) {
    std::uint32_t which = 0;
    reader.value(which);
    argument = CallbackStub<T>::make(channel, which);
  } else {
    reader.value(argument);
  }
}

template <class R, class... A>
std::function<Bytes(Reader&)> served(Channel& channel, const std::function<R(A...)>& function) {
  return [&channel, &function](Reader& reader) {
    std::tuple<std::decay_t<A>...> arguments;
    std::apply([&](auto&... a) { (read_argument(channel, reader, a), ...); }, arguments);
    Writer writer;
    writer.value(std::apply(function, arguments));
    return std::move(writer.bytes);
  };
}

}  // namespace detail

/// Answers calls until the judge closes the channel. A C++ exception out of a function is an answer; a signal is not.
template <class Module>
void serve(const Module& module, Channel& channel) {
  std::vector<std::function<Bytes(Reader&)>> functions;
  Module::visit(module, [&](const char*, const auto& field) { functions.push_back(detail::served(channel, field)); });
  for (;;) {
    Message message{};
    try {
      message = channel.receive();
    } catch (const ChannelClosed&) {
      return;
    }
    const auto say = [&](MessageKind kind, const std::string& text) {
      Writer writer;
      writer.value(text);
      channel.send(kind, writer.bytes);
    };
    try {
      Reader reader(message.payload);
      std::uint32_t index = 0;
      reader.value(index);
      channel.send(MessageKind::kReturn, functions.at(index)(reader));
    } catch (const ChannelClosed&) {
      return;
    } catch (const NotImplemented& missing) {
      say(MessageKind::kNotImplemented, missing.handout());
    } catch (const std::exception& error) {
      say(MessageKind::kException, error.what());
    } catch (...) {
      say(MessageKind::kException, "something that is not a std::exception");
    }
  }
}

}  // namespace tumble::modules
