#include "framework/live/server.h"

#include <sys/random.h>

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <httplib.h>

#include "framework/core/error.h"

namespace tumble::live {
namespace {

constexpr std::size_t kThreads = 16;           // a stream holds one
constexpr std::size_t kMostPosted = 1u << 16;  // bytes
constexpr double kHeartbeat = 1.0;             // s: a page that is gone is noticed after it

// Nothing is loaded from elsewhere, no script stands in the page itself, and no page frames it.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
    "data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// What a browser shows of an address that is not this page's. It says nothing of the run, and has
// no script.
constexpr const char* kRefused = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Refused</title>
<meta name="viewport" content="width=device-width">
<style>:root { color-scheme: light dark; }
body { font: 16px/1.5 "DejaVu Sans", Arial, sans-serif; max-width: 38rem; margin: 3rem auto;
  padding: 0 1rem; } h1 { font-size: 1.4rem; } code { font-size: .95em; }</style></head>
<body><h1>This is not the address of the page</h1>
<p><code>tumble live</code> runs here. Its page has a new address after each start, which nobody can
guess: open the one that its terminal shows now, whole, in a browser on the same machine.</p>
<ul><li>A tab from before the last start has an old address: close it.</li>
<li>A link on another page does not open it: copy the address into the browser's address bar.</li>
<li>Do not write the machine's name in place of <code>127.0.0.1</code> or
<code>localhost</code>.</li></ul></body></html>
)";
constexpr const char* kPolicyOfRefused =
    "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

// 128 bits: not to be guessed, and not to be found out by a page of another origin.
std::string drawn_token() {
  std::array<unsigned char, 16> bytes;
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the kernel gives no random numbers");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

// Takes the same time wherever the two differ.
bool is_same(const std::string& a, const std::string& b) {
  unsigned different = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return different == 0;
}

}  // namespace

struct Server::Parts {
  ServerHooks hooks;
  httplib::Server http;
  std::thread thread;
  std::atomic<bool> has_ended{false};
  std::string token = drawn_token();
  int port = 0;

  bool is_ours(const httplib::Request& request) const;
  std::string path_behind_token(const std::string& path) const;
  void stream(httplib::Response& response) const;
  void serve(const httplib::Request& request, httplib::Response& response) const;
};

bool Server::Parts::is_ours(const httplib::Request& request) const {
  const std::string host = request.get_header_value("Host");
  if (host != fmt::format("127.0.0.1:{}", port) && host != fmt::format("localhost:{}", port))
    return false;
  if (request.has_header("Sec-Fetch-Site")) {
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    if (site != "same-origin" && site != "none") return false;
  }
  if (request.has_header("Origin") || request.method == "POST")
    if (request.get_header_value("Origin") != "http://" + host) return false;
  const std::size_t end = request.path.find('/', 1);
  return end != std::string::npos && is_same(request.path.substr(1, end - 1), token);
}

std::string Server::Parts::path_behind_token(const std::string& path) const {
  return path.substr(token.size() + 2);
}

void Server::Parts::stream(httplib::Response& response) const {
  const std::shared_ptr<Mailbox> mailbox = hooks.open_stream();
  if (mailbox == nullptr) {
    response.status = 503;
    response.set_content("too many pages are open", "text/plain");
    return;
  }
  response.set_chunked_content_provider(
      "text/event-stream",
      [mailbox](std::size_t, httplib::DataSink& sink) {
        std::string text = mailbox->take(kHeartbeat);
        if (text.empty() && mailbox->is_closed()) return false;
        if (text.empty()) text = ": alive\n\n";
        return sink.write(text.data(), text.size());
      },
      [mailbox](bool) { mailbox->close(); });
}

void Server::Parts::serve(const httplib::Request& request, httplib::Response& response) const {
  const std::string path = path_behind_token(request.path);
  if (path == "stream") return stream(response);
  if (const auto served = hooks.file(path)) {
    if (!served->policy.empty()) {
      response.headers.erase("Content-Security-Policy");
      response.set_header("Content-Security-Policy", served->policy);
    }
    response.set_content(served->bytes, served->type.c_str());
    return;
  }
  response.status = 404;
  response.set_content("there is nothing here", "text/plain");
}

Server::Server(ServerHooks hooks, int port) : parts_(std::make_unique<Parts>()) {
  Parts& parts = *parts_;
  parts.hooks = std::move(hooks);
  parts.http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  parts.http.set_payload_max_length(kMostPosted);
  parts.http.set_tcp_nodelay(true);
  // The library's own would share the port with another program that listens there.
  parts.http.set_socket_options([](int socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  parts.http.set_default_headers({{"Content-Security-Policy", kPolicy},
                                  {"X-Content-Type-Options", "nosniff"},
                                  {"X-Frame-Options", "DENY"},
                                  {"Referrer-Policy", "no-referrer"},
                                  {"Cross-Origin-Resource-Policy", "same-origin"},
                                  {"Cross-Origin-Opener-Policy", "same-origin"},
                                  {"Cache-Control", "no-store"}});
  parts.http.set_pre_routing_handler(
      [&parts](const httplib::Request& request, httplib::Response& response) {
        const bool is_known = request.method == "GET" || request.method == "POST";
        if (is_known && parts.is_ours(request)) return httplib::Server::HandlerResponse::Unhandled;
        response.status = is_known ? 403 : 405;
        response.headers.erase("Content-Security-Policy");
        response.set_header("Content-Security-Policy", kPolicyOfRefused);
        response.set_content(kRefused, "text/html; charset=utf-8");
        return httplib::Server::HandlerResponse::Handled;
      });
  parts.http.Get("/.*", [&parts](const httplib::Request& request, httplib::Response& response) {
    parts.serve(request, response);
  });
  parts.http.Post("/.*", [&parts](const httplib::Request& request, httplib::Response& response) {
    if (parts.path_behind_token(request.path) != "do" ||
        request.get_header_value("Content-Type").find("application/json") == std::string::npos) {
      response.status = 404;
      return;
    }
    parts.hooks.post(request.body);
    response.status = 204;
  });
  const bool is_bound = port > 0 ? parts.http.bind_to_port("127.0.0.1", port)
                                 : (port = parts.http.bind_to_any_port("127.0.0.1")) > 0;
  if (!is_bound)
    throw UserError("--port " + std::to_string(port), "another program listens there",
                    "Leave --port out, and a free one is taken.");
  parts.port = port;
  parts.thread = std::thread([&parts] {
    parts.http.listen_after_bind();
    parts.has_ended = true;
  });
}

Server::~Server() {
  // stop() is lost on a server that does not listen yet.
  while (!parts_->http.is_running() && !parts_->has_ended)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  parts_->http.stop();
  parts_->thread.join();
}

std::string Server::address() const {
  return fmt::format("http://127.0.0.1:{}/{}/", parts_->port, parts_->token);
}

}  // namespace tumble::live
