// What the server of the live page gives, and to whom.
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/live/server.h"

namespace tumble::testing::live_server_test {
namespace {

/// A server with one file and a list of what was posted.
class LiveServer : public ::testing::Test {
 protected:
  LiveServer()
      : server_({[this] {
                   mailbox_ = std::make_shared<live::Mailbox>();
                   mailbox_->put(std::make_shared<const std::string>(live::event_of("say", "{}")));
                   return mailbox_;
                 },
                 [this](const std::string& json) { posted_.push_back(json); },
                 [](const std::string& path) -> std::optional<live::Served> {
                   if (path.empty()) return live::Served{"text/html", "the page"};
                   return std::nullopt;
                 }},
                0) {
    const std::string address = server_.address();  // http://127.0.0.1:PORT/TOKEN/
    const std::size_t colon = address.rfind(':'), slash = address.find('/', colon);
    host_ = address.substr(7, slash - 7);
    path_ = address.substr(slash);
    port_ = std::stoi(address.substr(colon + 1));
  }

  static int connected(in_addr_t address, int port) {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = address;
    if (::connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0) return fd;
    ::close(fd);
    return -1;
  }

  /// What comes back for a request as it stands; the connection is closed by the server, or at
  /// `until`.
  std::string answer(const std::string& request, const std::string& until = "") const {
    const int fd = connected(htonl(INADDR_LOOPBACK), port_);
    if (fd < 0) return "no connection";
    std::string text;
    if (::send(fd, request.data(), request.size(), MSG_NOSIGNAL) > 0) {
      char buffer[4096];
      for (ssize_t n; (n = ::read(fd, buffer, sizeof buffer)) > 0;) {
        text.append(buffer, static_cast<std::size_t>(n));
        if (!until.empty() && text.find(until) != std::string::npos) break;
      }
    }
    ::close(fd);
    return text;
  }
  std::string get(const std::string& path, const std::string& more = "") const {
    return answer("GET " + path + " HTTP/1.1\r\nHost: " + host_ + "\r\n" + more +
                  "Connection: close\r\n\r\n");
  }
  std::string post(const std::string& body, const std::string& more) const {
    return answer("POST " + path_ + "do HTTP/1.1\r\nHost: " + host_ + "\r\n" + more +
                  "Content-Length: " + std::to_string(body.size()) +
                  "\r\nConnection: close\r\n\r\n" + body);
  }
  static int status(const std::string& answer) {
    return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9)) : 0;
  }

  std::shared_ptr<live::Mailbox> mailbox_;
  std::vector<std::string> posted_;
  live::Server server_;
  std::string host_, path_;
  int port_ = 0;
};

const std::string kJson = "Content-Type: application/json\r\n";

TEST_F(LiveServer, GivesThePageBehindItsToken) {
  const std::string page = get(path_);
  EXPECT_EQ(status(page), 200);
  EXPECT_NE(page.find("the page"), std::string::npos);
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'none'; script-src 'self'"),
            std::string::npos);
  // No page of another origin may read an answer.
  EXPECT_EQ(page.find("Access-Control-Allow"), std::string::npos);
  EXPECT_EQ(status(get(path_ + "other")), 404);
}

TEST_F(LiveServer, WrongTokenGetsNothing) {
  std::string wrong = path_;
  wrong[1] = wrong[1] == '0' ? '1' : '0';
  for (const std::string& path : {wrong, std::string("/"), std::string("//"), path_.substr(0, 20),
                                  path_ + "/../" + wrong.substr(1), wrong + "stream"})
    EXPECT_NE(status(get(path)), 200) << path;
  EXPECT_EQ(status(get(wrong)), 403);
  const std::string said = get(wrong);  // what to do, and neither a script nor the right address
  EXPECT_NE(said.find("open the one that its terminal shows now"), std::string::npos) << said;
  EXPECT_EQ(said.find("<script"), std::string::npos);
  EXPECT_EQ(said.find(path_.substr(1, 32)), std::string::npos);
  EXPECT_GE(path_.size(), 34u);  // 128 bits
}

TEST_F(LiveServer, TwoServersHaveDifferentTokens) {
  const live::Server other({[] { return nullptr; }, [](const std::string&) {},
                            [](const std::string&) { return std::nullopt; }},
                           0);
  EXPECT_NE(other.address().substr(other.address().size() - 33), path_.substr(1));
}

TEST_F(LiveServer, AnotherHostIsRefused) {
  // A name that was made to point here (DNS rebinding) is the other page's origin.
  for (const std::string& host :
       {std::string("evil.example"), "evil.example:" + std::to_string(port_),
        std::string("127.0.0.1"), std::string("")})
    EXPECT_EQ(status(answer("GET " + path_ + " HTTP/1.1\r\nHost: " + host +
                            "\r\nConnection: close\r\n\r\n")),
              403)
        << host;
  EXPECT_EQ(status(answer("GET " + path_ + " HTTP/1.1\r\nHost: localhost:" + std::to_string(port_) +
                          "\r\nConnection: close\r\n\r\n")),
            200);
}

TEST_F(LiveServer, AnotherOriginIsRefused) {
  for (const std::string& origin :
       {std::string("http://evil.example"), std::string("null"),
        "http://127.0.0.1:" + std::to_string(port_ == 80 ? 81 : 80), "https://" + host_}) {
    EXPECT_EQ(status(get(path_, "Origin: " + origin + "\r\n")), 403) << origin;
    EXPECT_EQ(status(post("{}", kJson + "Origin: " + origin + "\r\n")), 403) << origin;
  }
  EXPECT_EQ(status(get(path_, "Sec-Fetch-Site: cross-site\r\n")), 403);
  EXPECT_EQ(status(get(path_, "Sec-Fetch-Site: same-site\r\n")), 403);
  EXPECT_TRUE(posted_.empty());
}

TEST_F(LiveServer, PostIsTakenFromItsOwnPageOnly) {
  const std::string ours = "Origin: http://" + host_ + "\r\n";
  EXPECT_EQ(status(post("{\"do\": 1}", kJson + ours)), 204);
  EXPECT_EQ(posted_, std::vector<std::string>{"{\"do\": 1}"});
  EXPECT_EQ(status(post("{}", kJson)), 403);  // none: not a browser, or an old one
  EXPECT_EQ(status(post("{}", "Content-Type: text/plain\r\n" + ours)), 404);  // a form's
  EXPECT_EQ(status(post(std::string(70'000, ' '), kJson + ours)), 413);
  EXPECT_EQ(posted_.size(), 1u);
}

TEST_F(LiveServer, OtherMethodsAreRefused) {
  for (const char* method : {"OPTIONS", "PUT", "DELETE", "HEAD", "PATCH"})
    EXPECT_EQ(status(answer(std::string(method) + " " + path_ + " HTTP/1.1\r\nHost: " + host_ +
                            "\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")),
              405)
        << method;
}

TEST_F(LiveServer, StreamsWhatIsPut) {
  const std::string text =
      answer("GET " + path_ + "stream HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n", "data: {}\n\n");
  EXPECT_NE(text.find("Content-Type: text/event-stream"), std::string::npos);
  EXPECT_NE(text.find("event: say\ndata: {}\n\n"), std::string::npos);
  // A page that is gone closes its mailbox: at the next sign of life, a second later.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!mailbox_->is_closed() && std::chrono::steady_clock::now() < end) ::usleep(20'000);
  EXPECT_TRUE(mailbox_->is_closed());
}

TEST_F(LiveServer, ListensOnThisMachineOnly) {
  ifaddrs* list = nullptr;
  ASSERT_EQ(::getifaddrs(&list), 0);
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    const in_addr_t address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr.s_addr;
    if (address == htonl(INADDR_LOOPBACK)) continue;
    const int fd = connected(address, port_);
    EXPECT_LT(fd, 0) << one->ifa_name;
    if (fd >= 0) ::close(fd);
  }
  ::freeifaddrs(list);
}

TEST_F(LiveServer, TakenPortIsAUsersError) {
  const auto other = [&] {
    const live::Server second({[] { return nullptr; }, [](const std::string&) {},
                               [](const std::string&) { return std::nullopt; }},
                              port_);
  };
  EXPECT_THROW(other(), UserError);
}

TEST(LiveMailbox, PageThatDoesNotReadIsClosed) {
  live::Mailbox mailbox;
  const auto text = std::make_shared<const std::string>(std::string(1 << 20, 'x'));
  for (int i = 0; i < 200; ++i) mailbox.put(text);  // 200 MB
  EXPECT_TRUE(mailbox.is_closed());
  EXPECT_TRUE(mailbox.take(0.0).empty());
}

}  // namespace
}  // namespace tumble::testing::live_server_test
