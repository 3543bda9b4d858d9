// What    Clients that mean harm, or are broken: whatever they do, a page that behaves goes on being served,
//         and memory stays bounded.
// Shape   The random tests print their seed; KDRAY_FUZZ says how many messages there are to be: 100000 were
//         run, also under the address sanitizer (ASAN_OPTIONS=quarantine_size_mb=8: what was freed counts).
#include <fstream>
#include <random>

#include "apps/view/served.h"

namespace kdray::test {
namespace {

using namespace std::chrono_literals;

long resident_kib() {
  std::ifstream in("/proc/self/statm");
  long pages = 0;
  in >> pages >> pages;
  return pages * 4;
}

int n_messages() {
  const char* const given = std::getenv("KDRAY_FUZZ");
  return given ? std::atoi(given) : 3000;
}

// A busy machine may answer late. (`request` is also how long a close frame is waited for.)
view::Limits patient() {
  view::Limits limits;
  limits.request = 5s;
  limits.silence = std::chrono::seconds(static_cast<int>(kPatience));
  return limits;
}

struct Hostile : Served {
  explicit Hostile(const view::Limits& limits = patient()) : Served(limits) {}

  // The good page still is.
  void expect_served(Client& good) {
    const int before = counter.n_received;
    ASSERT_TRUE(good.send(ws_frame(kLook)));
    EXPECT_TRUE(comes_true([&] { return counter.n_received > before; })) << "the good client is disturbed";
  }
};

class Mangler {
 public:
  explicit Mangler(std::uint32_t seed) : random_(seed) {}

  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  // Cut, with bytes changed, repeated or put in.
  std::string mangled(std::string text) {
    for (std::size_t n = 1 + below(4); n > 0 && !text.empty(); --n) {
      const std::size_t at = below(text.size());
      switch (below(5)) {
        case 0:
          text.resize(at);
          break;
        case 1:
          text[at] = static_cast<char>(below(256));
          break;
        case 2:
          text.insert(at, text.substr(at, 1 + below(30)));
          break;
        case 3:
          text.insert(at, std::string(below(below(20) == 0 ? 20000 : 40), static_cast<char>(below(256))));
          break;
        default:
          text.erase(at, 1 + below(10));
      }
    }
    return text;
  }

  std::string noise(std::size_t most) {
    std::string bytes(below(most) + 1, 0);
    for (char& c : bytes) c = static_cast<char>(below(256));
    return bytes;
  }

 private:
  std::mt19937 random_;
};

TEST_F(Hostile, FuzzedRequests) {
  const auto seed = std::random_device()();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Mangler mangler(seed);
  const auto good = connect();
  const long before = resident_kib();
  for (int i = 0; i < n_messages() / 2; ++i) {
    Client client(port());
    const std::string whole =
        mangler.below(2) == 0 ? upgrade(page()) : request("POST", "/session", page(), token());
    client.send(mangler.below(10) == 0 ? mangler.noise(12000) : mangler.mangled(whole));
    if (mangler.below(50) == 0) client.read_until("\r\n", 0.02);
  }
  expect_served(*good);
  EXPECT_LT(resident_kib() - before, 64 * 1024);
}

TEST_F(Hostile, FuzzedWebSockets) {
  const auto seed = std::random_device()();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Mangler mangler(seed);
  const auto good = connect();
  const long before = resident_kib();
  const std::string hello = ws_frame(R"({"type":"hello","token":")" + token() + "\"}");
  for (int i = 0; i < n_messages() / 2;) {
    Client client(port());
    client.upgrade(page());
    client.send((mangler.below(4) == 0 ? mangler.mangled(hello) : hello));
    // It goes on until it is thrown out.
    for (bool there = true; there && i < n_messages() / 2; ++i) {
      const std::string text = mangler.mangled(kLook);
      switch (mangler.below(5)) {
        case 0:
          there = client.send(ws_frame(text, static_cast<int>(mangler.below(16))));
          break;
        case 1:
          there = client.send(ws_frame(text, 1, mangler.below(2) == 0));
          break;
        case 2:
          there = client.send(mangler.mangled(ws_frame(kLook)));
          break;
        case 3:
          there = client.send(mangler.noise(300));
          break;
        default:
          there = client.send(ws_frame(text));
      }
      there = there && mangler.below(3) != 0;
    }
  }
  expect_served(*good);
  EXPECT_LT(resident_kib() - before, 64 * 1024);
}

TEST_F(Hostile, WhatIsTooLargeIsNotTaken) {
  const auto good = connect();
  Client head(port());
  head.send("GET / HTTP/1.1\r\nHost: " + host() + "\r\nX: " + std::string(100000, 'x') + "\r\n\r\n");
  EXPECT_TRUE(head.is_closed());
  Client body(port());
  body.send(request("POST", "/session", page(), std::string(100000, 'x')));
  EXPECT_TRUE(body.is_closed());
  Client endless(port());
  endless.send("GET / HTTP/1.1\r\n");
  for (int i = 0; i < 20000 && endless.send("X: y\r\n"); ++i) {
  }
  EXPECT_TRUE(endless.is_closed());
  const auto text = connect();
  text->send(ws_frame(std::string(100000, ' ')));
  EXPECT_TRUE(text->is_closed());
  // Of 2^63 bytes, as it says.
  const auto huge = connect();
  huge->send(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xffmask", 14));
  EXPECT_TRUE(huge->is_closed());
  // Never the last of its fragments.
  const auto pieces = connect();
  pieces->send(std::string("\x01\x81\0\0\0\0{", 7));
  for (int i = 0; i < 5000 && pieces->send(std::string("\0\x81\0\0\0\0 ", 7)); ++i) {
  }
  EXPECT_TRUE(pieces->is_closed());
  expect_served(*good);
}

// Limits that a test can wait for.
view::Limits short_limits() {
  view::Limits limits;
  limits.request = 1s;
  limits.silence = 6s;
  return limits;
}

struct Impatient : Hostile {
  Impatient() : Hostile(short_limits()) {}
};

TEST_F(Impatient, AHundredIdleClients) {
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 100; ++i) {
    idle.push_back(std::make_unique<Client>(port()));
    if (i % 3 == 1) idle.back()->send("GET / HT");
    if (i % 3 == 2) idle.back()->send(upgrade(page()));
  }
  // Who comes anew is served, (again, where a busy machine was too slow for the limit)
  EXPECT_TRUE(comes_true([&] { return status(request("GET", "/", {host()})) == "HTTP/1.1 200"; }));
  // and the idle ones have to go.
  for (const auto& client : idle) EXPECT_TRUE(client->is_closed());
}

TEST_F(Hostile, AHundredIdleClientsDisturbNobody) {
  const auto good = connect();
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 100; ++i) idle.push_back(std::make_unique<Client>(port()));
  expect_served(*good);
  const auto another = connect();
  expect_served(*another);
}

TEST_F(Hostile, AClientThatNeverReads) {
  const auto good = connect();
  const auto deaf = connect();
  counter.frame = std::string(4 << 20, 'x');
  const long before = resident_kib();
  bool there = true;
  for (int i = 0; i < 200 && there; ++i) {
    there = deaf->send(ws_frame(kLook));
    std::this_thread::sleep_for(2ms);
  }
  // 800 MB were for it.
  EXPECT_LT(resident_kib() - before, 160 * 1024);
  EXPECT_TRUE(comes_true([&] { return counter.n_clients() == 1; })) << "it was disconnected";
  {
    const std::lock_guard lock(counter.mutex);
    counter.frame.clear();
  }
  expect_served(*good);
}

TEST_F(Hostile, PagesHaveALimit) {
  std::vector<std::unique_ptr<Client>> pages;
  const std::size_t most = view::Limits{}.pages;
  for (std::size_t i = 0; i < most; ++i) pages.push_back(connect());
  Client more(port());
  more.upgrade(page());
  more.send(ws_frame(R"({"type":"hello","token":")" + token() + "\"}"));
  EXPECT_TRUE(more.is_closed());
  EXPECT_EQ(counter.n_clients(), most);
  pages.pop_back();
  EXPECT_TRUE(comes_true([&] { return counter.n_clients() == most - 1; }));
  connect();
}

// A machine that is gone doesn't say so.
TEST_F(Impatient, APageThatDoesntAnswerPingsIsDisconnected) {
  std::unique_ptr<Client> silent;
  EXPECT_TRUE(comes_true([&] {  // it has a second for its first words
    silent = std::make_unique<Client>(port());
    return silent->upgrade(page()) &&
           silent->send(ws_frame(R"({"type":"hello","token":")" + token() + "\"}")) &&
           !silent->read_until("welcome").empty() && counter.n_connected > 0;
  }));
  EXPECT_TRUE(silent->is_closed());
  EXPECT_TRUE(comes_true([&] { return counter.n_clients() == 0; }));
}

}  // namespace
}  // namespace kdray::test
