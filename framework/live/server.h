/// Serves the page to this user's browser and nobody else: on 127.0.0.1 alone, below a token drawn
/// by lot, to no other origin and under no other name.
///
///   GET  /TOKEN/            the page; /TOKEN/page.js and so on: its parts
///   GET  /TOKEN/stream      server-sent events: "say" (JSON), "f" and "e" (float32 in base64)
///   POST /TOKEN/do          a JSON object: what the page wants
///
/// Refused with 403: a Host that is not this address, an Origin (or, with POST, none) that is not
/// this page's, a request that a browser says comes from another site, a wrong token.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "framework/live/mailbox.h"

namespace tumble::live {

struct Served {
  std::string type, bytes;  // type: "text/html"
  std::string policy{};     // its Content-Security-Policy; empty: the page's
};

struct ServerHooks {
  // called from threads of the server
  std::function<std::shared_ptr<Mailbox>()> open_stream;  // null: too many are open
  std::function<void(const std::string& json)> post;
  std::function<std::optional<Served>(const std::string& path)> file;  // behind the token
};

class Server {
 public:
  /// Listens from here on. @param port  0: any that is free
  /// @throws UserError where the port is taken
  Server(ServerHooks hooks, int port);
  /// Ends all connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// http://127.0.0.1:PORT/TOKEN/
  std::string address() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tumble::live
