// What    Which requests are refused, and what the page's files come with.
#include "apps/view/served.h"

namespace kdray::test {
namespace {

TEST_F(Served, ThePageAndNothingElse) {
  for (const char* const path : {"/", "/index.html", "/main.js", "/style.css", "/?x=1"})
    EXPECT_EQ(status(request("GET", path, {host()})), "HTTP/1.1 200") << path;
  for (const char* const path : {"/../etc/passwd", "/etc/passwd", "/%2e%2e/x", "//main.js", "/page/main.js",
                                 "/main.jsx", "/session", "*", "http://evil.example/"})
    EXPECT_EQ(status(request("GET", path, {host()})), "HTTP/1.1 404") << path;
  EXPECT_EQ(status(request("PUT", "/", {host()})), "HTTP/1.1 405");
  EXPECT_EQ(status(request("POST", "/", {host()}, "x")), "HTTP/1.1 405");
}

TEST_F(Served, WithAStrictPolicy) {
  Client client(port());
  client.send(request("GET", "/", {host(), "", "", "Connection: close\r\n"}));
  const std::string text = client.read_all();
  EXPECT_NE(text.find("default-src 'none'; script-src 'self'; style-src 'self'"), std::string::npos) << text;
  EXPECT_NE(text.find("frame-ancestors 'none'"), std::string::npos);
  EXPECT_NE(text.find("X-Content-Type-Options: nosniff"), std::string::npos);
  EXPECT_NE(text.find("Referrer-Policy: no-referrer"), std::string::npos);
  EXPECT_EQ(text.find("unsafe"), std::string::npos);
  const std::string page = text.substr(text.find("<!doctype"));
  EXPECT_EQ(page.find("<script>"), std::string::npos) << "no script in the page";
  EXPECT_EQ(page.find("style=\""), std::string::npos);
  EXPECT_EQ(page.find("//"), std::string::npos) << "nothing from elsewhere";
}

TEST(Server, IsFramedByThisMachinesPagesWhereThatIsAskedFor) {
  for (const bool framed : {false, true}) {
    Counter counter;
    view::Server server({.framed = framed});
    std::thread thread([&] { server.run(counter); });
    Client client(server.port());
    client.send(request("GET", "/", {"127.0.0.1", "", "", "Connection: close\r\n"}));
    const std::string head = client.read_until("\r\n\r\n");
    const std::size_t begin = head.find("frame-ancestors ");
    ASSERT_NE(begin, std::string::npos);
    const std::string ancestors = head.substr(begin, head.find("\r\n", begin) - begin);
    EXPECT_EQ(ancestors, framed ? "frame-ancestors http://localhost:* http://127.0.0.1:* https://localhost:* "
                                  "https://127.0.0.1:*"
                                : "frame-ancestors 'none'");
    server.stop();
    thread.join();
  }
}

// DNS rebinding: a page of evil.example whose name now leads here is told nothing.
TEST_F(Served, ForeignHostsAreRefused) {
  const std::string evil = "evil.example:" + std::to_string(port());
  EXPECT_EQ(status(request("GET", "/", {evil})), "HTTP/1.1 403");
  EXPECT_EQ(status(request("GET", "/", {""})), "HTTP/1.1 403");
  EXPECT_EQ(status(request("POST", "/session", {evil}, token())), "HTTP/1.1 403");
  EXPECT_EQ(status(request("GET", "/", {host(), "", "", "Host: evil.example\r\n"})), "HTTP/1.1 403");
  EXPECT_EQ(status(upgrade({evil, "http://" + evil, "", ""})), "HTTP/1.1 403");
  EXPECT_EQ(status(request("GET", "/", {"localhost:1234"})), "HTTP/1.1 200")
      << "ssh -L may come from any port";
}

TEST_F(Served, ForeignOriginsAreRefused) {
  for (const char* const origin :
       {"", "null", "http://evil.example", "http://127.0.0.1", "http://localhost:1"})
    EXPECT_EQ(status(upgrade({host(), origin, "", ""})), "HTTP/1.1 403") << origin;
  EXPECT_EQ(status(request("POST", "/session", {host(), "http://evil.example", "", ""}, token())),
            "HTTP/1.1 403");
  EXPECT_EQ(status(upgrade(page(), "/other")), "HTTP/1.1 403");
  EXPECT_EQ(status(upgrade(page())), "HTTP/1.1 101");
}

TEST_F(Served, TheTokenIsExchangedForACookie) {
  EXPECT_EQ(status(request("POST", "/session", page(), std::string(32, '0'))), "HTTP/1.1 403");
  EXPECT_EQ(status(request("POST", "/session", page(), token() + "0")), "HTTP/1.1 403");
  Client client(port());
  client.send(request("POST", "/session", page(), token()));
  const std::string answer = client.read_until("\r\n\r\n");
  EXPECT_EQ(answer.substr(0, 12), "HTTP/1.1 204");
  EXPECT_NE(answer.find("HttpOnly; SameSite=Strict"), std::string::npos);
  const std::size_t begin = answer.find("Set-Cookie: ") + 12;
  Head head = page();
  head.cookie = answer.substr(begin, answer.find(';', begin) - begin);
  Client with_cookie(port());
  with_cookie.upgrade(head);
  with_cookie.send(ws_frame(R"({"type":"hello","token":""})"));
  EXPECT_NE(with_cookie.read_until("welcome").find("welcome"), std::string::npos);
}

TEST_F(Served, WithoutTheTokenNoMessageIsHandled) {
  std::vector<std::unique_ptr<Client>> clients;
  for (const std::string& first :
       {std::string(R"({"type":"hello","token":""})"),
        std::string(R"({"type":"hello","token":"0123456789abcdef0123456789abcdef"})"), kLook,
        std::string("x"), std::string()}) {
    clients.push_back(std::make_unique<Client>(port()));
    clients.back()->upgrade(page());
    clients.back()->send(ws_frame(first) + ws_frame(kLook) + ws_frame("", 8));  // the answer to its closing
  }
  for (const auto& client : clients) EXPECT_TRUE(client->is_closed());
  EXPECT_EQ(counter.n_connected, 0);
  EXPECT_EQ(counter.n_received, 0);
}

TEST_F(Served, APagesMessagesAreHandled) {
  const auto client = connect();
  for (int i = 0; i < 100; ++i) client->send(ws_frame(kLook));
  EXPECT_TRUE(comes_true([&] { return counter.n_received == 100; }));
  EXPECT_EQ(counter.n_clients(), 1u);
}

TEST(Server, SaysWhenThePortIsTaken) {
  const view::Server first({});
  view::ServerOptions options;
  options.port = first.port();
  try {
    const view::Server second(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_NE(std::string(error.what()).find("give another --port"), std::string::npos) << error.what();
  }
  const view::Server other({});
  EXPECT_NE(other.port(), first.port());
  options.bind = "example.org";
  EXPECT_THROW(view::Server{options}, Error);
}

TEST(Server, EndsWhenNobodyIsThere) {
  Counter counter;
  view::ServerOptions options;
  std::atomic<bool> over{false};
  options.is_over = [&] { return over.load(); };
  view::Server server(options);
  std::thread thread([&] { server.run(counter); });
  over = true;
  thread.join();
}

}  // namespace
}  // namespace kdray::test
